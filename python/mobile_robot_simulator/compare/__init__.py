"""Compare: how far the scans of a log are from simulated ones."""

from .alignment import Alignment
from .breakdown import Band, Breakdown, Place
from .comparison import Comparison, compare_log
from .refinement import Refinement
from .residuals import Residuals, Spread

__all__ = ["Alignment", "Band", "Breakdown", "Comparison", "Place", "Refinement", "Residuals", "Spread", "compare_log"]
