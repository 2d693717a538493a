"""Modules that replace rclpy and the message packages, with the objects in each."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from enum import Enum
from time import monotonic_ns
from typing import Any

from .. import instant, messages
from ..bus import clock, node, parameter, service, timer, topic
from ..bus.logger import BusLogger
from ..bus.parameter_descriptor import FloatingPointRange, IntegerRange, ParameterDescriptor
from ..bus.task import BusTask
from ..nodes.future import Future
from .action_client import ActionClient, ClientGoalHandle
from .action_server import ActionServer, CancelResponse, GoalResponse, ServerGoalHandle
from .executors import SPINS, Executor, ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from .filters import ApproximateTimeSynchronizer, Cache, SimpleFilter, Subscriber, TimeSynchronizer
from .lifecycle import LIFECYCLE
from .rclpy_qos import qos_contents
from .ros_messages import generated_packages
from .tf2 import (
    Buffer,
    ConnectivityException,
    ExtrapolationException,
    LookupException,
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformException,
    TransformListener,
    do_transform_point,
    do_transform_pose,
    do_transform_pose_stamped,
    do_transform_vector3,
)


class ClockType(Enum):
    """Kinds of clocks. On the bus, all of them show simulated time."""

    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


class ROSInterruptException(Exception):
    """Exception of `rclpy.exceptions`. Nothing on the bus raises it."""


class _WallClock:
    """The clock of loggers that belong to no node."""

    def now(self) -> instant.Instant:
        return instant.Instant(monotonic_ns())


def _get_logger(name: str) -> BusLogger:
    return BusLogger(_WallClock(), name)


def _without_ros_arguments(args: Sequence[str] | None = None) -> list[str]:
    """Returns the arguments without those between `--ros-args` and `--`, or the end."""
    kept, is_ros = list[str](), False
    for argument in sys.argv if args is None else args:
        if argument == "--ros-args" or (is_ros and argument == "--"):
            is_ros = argument == "--ros-args"
        elif not is_ros:
            kept.append(argument)
    return kept


def _do_nothing(*_: Any, **__: Any) -> None:
    pass


def _is_ok(*_: Any, **__: Any) -> bool:
    return True


TF2: dict[str, object] = {
    kind.__name__: kind
    for kind in (
        Buffer,
        TransformListener,
        TransformBroadcaster,
        StaticTransformBroadcaster,
        TransformException,
        LookupException,
        ConnectivityException,
        ExtrapolationException,
    )
}
"""Contents of `tf2_ros`."""

ACTION: dict[str, object] = {
    kind.__name__: kind
    for kind in (ActionClient, ActionServer, CancelResponse, ClientGoalHandle, GoalResponse, ServerGoalHandle)
}
"""Contents of `rclpy.action`."""

RCLPY: dict[str, dict[str, object]] = {
    "rclpy": {
        **dict.fromkeys(("init", "shutdown", "try_shutdown"), _do_nothing),
        **SPINS,
        "create_node": node.Node,
        "ok": _is_ok,
    },
    "rclpy.action": ACTION,
    "rclpy.action.client": ACTION,
    "rclpy.action.server": ACTION,
    "rclpy.callback_groups": dict.fromkeys(("MutuallyExclusiveCallbackGroup", "ReentrantCallbackGroup"), object),
    "rclpy.client": {"Client": service.BusClient},
    "rclpy.clock": {"Clock": clock.BusClock, "ROSClock": clock.BusClock, "ClockType": ClockType},
    "rclpy.duration": {"Duration": instant.Duration},
    "rclpy.exceptions": {
        "ROSInterruptException": ROSInterruptException,
        "InvalidParameterValueException": parameter.InvalidParameterValueException,
        "ParameterAlreadyDeclaredException": parameter.ParameterAlreadyDeclaredException,
        "ParameterImmutableException": parameter.ParameterImmutableException,
        "ParameterNotDeclaredException": parameter.ParameterNotDeclaredException,
    },
    "rclpy.executors": {
        kind.__name__: kind for kind in (Executor, SingleThreadedExecutor, MultiThreadedExecutor, ExternalShutdownException)
    },
    "rclpy.lifecycle": LIFECYCLE,
    "rclpy.lifecycle.node": LIFECYCLE,
    "rclpy.logging": {"get_logger": _get_logger},
    "rclpy.node": {"Node": node.Node},
    "rclpy.parameter": {"Parameter": parameter.Parameter},
    "rclpy.publisher": {"Publisher": topic.BusPublisher},
    "rclpy.qos": qos_contents(),
    "rclpy.service": {"Service": service.BusService},
    "rclpy.subscription": {"Subscription": topic.BusSubscription},
    "rclpy.task": {"Future": Future, "Task": BusTask},
    "rclpy.time": {"Time": instant.Instant, "Duration": instant.Duration},
    "rclpy.timer": {"Timer": timer.BusTimer},
    "rclpy.utilities": {
        **dict.fromkeys(("shutdown", "try_shutdown"), _do_nothing),
        "ok": _is_ok,
        "remove_ros_args": _without_ros_arguments,
    },
    "tf2_ros": TF2,
    "tf2_ros.buffer": TF2,
    "tf2_ros.transform_broadcaster": TF2,
    "tf2_ros.transform_listener": TF2,
    "tf2_ros.static_transform_broadcaster": {"StaticTransformBroadcaster": StaticTransformBroadcaster},
    "tf2_geometry_msgs": {
        kind.__name__: kind
        for kind in (do_transform_pose, do_transform_pose_stamped, do_transform_point, do_transform_vector3)
    },
    "message_filters": {
        kind.__name__: kind for kind in (SimpleFilter, Subscriber, Cache, TimeSynchronizer, ApproximateTimeSynchronizer)
    },
    "rcl_interfaces.msg": {kind.__name__: kind for kind in (ParameterDescriptor, FloatingPointRange, IntegerRange)}
    | {
        "SetParametersResult": parameter.SetParametersResult,
    },
}
"""Contents of the modules of rclpy, tf2 and message_filters: the object on the bus for each name."""


def message_packages() -> dict[str, dict[str, object]]:
    """Returns the classes of `messages` by ROS module and name, such as `geometry_msgs.msg` and `Twist`."""
    packages: dict[str, dict[str, object]] = {}
    for name, kind in vars(messages).items():
        package, _, rest = getattr(kind, "ros_type", "").partition("/")
        folder, _, ros_name = rest.partition("/")
        if package and name == ros_name:
            packages.setdefault(f"{package}.{folder}", {})[name] = kind
    return packages


def module_contents() -> dict[str, dict[str, object]]:
    """Returns the contents of all replaced modules: those of rclpy and the message packages.

    A class of `messages` has priority over a generated class, because the nodes of the simulator exchange it.
    """
    contents: dict[str, dict[str, object]] = {}
    for source in (generated_packages(), message_packages(), RCLPY):
        for module, names in source.items():
            contents.setdefault(module, {}).update(names)
    return contents
