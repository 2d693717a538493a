"""Modules that replace rclpy and the message packages, with the objects in each."""

from __future__ import annotations

from typing import Any

from .. import instant, messages
from ..bus import clock, node, parameter, service, timer, topic
from ..nodes.future import Future
from .executors import SPINS, Executor, ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from .filters import ApproximateTimeSynchronizer, Cache, SimpleFilter, Subscriber, TimeSynchronizer
from .rclpy_qos import SENSOR_DATA, DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
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


def _do_nothing(*_: Any, **__: Any) -> None:
    pass


def _is_ok(*_: Any, **__: Any) -> bool:
    return True


def _describe_parameter(**_: Any) -> None:
    return None


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

RCLPY: dict[str, dict[str, object]] = {
    "rclpy": {
        **dict.fromkeys(("init", "shutdown", "try_shutdown"), _do_nothing),
        **SPINS,
        "create_node": node.Node,
        "ok": _is_ok,
    },
    "rclpy.callback_groups": dict.fromkeys(("MutuallyExclusiveCallbackGroup", "ReentrantCallbackGroup"), object),
    "rclpy.client": {"Client": service.BusClient},
    "rclpy.clock": {"Clock": clock.BusClock},
    "rclpy.duration": {"Duration": instant.Duration},
    "rclpy.exceptions": {
        "ParameterAlreadyDeclaredException": parameter.ParameterAlreadyDeclaredException,
        "ParameterNotDeclaredException": parameter.ParameterNotDeclaredException,
    },
    "rclpy.executors": {
        kind.__name__: kind for kind in (Executor, SingleThreadedExecutor, MultiThreadedExecutor, ExternalShutdownException)
    },
    "rclpy.node": {"Node": node.Node},
    "rclpy.parameter": {"Parameter": parameter.Parameter},
    "rclpy.publisher": {"Publisher": topic.BusPublisher},
    "rclpy.qos": {
        "QoSProfile": QoSProfile,
        **dict.fromkeys(("ReliabilityPolicy", "QoSReliabilityPolicy"), ReliabilityPolicy),
        **dict.fromkeys(("DurabilityPolicy", "QoSDurabilityPolicy"), DurabilityPolicy),
        **dict.fromkeys(("HistoryPolicy", "QoSHistoryPolicy"), HistoryPolicy),
        "qos_profile_sensor_data": SENSOR_DATA,
    },
    "rclpy.service": {"Service": service.BusService},
    "rclpy.subscription": {"Subscription": topic.BusSubscription},
    "rclpy.task": {"Future": Future},
    "rclpy.time": {"Time": instant.Instant},
    "rclpy.timer": {"Timer": timer.BusTimer},
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
    "rcl_interfaces.msg": {
        "ParameterDescriptor": _describe_parameter,
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
