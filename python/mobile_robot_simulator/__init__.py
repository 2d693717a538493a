"""Exact, fast and deterministic simulation of mobile robots and laser scanners on occupancy grids.

The core (grids, scanners, noise, shapes, motion) is imported at once. Everything else, such as `Simulation` or the submodule
`messages`, is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._core import (
    BeamFit,
    BeamModel,
    Contact,
    Drive,
    Fleet,
    FleetState,
    FleetStep,
    LaserScanner,
    LikelihoodField,
    Limits,
    Material,
    MotionNoise,
    Obstacles,
    OccupancyGrid,
    Pose,
    RandomStream,
    Shape,
    SurfaceModel,
    WheelMotion,
    __version__,
    advance,
    cast_rays,
    clearance,
    clearance_batch,
    integrate_twist,
    laser_presets,
    touches,
)

if TYPE_CHECKING:
    from . import audit as audit
    from . import benchmarks as benchmarks
    from . import bus as bus
    from . import compare as compare
    from . import datasets as datasets
    from . import falsification as falsification
    from . import faults as faults
    from . import foxglove as foxglove
    from . import learning as learning
    from . import live as live
    from . import localization as localization
    from . import logs as logs
    from . import maps as maps
    from . import messages as messages
    from . import nodes as nodes
    from . import parameters as parameters
    from . import physics as physics
    from . import plotting as plotting
    from . import recording as recording
    from . import requirements as requirements
    from . import ros as ros
    from . import scenarios as scenarios
    from . import simulation as simulation
    from . import testing as testing
    from .maps import floor_plan, load_map, save_map
    from .simulation import Simulation

__all__ = [
    "BeamFit",
    "BeamModel",
    "Contact",
    "Drive",
    "Fleet",
    "FleetState",
    "FleetStep",
    "LaserScanner",
    "LikelihoodField",
    "Limits",
    "Material",
    "MotionNoise",
    "Obstacles",
    "OccupancyGrid",
    "Pose",
    "RandomStream",
    "Shape",
    "Simulation",
    "SurfaceModel",
    "WheelMotion",
    "__version__",
    "advance",
    "cast_rays",
    "clearance",
    "clearance_batch",
    "floor_plan",
    "integrate_twist",
    "laser_presets",
    "load_map",
    "save_map",
    "touches",
]

_SUBMODULES = (
    "audit",
    "benchmarks",
    "bus",
    "compare",
    "datasets",
    "falsification",
    "faults",
    "foxglove",
    "learning",
    "live",
    "localization",
    "logs",
    "maps",
    "messages",
    "nodes",
    "parameters",
    "physics",
    "plotting",
    "recording",
    "requirements",
    "ros",
    "scenarios",
    "simulation",
    "testing",
)

_LAZY = {"Simulation": "simulation", "floor_plan": "maps", "load_map": "maps", "save_map": "maps"}
"""Names that are imported when they are first used, and their submodules."""


def __getattr__(name: str) -> Any:
    """Imports a submodule or a lazily imported name when it is first used."""
    if name in _SUBMODULES:
        return import_module(f"{__name__}.{name}")
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_LAZY[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """All public names, whether they are imported yet or not."""
    return sorted({*__all__, *_SUBMODULES})
