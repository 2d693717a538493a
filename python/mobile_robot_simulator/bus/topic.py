"""Topics of the bus, with the publishers and subscriptions that use them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Generic, Protocol

from ..handle import Handle
from ..messages import Message, checked_copy
from ..nodes.interface import M
from ..nodes.message_filters import Filter
from ..quoting import quoted

Tap = Callable[[str, Message, int], None]
"""Called for every message that is sent, with the topic's name, the message and the simulated time [ns]."""

LazyTap = Callable[[str, "Message | partial[Message]", int], None]
"""A tap that can also take the call that builds a message, and makes it later or never."""

Sent = tuple[Message, int]
"""A message and the simulated time at which it was sent [ns]."""


def absolute(name: str) -> str:
    """Returns the name of a topic or service, with a leading slash.

    Raises:
        TypeError: It is not text.
        ValueError: The name is empty or consists of slashes only.
    """
    if not isinstance(name, str):
        raise TypeError(f"the name of a topic or service must be a text, got {quoted(name)}")
    if not name.strip("/"):
        raise ValueError(f"a topic or service must have a name, got {quoted(name)}")
    return name if name.startswith("/") else f"/{name}"


@dataclass(eq=False)
class BusSubscription(Handle, Generic[M]):
    """A callback that receives the messages of a topic.

    Attributes:
        topic: Topic that the callback is subscribed to.
        callback: Called with each message.
        active: False once the subscription is destroyed. Its pending messages are then discarded.
    """

    topic: BusTopic
    callback: Callable[[M], None]
    active: bool = True

    def deliver(self, message: Any) -> None:
        """Calls the callback with a message, unless the subscription is destroyed."""
        if self.active:
            self.callback(message)


@dataclass(frozen=True)
class TopicSnapshot:
    """Saved state of a topic. The defaults are the state of a new topic; see `BusTopic` for the fields."""

    subscriptions: tuple[BusSubscription[Any], ...] = ()
    latest: Message | None = None
    latest_ns: int = 0
    latched: bool = False
    publishers: tuple[BusPublisher[Any], ...] = ()
    kept: tuple[tuple[BusPublisher[Any], Sent], ...] = ()


@dataclass(eq=False)
class BusTopic(Handle):
    """A named channel for messages of one type.

    Attributes:
        name: Absolute name.
        msg_type: Class of the messages.
        subscriptions: Current subscriptions, in the order in which they were created.
        last: Last message sent, or the call that builds it; None before the first one.
        latest_ns: Simulated time at which it was sent [ns].
        latched: True if the topic has had a latched publisher.
        publishers: Current publishers, in the order in which they were created.
        kept: What new subscriptions receive: the last message of each latched publisher, in the order of sending.
    """

    name: str
    msg_type: type[Message]
    subscriptions: tuple[BusSubscription[Any], ...] = ()
    last: Message | partial[Message] | None = None
    latest_ns: int = 0
    latched: bool = False
    publishers: tuple[BusPublisher[Any], ...] = ()
    kept: dict[BusPublisher[Any], Sent] = field(default_factory=dict)

    @property
    def latest(self) -> Message | None:
        """Last message sent, None before the first one."""
        if isinstance(self.last, partial):
            self.last = self.last()
        return self.last

    def subscribe(self, callback: Callable[[M], None]) -> BusSubscription[M]:
        """Adds a subscription for messages that are sent from now on."""
        subscription = BusSubscription(self, callback)
        self.subscriptions = (*self.subscriptions, subscription)
        return subscription

    def unsubscribe(self, subscription: BusSubscription[Any]) -> None:
        """Removes a subscription. It does not receive its pending messages."""
        subscription.active = False
        self.subscriptions = tuple(other for other in self.subscriptions if other is not subscription)

    def remove_publisher(self, publisher: BusPublisher[Any]) -> None:
        """Removes a publisher, with the message that it has kept for later subscriptions."""
        self.publishers = tuple(other for other in self.publishers if other is not publisher)
        self.kept.pop(publisher, None)

    def keep(self, publisher: BusPublisher[Any], message: Message, time_ns: int) -> None:
        """Keeps a message for new subscriptions that a latched publisher has sent at a simulated time [ns]."""
        self.kept.pop(publisher, None)
        self.kept[publisher] = message, time_ns

    def save(self) -> TopicSnapshot:
        """Returns the state that `restore` takes."""
        return TopicSnapshot(
            self.subscriptions, self.latest, self.latest_ns, self.latched, self.publishers, tuple(self.kept.items())
        )

    def restore(self, state: TopicSnapshot) -> None:
        """Puts the topic back into a saved state. Other subscriptions become inactive."""
        for subscription in self.subscriptions:
            subscription.active = False
        self.subscriptions, self.publishers, self.latched = state.subscriptions, state.publishers, state.latched
        self.last, self.latest_ns, self.kept = state.latest, state.latest_ns, dict(state.kept)
        for subscription in self.subscriptions:
            subscription.active = True


class Sender(Protocol):
    """What a publisher needs from the bus.

    Attributes:
        time_ns: Simulated time [ns].
        taps: Functions that see every message when it is sent.
        lazy_taps: Those that get the call that builds a message, if nobody else needs the message.
        filters: Functions that can replace, delay or drop a message before it is sent.
    """

    time_ns: int
    taps: list[Tap]
    lazy_taps: list[LazyTap]
    filters: list[Filter]

    def publish(self, publisher: BusPublisher[Any], message: Message, /) -> None:
        """Passes a message through the filters, then sends it to the current subscriptions. Does not copy it."""


@dataclass(eq=False)
class BusPublisher(Handle, Generic[M]):
    """Sends copies of messages to a topic.

    Attributes:
        bus: The bus.
        topic: Topic that the messages go to.
        latched: True if later subscriptions receive the last message.
    """

    bus: Sender
    topic: BusTopic
    latched: bool = False

    @property
    def topic_name(self) -> str:
        """Absolute name of the topic."""
        return self.topic.name

    def publish(self, message: M) -> None:
        """Sends a copy of the message. The caller can change the message afterwards and send it again.

        Raises:
            TypeError: The topic carries messages of another type, or a field of the message holds a value of a wrong type.
            ValueError: An array in the message has a length that ROS does not allow.
        """
        if not isinstance(message, self.topic.msg_type):
            raise TypeError(f"{self.topic.name} carries {self.topic.msg_type.__name__}, got {quoted(message)}")
        self.bus.publish(self, checked_copy(message))

    def publish_lazily(self, build: Callable[..., Message], *arguments: Any) -> None:
        """Sends the message that `build(*arguments)` returns.

        It is built now if anybody receives it, else when `BusTopic.latest` is read. So the arguments must not change
        afterwards.

        Raises:
            TypeError: The topic carries messages of another type.
        """
        bus, topic, message = self.bus, self.topic, partial(build, *arguments)
        if topic.subscriptions or bus.taps or bus.filters or self.latched:
            bus.publish(self, message())
            return
        topic.last, topic.latest_ns = message, bus.time_ns
        for lazy_tap in bus.lazy_taps:
            lazy_tap(topic.name, message, bus.time_ns)

    def get_subscription_count(self) -> int:
        """Returns the number of subscriptions of the topic."""
        return len(self.topic.subscriptions)


class NoCopyPublisher(BusPublisher[M]):
    """A publisher that sends the message itself, for callers that create a new message each time."""

    def publish(self, message: M) -> None:
        """Sends the message without copying it. The caller must not change it afterwards."""
        self.bus.publish(self, message)
