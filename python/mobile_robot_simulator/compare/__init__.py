"""Compare: how far the scans of a log are from simulated ones."""

from .alignment import Alignment
from .breakdown import Band, Breakdown, Place
from .comparison import Comparison, compare_log
from .noise_file import noise_text
from .noise_fit import NoiseFit, Score
from .refinement import Refinement
from .report_page import html_report
from .residuals import Residuals, Spread

__all__ = [
    "Alignment",
    "Band",
    "Breakdown",
    "Comparison",
    "NoiseFit",
    "Place",
    "Refinement",
    "Residuals",
    "Score",
    "Spread",
    "compare_log",
    "html_report",
    "noise_text",
]
