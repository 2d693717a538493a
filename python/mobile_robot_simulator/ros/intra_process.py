"""LocalTopics: messages between the nodes of one ROS process, handed over without a way through ROS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..messages import Message
from ..nodes.interface import QoS


class LocalTopics:
    """Hands what a node publishes to the nodes of the same process directly, for as long as nobody else publishes the topic.

    Through ROS, a message to oneself costs several times what it takes to make and to use it. Once others publish the topic
    too, all of it comes through ROS, so that nothing comes twice; what is latched always does.
    """

    def __init__(self) -> None:
        self._topics: dict[tuple[str, type[Message]], Topic] = {}

    @property
    def names(self) -> set[str]:
        """Topics that nodes here both publish and subscribe to."""
        return {topic.name for topic in tuple(self._topics.values()) if topic.publishers and topic.subscriptions}

    def topic(self, name: str, msg_type: type[Message]) -> Topic:
        """The topic of a name that is resolved."""
        return self._topics.setdefault((name, msg_type), Topic(name))

    def advertise(self, name: str, msg_type: type[Message]) -> Topic:
        """The topic, with one publisher more in this process."""
        topic = self.topic(name, msg_type)
        topic.publishers += 1
        return topic

    def look(self, is_shared: Callable[[Topic], bool]) -> None:
        """Choose anew which way messages take. is_shared: whether others publish a topic that nodes here publish."""
        for topic in self._topics.values():
            if topic.subscriptions:
                topic.choose(is_local=topic.publishers > 0 and not is_shared(topic))


class Topic:
    """A topic as one process knows it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.publishers = 0
        """How many publishers there are in the process."""
        self.subscriptions: list[Subscription] = []
        self._direct: tuple[Callable[[Any], None], ...] = ()

    def hand(self, message: Message) -> None:
        """Hand a message to those subscribers that it does not reach through ROS."""
        for callback in self._direct:
            callback(message)

    def subscribe(
        self, qos: QoS, callback: Callable[[Any], None], listen: Callable[[], Callable[[], object]]
    ) -> Subscription:
        """Have messages handed to the callback. listen: starts listening through ROS, and gives what ends that."""
        subscription = Subscription(self, callback, listen)
        may_be_local = qos is QoS.DEFAULT
        subscription.set_local(may_be_local and self.publishers > 0)
        if may_be_local:
            self.subscriptions.append(subscription)
            self._update()
        return subscription

    def choose(self, *, is_local: bool) -> None:
        """Have messages take the direct way, or that through ROS."""
        for subscription in self.subscriptions:
            subscription.set_local(is_local)
        self._update()

    def unsubscribe(self, subscription: Subscription) -> None:
        """Take a subscription away."""
        subscription.set_local(True)
        if subscription in self.subscriptions:
            self.subscriptions.remove(subscription)
            self._update()

    def _update(self) -> None:
        self._direct = tuple(each.callback for each in self.subscriptions if each.is_local)


class Subscription:
    """A callback for a topic's messages, whichever way they come."""

    def __init__(self, topic: Topic, callback: Callable[[Any], None], listen: Callable[[], Callable[[], object]]) -> None:
        self.topic, self.callback = topic, callback
        self._listen = listen
        self._end: Callable[[], object] | None = None

    @property
    def is_local(self) -> bool:
        """Whether it does not listen to ROS."""
        return self._end is None

    def set_local(self, is_local: bool) -> None:
        """Listen to ROS, or do not."""
        if is_local and self._end is not None:
            self._end()
            self._end = None
        elif not is_local and self._end is None:
            self._end = self._listen()
