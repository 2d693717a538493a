"""Quality-of-service profiles with the names of `rclpy.qos`. On the bus, only the durability has an effect."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any


class ReliabilityPolicy(Enum):
    """Whether messages can be lost. The bus loses none."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(Enum):
    """Whether later subscribers get the last message."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class HistoryPolicy(Enum):
    """How many messages are queued. The bus delivers all."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2


class LivelinessPolicy(Enum):
    """How a publisher shows that it is alive. Has no effect on the bus."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3


@dataclass
class QoSProfile:
    """Quality of service of a topic.

    Attributes:
        depth: Length of the queue.
        reliability: Whether messages can be lost.
        durability: Whether later subscribers get the last message.
        history: How many messages are queued.
        liveliness: How a publisher shows that it is alive.
        lifespan: Age at which a message expires. Has no effect on the bus.
        deadline: Longest time between two messages. Has no effect on the bus.
        liveliness_lease_duration: Time without a sign of life after which a publisher counts as gone. Has no effect.
        avoid_ros_namespace_conventions: Has no effect on the bus.
    """

    depth: int = 10
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
    history: HistoryPolicy = HistoryPolicy.KEEP_LAST
    liveliness: LivelinessPolicy = LivelinessPolicy.SYSTEM_DEFAULT
    lifespan: Any = None
    deadline: Any = None
    liveliness_lease_duration: Any = None
    avoid_ros_namespace_conventions: bool = False


PRESETS = {
    "SENSOR_DATA": QoSProfile(5, ReliabilityPolicy.BEST_EFFORT),
    "SYSTEM_DEFAULT": QoSProfile(
        0, ReliabilityPolicy.SYSTEM_DEFAULT, DurabilityPolicy.SYSTEM_DEFAULT, HistoryPolicy.SYSTEM_DEFAULT
    ),
    "SERVICES_DEFAULT": QoSProfile(10),
    "PARAMETERS": QoSProfile(1000),
    "PARAMETER_EVENTS": QoSProfile(1000),
}
"""The profiles of rclpy by their names in `QoSPresetProfiles`."""


def qos_contents() -> dict[str, object]:
    """Returns the contents of `rclpy.qos`."""
    contents: dict[str, object] = {
        "QoSProfile": QoSProfile,
        "QoSPresetProfiles": Enum("QoSPresetProfiles", PRESETS),
        "qos_profile_sensor_data": PRESETS["SENSOR_DATA"],
        "qos_profile_system_default": PRESETS["SYSTEM_DEFAULT"],
        "qos_profile_services_default": PRESETS["SERVICES_DEFAULT"],
        "qos_profile_parameters": PRESETS["PARAMETERS"],
        "qos_profile_parameter_events": PRESETS["PARAMETER_EVENTS"],
    }
    for policy in (ReliabilityPolicy, DurabilityPolicy, HistoryPolicy, LivelinessPolicy):
        contents[policy.__name__] = contents[f"QoS{policy.__name__}"] = policy
    return contents
