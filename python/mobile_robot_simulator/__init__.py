"""Exact, fast and deterministic simulation of mobile robots and laser scanners on occupancy grids.

The core (grids, scanners, beam noise, motion) is there at once; the rest is imported when it is first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._core import (
    BeamModel,
    Contact,
    LaserScanner,
    Limits,
    MotionNoise,
    OccupancyGrid,
    Pose,
    Shape,
    __version__,
    advance,
    cast_rays,
    clearance,
    integrate_twist,
    touches,
)

if TYPE_CHECKING:
    from . import messages
    from .bus_node import Node
    from .floor_plans import floor_plan
    from .laser_node import LaserScannerSimulator
    from .map_node import MapServer
    from .maps import load_map, save_map
    from .messages import (
        Clock,
        GetMap,
        Header,
        LaserScan,
        Odometry,
        Point,
        PoseWithCovariance,
        PoseWithCovarianceStamped,
        Quaternion,
        SetPose,
        String,
        TFMessage,
        Time,
        Transform,
        TransformStamped,
        Trigger,
        Twist,
        TwistStamped,
        TwistWithCovariance,
        Vector3,
    )
    from .robot_node import MobileRobotSimulator
    from .simulation import Simulation

_HOMES = {
    "bus_node": ["Node"],
    "floor_plans": ["floor_plan"],
    "laser_node": ["LaserScannerSimulator"],
    "map_node": ["MapServer"],
    "maps": ["load_map", "save_map"],
    "messages": [
        "Clock",
        "GetMap",
        "Header",
        "LaserScan",
        "Odometry",
        "Point",
        "PoseWithCovariance",
        "PoseWithCovarianceStamped",
        "Quaternion",
        "SetPose",
        "String",
        "TFMessage",
        "Time",
        "Transform",
        "TransformStamped",
        "Trigger",
        "Twist",
        "TwistStamped",
        "TwistWithCovariance",
        "Vector3",
    ],
    "robot_node": ["MobileRobotSimulator"],
    "simulation": ["Simulation"],
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "BeamModel",
    "Clock",
    "Contact",
    "GetMap",
    "Header",
    "LaserScan",
    "LaserScanner",
    "LaserScannerSimulator",
    "Limits",
    "MapServer",
    "MobileRobotSimulator",
    "MotionNoise",
    "Node",
    "OccupancyGrid",
    "Odometry",
    "Point",
    "Pose",
    "PoseWithCovariance",
    "PoseWithCovarianceStamped",
    "Quaternion",
    "SetPose",
    "Shape",
    "Simulation",
    "String",
    "TFMessage",
    "Time",
    "Transform",
    "TransformStamped",
    "Trigger",
    "Twist",
    "TwistStamped",
    "TwistWithCovariance",
    "Vector3",
    "__version__",
    "advance",
    "cast_rays",
    "clearance",
    "floor_plan",
    "integrate_twist",
    "load_map",
    "messages",
    "save_map",
    "touches",
]


def __getattr__(name: str) -> Any:
    """Import what is asked for by its name."""
    if name == "messages":
        return import_module(f"{__name__}.messages")
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """All names, imported yet or not."""
    return sorted(__all__)
