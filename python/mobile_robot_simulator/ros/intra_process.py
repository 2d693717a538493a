"""IntraProcessTopics: delivers messages between the nodes of one ROS process directly, without ROS, where possible."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Any

from ..messages import Message
from ..nodes.interface import QoS
from .either_subscription import EitherSubscription

SubscribeThroughRos = Callable[[], Callable[[], object]]
"""Function that subscribes through ROS and returns a function that ends this subscription."""


class IntraProcessTopics:
    """The topics of one process. Chooses how messages reach its subscriptions: directly, or through ROS.

    Sending a message through ROS to the same process costs several times as much as making and using the message. So
    messages are delivered directly while only this process publishes the topic. While another process publishes it too, all
    messages of the topic come through ROS, so that none arrives twice.

    Only subscriptions with `QoS.DEFAULT` receive messages directly. All others, including latched ones, always use ROS.
    """

    def __init__(self) -> None:
        self._topics: dict[tuple[str, type[Message]], IntraProcessTopic] = {}
        self.either: list[EitherSubscription] = []
        """Subscriptions whose type depends on what others publish."""

    @property
    def names(self) -> set[str]:
        """Names of the topics that have both a publisher and a subscription with `QoS.DEFAULT` in this process."""
        return {topic.name for topic in tuple(self._topics.values()) if topic.publisher_count and topic.subscriptions}

    def topic(self, name: str, msg_type: type[Message]) -> IntraProcessTopic:
        """Returns the topic with this name and type. Every call returns the same object.

        Args:
            name: Fully resolved name, such as /robot/odom.
            msg_type: Class of its messages. The same name with another type is a separate topic.
        """
        return self._topics.setdefault((name, msg_type), IntraProcessTopic(name, msg_type))

    def used(self) -> list[IntraProcessTopic]:
        """Returns the topics that have a publisher or a subscription in this process."""
        return [topic for topic in self._topics.values() if topic.publisher_count or topic.receiver_count]

    def advertise(self, name: str, msg_type: type[Message]) -> IntraProcessTopic:
        """Adds 1 to the publisher count of a topic, and returns the topic. Same arguments as `topic`."""
        topic = self.topic(name, msg_type)
        topic.publisher_count += 1
        return topic

    def update(
        self, has_other_publishers: Callable[[IntraProcessTopic], bool], published_types: Callable[[str], Collection[str]]
    ) -> None:
        """Chooses the route of every topic and the type of every `either` again.

        Must be called regularly, because publishers come and go.

        Args:
            has_other_publishers: Returns True if another process publishes the topic. Only called for topics with a
                publisher in this process.
            published_types: Returns the ROS types with which others publish the topic of a name.
        """
        for subscription in self.either:
            subscription.update(published_types(subscription.topic))
        for topic in self._topics.values():
            if topic.subscriptions:
                topic.set_route(direct=topic.publisher_count > 0 and not has_other_publishers(topic))


class IntraProcessTopic:
    """The publishers and subscriptions of one process for one topic.

    Args:
        name: Fully resolved name.
        msg_type: Class of its messages.

    Attributes:
        name: Fully resolved name.
        msg_type: Class of its messages.
        publisher_count: Number of publishers in this process.
        receiver_count: Number of subscriptions in this process.
        subscriptions: Subscriptions in this process that can receive messages directly, which are those with `QoS.DEFAULT`.
    """

    def __init__(self, name: str, msg_type: type[Message]) -> None:
        self.name, self.msg_type = name, msg_type
        self.publisher_count = self.receiver_count = 0
        self.subscriptions: list[IntraProcessSubscription] = []
        self._direct_callbacks: tuple[Callable[[Any], None], ...] = ()

    def deliver(self, message: Message) -> None:
        """Calls the callbacks of all subscriptions that do not use ROS."""
        for callback in self._direct_callbacks:
            callback(message)

    def subscribe(
        self, qos: QoS, callback: Callable[[Any], None], subscribe_through_ros: SubscribeThroughRos
    ) -> IntraProcessSubscription:
        """Creates a subscription, which receives every message of the topic directly or through ROS.

        Args:
            qos: Quality of service. Only `QoS.DEFAULT` allows direct delivery.
            callback: Called with messages that are delivered directly.
            subscribe_through_ros: Called when the messages have to come through ROS.
        """
        subscription = IntraProcessSubscription(self, callback, subscribe_through_ros)
        can_be_direct = qos is QoS.DEFAULT
        subscription.set_route(direct=can_be_direct and self.publisher_count > 0)
        self.receiver_count += 1
        if can_be_direct:
            self.subscriptions.append(subscription)
            self._collect_callbacks()
        return subscription

    def set_route(self, *, direct: bool) -> None:
        """Delivers messages to `subscriptions` directly if `direct`, otherwise through ROS."""
        for subscription in self.subscriptions:
            subscription.set_route(direct=direct)
        self._collect_callbacks()

    def unsubscribe(self, subscription: IntraProcessSubscription) -> None:
        """Ends a subscription, whether it is direct or through ROS."""
        subscription.set_route(direct=True)
        self.receiver_count -= subscription.is_active
        subscription.is_active = False
        if subscription in self.subscriptions:
            self.subscriptions.remove(subscription)
            self._collect_callbacks()

    def _collect_callbacks(self) -> None:
        self._direct_callbacks = tuple(each.callback for each in self.subscriptions if each.is_direct)


class IntraProcessSubscription:
    """One subscription to a topic. At any time it either receives messages directly, or is subscribed through ROS.

    Args:
        topic: Topic of the subscription.
        callback: Called with messages that are delivered directly.
        subscribe_through_ros: Called when the messages have to come through ROS.

    Attributes:
        is_active: False once the subscription has ended.
    """

    def __init__(
        self, topic: IntraProcessTopic, callback: Callable[[Any], None], subscribe_through_ros: SubscribeThroughRos
    ) -> None:
        self.topic, self.callback = topic, callback
        self.is_active = True
        self._subscribe_through_ros = subscribe_through_ros
        self._unsubscribe_from_ros: Callable[[], object] | None = None

    @property
    def is_direct(self) -> bool:
        """True if the subscription does not use ROS at present."""
        return self._unsubscribe_from_ros is None

    def set_route(self, *, direct: bool) -> None:
        """Ends the subscription through ROS if `direct`, otherwise starts it. Does nothing if it is already so."""
        if direct and self._unsubscribe_from_ros is not None:
            self._unsubscribe_from_ros()
            self._unsubscribe_from_ros = None
        elif not direct and self._unsubscribe_from_ros is None:
            self._unsubscribe_from_ros = self._subscribe_through_ros()
