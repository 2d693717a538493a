"""Quality-of-service profiles with the names of `rclpy.qos`. On the bus, only the durability has an effect."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class ReliabilityPolicy(Enum):
    """Whether messages can be lost. The bus loses none."""

    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(Enum):
    """Whether later subscribers get the last message."""

    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class HistoryPolicy(Enum):
    """How many messages are queued. The bus delivers all."""

    KEEP_LAST = 1
    KEEP_ALL = 2


@dataclass(frozen=True)
class QoSProfile:
    """Quality of service of a topic.

    Attributes:
        depth: Length of the queue.
        reliability: Whether messages can be lost.
        durability: Whether later subscribers get the last message.
        history: How many messages are queued.
    """

    depth: int = 10
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
    history: HistoryPolicy = HistoryPolicy.KEEP_LAST


SENSOR_DATA = QoSProfile(5, ReliabilityPolicy.BEST_EFFORT)
"""The profile that rclpy calls `qos_profile_sensor_data`."""
