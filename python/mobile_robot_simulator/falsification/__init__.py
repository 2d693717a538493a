"""Falsification: searches worlds in which a controller violates a requirement, and estimates how often it does.

A *controller* is a function or class of a module. It is called with the simulation at the start of each drive. It returns a
`benchmarks.Controller`, which is then asked for a command every 0.1 s, or it spawns nodes and returns None. The robot's
parameters are those of the space.
"""

from .comparison import PairedResult, compare_controllers
from .counterexample import Counterexample
from .drive import Drive, Setup, run_drive
from .estimation import Estimate, estimate
from .falsifier import Falsification, falsify
from .lost_drive import LostDrive, load_world
from .shrinking import shrink

__all__ = [
    "Counterexample",
    "Drive",
    "Estimate",
    "Falsification",
    "LostDrive",
    "PairedResult",
    "Setup",
    "compare_controllers",
    "estimate",
    "falsify",
    "load_world",
    "run_drive",
    "shrink",
]
