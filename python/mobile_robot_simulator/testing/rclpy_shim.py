"""rclpy without ROS: while `stand_in` lasts, imports of rclpy and of message packages give the bus's nodes and messages.

A file that says `from rclpy.node import Node` and `from geometry_msgs.msg import Twist` runs on the bus as it is::

    with stand_in():
        from follower import Follower
    simulation.spawn(Follower)

Stood in for: rclpy.node.Node, rclpy.time.Time, rclpy.duration.Duration, rclpy.parameter.Parameter, rclpy.qos,
rclpy.exceptions, rclpy.callback_groups, the classes of what a node creates, and those messages and services that `messages`
has. What runs nodes (rclpy.spin) is left to Simulation.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from types import ModuleType
from typing import Any

from .. import instant, messages
from ..bus import clock, node, parameter, service, timer, topic
from ..nodes.future import Future


class ReliabilityPolicy(Enum):
    """Whether messages may get lost; on the bus none does."""

    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(Enum):
    """Whether the last message is kept for those who come later."""

    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class HistoryPolicy(Enum):
    """How many messages wait; on the bus none does."""

    KEEP_LAST = 1
    KEEP_ALL = 2


@dataclass(frozen=True)
class QoSProfile:
    """How messages of a topic are handed on."""

    depth: int = 10
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
    history: HistoryPolicy = HistoryPolicy.KEEP_LAST


@contextmanager
def stand_in() -> Iterator[None]:
    """Have imports of rclpy's names give the bus's, while it lasts; what was imported before is back afterwards."""
    modules = _modules()
    before = {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] in _roots(modules)}
    sys.modules.update(modules)
    try:
        yield
    finally:
        for name in [name for name in sys.modules if name.split(".")[0] in _roots(modules)]:
            del sys.modules[name]
        sys.modules.update(before)


def _roots(modules: dict[str, ModuleType]) -> set[str]:
    return {name.split(".")[0] for name in modules}


def _spin(*_: Any, **__: Any) -> None:
    raise RuntimeError("on the bus, nodes are run by Simulation: sim.run_for(seconds)")


def _nothing(*_: Any, **__: Any) -> None:
    pass


def _modules() -> dict[str, ModuleType]:
    """The modules stood in for, by their names."""
    contents: dict[str, dict[str, Any]] = {
        "rclpy": {"init": _nothing, "shutdown": _nothing, "try_shutdown": _nothing, "ok": lambda *_, **__: True},
        "rclpy.node": {"Node": node.Node},
        "rclpy.time": {"Time": instant.Instant},
        "rclpy.duration": {"Duration": instant.Duration},
        "rclpy.clock": {"Clock": clock.BusClock},
        "rclpy.parameter": {"Parameter": parameter.Parameter},
        "rclpy.exceptions": {
            "ParameterNotDeclaredException": parameter.ParameterNotDeclaredException,
            "ParameterAlreadyDeclaredException": parameter.ParameterAlreadyDeclaredException,
        },
        "rclpy.publisher": {"Publisher": topic.BusPublisher},
        "rclpy.subscription": {"Subscription": topic.BusSubscription},
        "rclpy.timer": {"Timer": timer.BusTimer},
        "rclpy.service": {"Service": service.BusService},
        "rclpy.client": {"Client": service.BusClient},
        "rclpy.task": {"Future": Future},
        "rclpy.callback_groups": dict.fromkeys(("MutuallyExclusiveCallbackGroup", "ReentrantCallbackGroup"), object),
        "rclpy.executors": {
            **dict.fromkeys(("SingleThreadedExecutor", "MultiThreadedExecutor"), _spin),
            "ExternalShutdownException": type("ExternalShutdownException", (Exception,), {}),
        },
        "rclpy.qos": {
            "QoSProfile": QoSProfile,
            "ReliabilityPolicy": ReliabilityPolicy,
            "QoSReliabilityPolicy": ReliabilityPolicy,
            "DurabilityPolicy": DurabilityPolicy,
            "QoSDurabilityPolicy": DurabilityPolicy,
            "HistoryPolicy": HistoryPolicy,
            "QoSHistoryPolicy": HistoryPolicy,
            "qos_profile_sensor_data": QoSProfile(5, ReliabilityPolicy.BEST_EFFORT),
        },
        "rcl_interfaces.msg": {
            "SetParametersResult": parameter.SetParametersResult,
            "ParameterDescriptor": lambda **_: None,
        },
    }
    contents["rclpy"].update(dict.fromkeys(("spin", "spin_once", "spin_until_future_complete"), _spin))
    for name, kind in vars(messages).items():
        package, _, rest = getattr(kind, "ros_type", "").partition("/")
        if package and name == rest.partition("/")[2]:
            contents.setdefault(f"{package}.{rest.partition('/')[0]}", {})[name] = kind
    modules: dict[str, ModuleType] = {}
    for name in sorted(contents):
        package = name.split(".")[0]
        for each in (package, name):
            modules.setdefault(each, ModuleType(each))
        modules[package].__path__ = []
        vars(modules[name]).update(contents[name])
        if name != package:
            setattr(modules[package], name.partition(".")[2], modules[name])
    return modules
