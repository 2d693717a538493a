"""Topics: publishing, subscribing and recording on the existing topics of a simulation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from ..bus.bus import Bus
from ..bus.node import BusNode
from ..bus.topic import BusPublisher, BusSubscription, BusTopic, LazyTap, Tap, absolute
from ..handle import check_callback
from ..instant import NANOSECONDS
from ..messages import Message
from ..nodes.interface import M, QoS
from ..quoting import nearest, quoted

T_co = TypeVar("T_co", covariant=True)


class HasTopics(Protocol[T_co]):
    """What has topics: the bus, or a process on ROS."""

    def find_topic(self, name: str) -> T_co | None:
        """Returns the topic of a name, or None if it does not exist."""

    def topic_names(self) -> list[str]:
        """Returns the names of all topics, sorted."""


def find_topic(bus: HasTopics[T_co], name: str) -> T_co:
    """Returns an existing topic.

    Args:
        bus: What has the topics.
        name: Name of the topic, with or without a leading slash.

    Raises:
        ValueError: There is no such topic. The message suggests the most similar name.
    """
    found = bus.find_topic(name)
    if found is None:
        names = bus.topic_names()
        near = nearest(absolute(name), names)
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(names) or 'none'}"
        raise ValueError(f"unknown topic {quoted(name)}; {hint}")
    return found


class Topics:
    """The topics of one simulation. Only `subscribe` creates a topic.

    Args:
        bus: The bus of the simulation.
        node: The node through which messages are sent and received.
    """

    def __init__(self, bus: Bus, node: BusNode) -> None:
        self._bus, self._node = bus, node
        self._publishers: dict[tuple[str, type[Message]], BusPublisher[Any]] = {}

    def publish(self, name: str, message: Message) -> None:
        """Publishes a message, as described for `Simulation.publish`."""
        key = name, type(message)
        publisher = self._publishers.get(key) if isinstance(name, str) else None
        if publisher is None:
            found = self._find(name)
            if not isinstance(message, Message):
                raise TypeError(f"{found.name} carries {found.msg_type.__name__}, got {message!r}")
            qos = QoS.LATCHED if found.latched else QoS.DEFAULT
            publisher = self._publishers[key] = self._node.create_publisher(type(message), name, qos)
        publisher.publish(message)

    def subscribe(self, name: str, msg_type: type[M], callback: Callable[[M], None]) -> BusSubscription[M]:
        """Subscribes a callback, as described for `Simulation.subscribe`."""
        is_new, near = self._bus.find_topic(name) is None, nearest(absolute(name), self._bus.topic_names())
        subscription = self._node.create_subscription(msg_type, name, callback)
        if is_new and near:
            # Not an error: /scan2 beside /scan may get its publisher later.
            self._node.get_logger().warning(f"nobody publishes on {absolute(name)} yet; did you mean {near[0]}?")
        return subscription

    def unsubscribe(self, subscription: BusSubscription[Any]) -> None:
        """Ends a subscription, as described for `Simulation.unsubscribe`."""
        if not isinstance(subscription, BusSubscription):
            raise TypeError(f"the subscription must be one that subscribe returned, got {quoted(subscription)}")
        if not self._node.destroy_subscription(subscription) and subscription.active:
            raise ValueError(f"the subscription to {subscription.topic.name} must be one of this simulation's subscribe")

    def latest(self, name: str) -> Message | None:
        """Returns the last message of a topic, as described for `Simulation.latest`."""
        found = self._bus.find_topic(name)
        return (self._find(name) if found is None else found).latest

    def record(self, tap: Tap) -> None:
        """Passes all messages to a tap, as described for `Simulation.record`."""
        check_callback(tap)
        self._bus.check_open()
        for topic, message, time_ns in self._bus.latched():
            tap(topic, message, time_ns)
        self._bus.taps.append(tap)

    def record_lazily(self, tap: LazyTap) -> None:
        """Passes all messages to a tap, or the calls that build them, as described for `Simulation.record_lazily`."""
        check_callback(tap)
        self._bus.check_open()
        for topic, message, time_ns in self._bus.latched():
            tap(topic, message, time_ns)
        self._bus.lazy_taps.append(tap)

    def stop_recording(self, tap: Tap | LazyTap) -> None:
        """Removes a tap, as described for `Simulation.stop_recording`."""
        for taps in (self._bus.taps, self._bus.lazy_taps):
            if tap in taps:
                taps.remove(tap)  # type: ignore[arg-type]
                return
        raise ValueError(f"the tap must be one that is recording, got {quoted(tap)}")

    def forget_publishers(self) -> None:
        """Drops all publishers. Must be called after topics may have been removed from the bus."""
        self._publishers.clear()

    def last_times(self) -> str:
        """Returns a text with the time of the last message of each topic."""
        return ", ".join(
            f"{topic.name} {'never' if topic.latest is None else f'at {topic.latest_ns / NANOSECONDS:g} s'}"
            for topic in self._bus.topics()
        )

    def _find(self, name: str) -> BusTopic:
        """Returns an existing topic, or says why there is none."""
        self._bus.check_open()
        return find_topic(self._bus, name)
