"""Compare: how far the scans of a log are from simulated ones."""

from .comparison import Comparison, compare_log
from .residuals import Residuals, Spread

__all__ = ["Comparison", "Residuals", "Spread", "compare_log"]
