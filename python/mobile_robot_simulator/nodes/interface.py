"""The node interface: the few methods of rclpy's Node that the simulator's nodes use.

The in-process bus, ROS 1 and ROS 2 each implement it, so each node's behaviour is written only once. All protocols keep the
names and the argument order of rclpy. `set_speed`, `create_wall_timer`, `create_subscription_of_either` and
`publish_lazily` are additions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from typing import Any, Protocol, TypeVar

from ..messages import Message
from .future import Future

M = TypeVar("M", bound=Message)
M_contra = TypeVar("M_contra", bound=Message, contravariant=True)


class QoS(Enum):
    """Quality of service of a topic."""

    DEFAULT = "default"
    """Reliable; only current subscribers receive a message."""
    SENSOR_DATA = "sensor_data"
    """Only the newest reading matters. Publishers offer a profile that is compatible with every subscriber."""
    LATCHED = "latched"
    """Reliable; a new subscriber also receives the last message (transient local)."""
    CLOCK = "clock"
    """Only the newest time matters."""


class Publisher(Protocol[M_contra]):
    """Sends messages to a topic."""

    def publish(self, message: M_contra, /) -> None:
        """Sends a message."""

    def publish_lazily(self, build: Callable[..., M_contra], /, *arguments: Any) -> None:
        """Sends the message that `build(*arguments)` returns.

        The message may be built later, or never if nobody receives it. So the arguments must not change afterwards.
        """


class Timer(Protocol):
    """Calls a callback periodically."""

    def cancel(self) -> None:
        """Stops the timer."""


class Client(Protocol):
    """Calls a service."""

    def service_is_ready(self) -> bool:
        """Returns True if a node offers the service now."""

    def call_async(self, request: Any, /) -> Future:
        """Sends a request. The returned future completes when the response arrives."""


class Instant(Protocol):
    """A time read from a clock."""

    @property
    def nanoseconds(self) -> int:
        """Time since the clock's zero [ns]."""


class Clock(Protocol):
    """Tells the time."""

    def now(self) -> Instant:
        """Returns the current time."""


class Logger(Protocol):
    """Logs messages of a node."""

    def info(self, message: str, /) -> Any:
        """Logs normal progress."""

    def warning(self, message: str, /) -> Any:
        """Logs a problem that the node can work around."""


class Node(Protocol):
    """Gives one node access to topics, services, timers, a clock and a logger."""

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS, /) -> Publisher[M]:
        """Creates a publisher for messages of one type."""

    def create_subscription(self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: QoS, /) -> Any:
        """Calls the callback with every message on a topic. Returns a handle for `destroy_subscription`."""

    def create_subscription_of_either(
        self, callbacks: Mapping[type[Message], Callable[[Any], None]], topic: str, qos_profile: QoS, /
    ) -> Any:
        """Calls one of the callbacks with every message on a topic that may be of several types.

        The subscription has the first type, or another one while others publish only that. On the bus, where a topic has one
        type, it has the first type. Returns a handle for `destroy_subscription`.
        """

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None], /) -> Timer:
        """Calls the callback once per period [s], for the first time after one period."""

    def create_wall_timer(self, timer_period_sec: float, callback: Callable[[], None], /) -> Timer:
        """Calls the callback once per period of wall time [s], even while the node's clock stands still.

        Where there is no wall time, as on the in-process bus, the same as `create_timer`.
        """

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any], /) -> Any:
        """Offers a service. The callback takes the request and an empty response, and returns the response."""

    def create_client(self, srv_type: Any, srv_name: str, /) -> Client:
        """Creates a client for a service."""

    def resolve_topic_name(self, topic: str, /) -> str:
        """Returns the full name of a topic, after namespaces and remapping."""

    def resolve_service_name(self, service: str, /) -> str:
        """Returns the full name of a service, after namespaces and remapping."""

    def destroy_publisher(self, publisher: Any, /) -> Any:
        """Destroys a publisher."""

    def destroy_subscription(self, subscription: Any, /) -> Any:
        """Destroys a subscription."""

    def destroy_timer(self, timer: Any, /) -> Any:
        """Destroys a timer."""

    def destroy_service(self, service: Any, /) -> Any:
        """Stops offering a service."""

    def destroy_client(self, client: Any, /) -> Any:
        """Destroys a client."""

    def get_clock(self) -> Clock:
        """Returns the clock that gives message stamps their time."""

    def set_speed(self, factor: float, /) -> None:
        """Sets the simulated seconds per wall second. Has no effect if this node does not control the clock."""

    def get_logger(self) -> Logger:
        """Returns the node's logger."""
