"""EitherSubscription: receives a topic in whichever of several message types others publish it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

from ..messages import Message
from ..nodes.interface import Logger


class EitherSubscription:
    """A subscription that has one message type at a time, and changes it if others publish only another one.

    ROS does not deliver a message to a subscription of another type, and Fast DDS does not allow subscriptions of two types
    to one topic in one process.

    Args:
        topic: Name of the topic, for the log.
        callbacks: Function to call with the messages of each type. The first type is the one at the start.
        subscribe: Subscribes with a type and a callback; returns the subscription.
        unsubscribe: Ends a subscription.
        logger: Takes a line for each change.
    """

    def __init__(
        self,
        topic: str,
        callbacks: Mapping[type[Message], Callable[[Any], None]],
        subscribe: Callable[[type[Message], Callable[[Any], None]], Any],
        unsubscribe: Callable[[Any], None],
        logger: Logger,
    ) -> None:
        self.topic = topic
        self._callbacks, self._subscribe, self._unsubscribe, self._logger = callbacks, subscribe, unsubscribe, logger
        self._type = next(iter(callbacks))
        self._subscription: Any = subscribe(self._type, callbacks[self._type])
        """The subscription; None while the middleware refuses it, because it has not let go of the previous one yet."""
        self._has_warned = False

    def update(self, published: Collection[str]) -> None:
        """Changes the type if others publish only another one. Warns once if they publish several.

        Args:
            published: ROS types with which others publish the topic, such as geometry_msgs/msg/Twist.
        """
        found = [kind for kind in self._callbacks if kind.ros_type in published]
        if len(found) > 1 and not self._has_warned:
            ignored = " and ".join(kind.ros_type for kind in found if kind is not self._type)
            used = f"{self._type.ros_type} is used, {ignored} is ignored"
            self._logger.warning(f"topic {self.topic} is published with several types: {used}")
        self._has_warned = len(found) > 1
        if len(found) == 1 and found[0] is not self._type:
            used = f"{found[0].ros_type}, not {self._type.ros_type}"
            self._logger.info(f"topic {self.topic} is published as {used}: using that")
            self.destroy()
            self._type = found[0]
        if self._subscription is None:
            try:
                self._subscription = self._subscribe(self._type, self._callbacks[self._type])
            except TypeError:
                # rclpy destroys a subscription only once its executor has let go of it. The next update tries again.
                return

    def destroy(self) -> None:
        """Ends the subscription."""
        if self._subscription is not None:
            self._unsubscribe(self._subscription)
            self._subscription = None
