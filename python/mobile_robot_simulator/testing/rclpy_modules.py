"""Modules that replace rclpy and the message packages, with the objects in each."""

from __future__ import annotations

from typing import Any

from .. import instant, messages
from ..bus import clock, node, parameter, service, timer, topic
from ..nodes.future import Future
from .rclpy_qos import SENSOR_DATA, DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from .ros_messages import generated_packages


class ExternalShutdownException(Exception):
    """Exception of `rclpy.executors`. Nothing on the bus raises it."""


def _do_nothing(*_: Any, **__: Any) -> None:
    pass


def _is_ok(*_: Any, **__: Any) -> bool:
    return True


def _describe_parameter(**_: Any) -> None:
    return None


def _refuse_to_spin(*_: Any, **__: Any) -> None:
    raise RuntimeError("on the bus, nodes are run by the simulation: call sim.run_for(seconds)")


RCLPY: dict[str, dict[str, object]] = {
    "rclpy": {
        **dict.fromkeys(("init", "shutdown", "try_shutdown"), _do_nothing),
        **dict.fromkeys(("spin", "spin_once", "spin_until_future_complete"), _refuse_to_spin),
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
        **dict.fromkeys(("SingleThreadedExecutor", "MultiThreadedExecutor"), _refuse_to_spin),
        "ExternalShutdownException": ExternalShutdownException,
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
    "rcl_interfaces.msg": {
        "ParameterDescriptor": _describe_parameter,
        "SetParametersResult": parameter.SetParametersResult,
    },
}
"""Contents of the modules of rclpy: the object on the bus for each name."""


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
