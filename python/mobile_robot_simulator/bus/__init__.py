"""Topics, services, timers and parameters in one process, on a simulated clock: the node interface without ROS.

`Node` replaces `rclpy.node.Node`. `Simulation.spawn` puts its subclasses on the simulation's bus.
"""

from ..nodes.message_filters import Filter
from .bus import Bus, BusSnapshot
from .clock import BusClock
from .logger import BusLogger
from .node import BusNode, NoCopyNode, Node
from .parameter import (
    Parameter,
    ParameterAlreadyDeclaredException,
    ParameterNotDeclaredException,
    ParameterType,
    SetParametersResult,
)
from .service import BusClient, BusService
from .timer import BusTimer
from .topic import BusPublisher, BusSubscription, BusTopic, LazyTap, Tap

__all__ = [
    "Bus",
    "BusClient",
    "BusClock",
    "BusLogger",
    "BusNode",
    "BusPublisher",
    "BusService",
    "BusSnapshot",
    "BusSubscription",
    "BusTimer",
    "BusTopic",
    "Filter",
    "LazyTap",
    "NoCopyNode",
    "Node",
    "Parameter",
    "ParameterAlreadyDeclaredException",
    "ParameterNotDeclaredException",
    "ParameterType",
    "SetParametersResult",
    "Tap",
]
