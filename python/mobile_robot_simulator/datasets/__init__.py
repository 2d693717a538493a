"""Data sets of scans that can be made again: from a plan to a store, its verification, and its reader.

Making and opening a store needs the extra `datasets`. `stream` needs none.
"""

from .export import export
from .generation import Estimate, Progress, Report, estimate, generate
from .map_pool import MapPool
from .plan import Plan, load_plan
from .reader import Dataset, Split, open
from .stream import load_maps, stream
from .verification import Difference, Verified, verify

__all__ = [
    "Dataset",
    "Difference",
    "Estimate",
    "MapPool",
    "Plan",
    "Progress",
    "Report",
    "Split",
    "Verified",
    "estimate",
    "export",
    "generate",
    "load_maps",
    "load_plan",
    "open",
    "stream",
    "verify",
]
