"""IntraProcessTopics: delivers messages between the nodes of one ROS process without going through ROS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..messages import Message
from ..nodes.interface import QoS

SubscribeThroughRos = Callable[[], Callable[[], object]]
"""Function that subscribes through ROS and returns a function that ends this subscription."""


class IntraProcessTopics:
    """The topics of one process, with the route that messages take to its subscriptions: direct, or through ROS.

    Sending a message through ROS to the same process costs several times as much as making and using the message. So a
    message is delivered directly while only this process publishes the topic. Once another process publishes it too, all
    messages of the topic come through ROS, and none arrives twice.

    Only subscriptions with `QoS.DEFAULT` are delivered directly. All others, latched ones among them, always use ROS.
    """

    def __init__(self) -> None:
        self._topics: dict[tuple[str, type[Message]], IntraProcessTopic] = {}

    @property
    def names(self) -> set[str]:
        """Names of the topics with both a publisher and a subscription (of `QoS.DEFAULT`) in this process."""
        return {topic.name for topic in tuple(self._topics.values()) if topic.publisher_count and topic.subscriptions}

    def topic(self, name: str, msg_type: type[Message]) -> IntraProcessTopic:
        """Returns the topic of a name and a type; the same object at every call.

        Args:
            name: Fully resolved name, such as /robot/odom.
            msg_type: Class of its messages. Topics of the same name and another type are separate.
        """
        return self._topics.setdefault((name, msg_type), IntraProcessTopic(name))

    def advertise(self, name: str, msg_type: type[Message]) -> IntraProcessTopic:
        """Counts one more publisher of a topic in this process, and returns the topic. Same arguments as `topic`."""
        topic = self.topic(name, msg_type)
        topic.publisher_count += 1
        return topic

    def update_routes(self, has_other_publishers: Callable[[IntraProcessTopic], bool]) -> None:
        """Chooses the route of every topic again. Must be called when publishers may have come or gone.

        Args:
            has_other_publishers: Returns whether another process publishes the topic. It is only called for topics with a
                publisher in this process.
        """
        for topic in self._topics.values():
            if topic.subscriptions:
                topic.set_route(direct=topic.publisher_count > 0 and not has_other_publishers(topic))


class IntraProcessTopic:
    """A topic as one process knows it.

    Args:
        name: Fully resolved name.

    Attributes:
        name: Fully resolved name.
        publisher_count: Number of publishers in this process.
        subscriptions: Subscriptions of this process with `QoS.DEFAULT`.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.publisher_count = 0
        self.subscriptions: list[IntraProcessSubscription] = []
        self._direct_callbacks: tuple[Callable[[Any], None], ...] = ()

    def deliver(self, message: Message) -> None:
        """Calls all subscriptions that do not get the message through ROS."""
        for callback in self._direct_callbacks:
            callback(message)

    def subscribe(
        self, qos: QoS, callback: Callable[[Any], None], subscribe_through_ros: SubscribeThroughRos
    ) -> IntraProcessSubscription:
        """Calls the callback with every message, on whichever route it comes.

        Args:
            qos: Quality of service. Only `QoS.DEFAULT` allows direct delivery.
            callback: Called with messages that are delivered directly.
            subscribe_through_ros: Subscribes the callback through ROS.
        """
        subscription = IntraProcessSubscription(self, callback, subscribe_through_ros)
        can_be_direct = qos is QoS.DEFAULT
        subscription.set_route(direct=can_be_direct and self.publisher_count > 0)
        if can_be_direct:
            self.subscriptions.append(subscription)
            self._collect_callbacks()
        return subscription

    def set_route(self, *, direct: bool) -> None:
        """Delivers messages to all subscriptions directly, or through ROS."""
        for subscription in self.subscriptions:
            subscription.set_route(direct=direct)
        self._collect_callbacks()

    def unsubscribe(self, subscription: IntraProcessSubscription) -> None:
        """Ends a subscription, on either route."""
        subscription.set_route(direct=True)
        if subscription in self.subscriptions:
            self.subscriptions.remove(subscription)
            self._collect_callbacks()

    def _collect_callbacks(self) -> None:
        self._direct_callbacks = tuple(each.callback for each in self.subscriptions if each.is_direct)


class IntraProcessSubscription:
    """A callback for the messages of a topic, subscribed through ROS or not.

    Args:
        topic: Topic of the subscription.
        callback: Called with messages that are delivered directly.
        subscribe_through_ros: Subscribes the callback through ROS.
    """

    def __init__(
        self, topic: IntraProcessTopic, callback: Callable[[Any], None], subscribe_through_ros: SubscribeThroughRos
    ) -> None:
        self.topic, self.callback = topic, callback
        self._subscribe_through_ros = subscribe_through_ros
        self._unsubscribe_from_ros: Callable[[], object] | None = None

    @property
    def is_direct(self) -> bool:
        """True if the subscription does not exist in ROS."""
        return self._unsubscribe_from_ros is None

    def set_route(self, *, direct: bool) -> None:
        """Ends the subscription through ROS, or starts it. Does nothing if the route stays the same."""
        if direct and self._unsubscribe_from_ros is not None:
            self._unsubscribe_from_ros()
            self._unsubscribe_from_ros = None
        elif not direct and self._unsubscribe_from_ros is None:
            self._unsubscribe_from_ros = self._subscribe_through_ros()
