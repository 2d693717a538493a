"""What a node may ask of its surroundings: the few names of rclpy's Node that the simulator's nodes are written against.

The in-process bus provides them, and so do ROS 1 and ROS 2, so that each node's behaviour is written once.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import Any, Protocol, TypeVar

from ..messages import Message

M = TypeVar("M", bound=Message)
M_contra = TypeVar("M_contra", bound=Message, contravariant=True)


class QoS(Enum):
    """How messages of a topic are handed on."""

    DEFAULT = "default"
    """Reliable, for those who are there."""
    SENSOR_DATA = "sensor_data"
    """The newest reading counts; offered so that every subscriber matches."""
    LATCHED = "latched"
    """The last message is kept for those who come later (transient local)."""
    CLOCK = "clock"
    """The newest time counts."""


class Publisher(Protocol[M_contra]):
    """Sends messages to a topic."""

    def publish(self, message: M_contra, /) -> None:
        """Send one message."""


class Timer(Protocol):
    """Calls back at a steady rate."""

    def cancel(self) -> None:
        """Never call back again."""


class Future(Protocol):
    """A service's answer, once it is there."""

    def done(self) -> bool:
        """Whether the answer is there."""

    def result(self) -> Any:
        """The answer."""

    def add_done_callback(self, callback: Callable[[Any], None], /) -> None:
        """Call back with the future once the answer is there."""


class Client(Protocol):
    """Calls a service."""

    def service_is_ready(self) -> bool:
        """Whether anyone answers."""

    def call_async(self, request: Any, /) -> Future:
        """Ask; the answer comes later."""


class Instant(Protocol):
    """A moment of a clock."""

    @property
    def nanoseconds(self) -> int:
        """Nanoseconds since the clock's zero."""


class Clock(Protocol):
    """Tells the time."""

    def now(self) -> Instant:
        """The moment it is."""


class Logger(Protocol):
    """Takes notes."""

    def info(self, message: str, /) -> Any:
        """What is going on."""

    def warning(self, message: str, /) -> Any:
        """What should not be."""


class Node(Protocol):
    """The surroundings of one node."""

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS, /) -> Publisher[M]:
        """A publisher of messages of one type to a topic."""

    def create_subscription(self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: QoS, /) -> Any:
        """Have every message of a topic handed to the callback."""

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None], /) -> Timer:
        """Have the callback called once a period, first after one period."""

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any], /) -> Any:
        """Answer requests: the callback fills in and returns the response it is given."""

    def create_client(self, srv_type: Any, srv_name: str, /) -> Client:
        """A client of a service."""

    def destroy_publisher(self, publisher: Any, /) -> Any:
        """Take a publisher away."""

    def destroy_subscription(self, subscription: Any, /) -> Any:
        """Take a subscription away."""

    def destroy_timer(self, timer: Any, /) -> Any:
        """Take a timer away."""

    def destroy_service(self, service: Any, /) -> Any:
        """Take a service away."""

    def destroy_client(self, client: Any, /) -> Any:
        """Take a client away."""

    def get_clock(self) -> Clock:
        """The clock that stamps are taken from."""

    def set_speed(self, factor: float, /) -> None:
        """Have the clock go so many times as fast as the wall's from now on, where that is this node's to say."""

    def get_logger(self) -> Logger:
        """Where notes go."""
