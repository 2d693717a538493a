"""RosPublisher: the part of a publisher that ROS 1 and ROS 2 share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

from ..messages import Message
from .disturbances import Disturbances
from .intra_process import IntraProcessTopic


class RosPublisher(ABC):
    """Publishes what the faults of the process make of each message: within the process directly, and through ROS.

    Args:
        topic: Topic within the process.
        disturbances: Faults of the process.
        is_latched: True if later subscribers receive the last message.

    Attributes:
        topic: Topic within the process.
        is_latched: True if later subscribers receive the last message.
        is_active: False once the publisher is destroyed. Messages that a fault delays until then are lost.
    """

    def __init__(self, topic: IntraProcessTopic, disturbances: Disturbances, *, is_latched: bool) -> None:
        self.topic, self.is_latched, self.is_active = topic, is_latched, True
        self._disturbances = disturbances

    def publish_lazily(self, build: Callable[..., Message], *arguments: Any) -> None:
        """Sends the message that `build(*arguments)` returns."""
        self.publish(build(*arguments))

    def publish(self, message: Message) -> None:
        """Sends a message."""
        if self._disturbances.filters:
            self._disturbances.pass_on(self.topic.name, message, self._send)
        else:
            self._send(message)

    def retire(self) -> None:
        """Takes the publisher off its topic."""
        self.topic.publisher_count -= 1
        self.is_active = False

    def _send(self, message: Message) -> None:
        if self.is_active:
            self.topic.deliver(message)
            self._send_through_ros(message)

    @abstractmethod
    def _send_through_ros(self, message: Message) -> None:
        """Sends a message to other processes."""
