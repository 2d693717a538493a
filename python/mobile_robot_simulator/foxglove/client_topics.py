"""ClientTopics: topics on which clients publish."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .. import messages
from ..messages import Message
from ..nodes.interface import QoS
from ..quoting import nearest, quoted
from .encoding import ENCODINGS, decoded

if TYPE_CHECKING:
    from ..bus.bus import Bus
    from ..bus.node import BusNode
    from ..bus.topic import BusPublisher

_CLASSES: Mapping[str, type[Message]] = {
    kind.ros_type: kind
    for name, kind in vars(messages).items()
    if name in messages.__all__ and isinstance(kind, type) and issubclass(kind, Message) and kind is not Message
}
"""Classes of the messages that a topic can carry which is not there yet."""


@dataclass(frozen=True)
class Announced:
    """What a client has announced to publish.

    Attributes:
        topic: Name of the topic.
        ros_type: Type of its messages, as the client writes it: `geometry_msgs/msg/Twist` or `geometry_msgs/Twist`.
        encoding: Encoding of its messages.
    """

    topic: str
    ros_type: str
    encoding: str


class ClientTopics:
    """Publishes what clients send. For the thread of the simulation.

    Args:
        bus: The bus of the simulation.
        node: Node that publishes.
    """

    def __init__(self, bus: Bus, node: BusNode) -> None:
        self._bus, self._node = bus, node
        self._publishers: dict[tuple[int, int], tuple[BusPublisher[Any], str]] = {}

    def announce(self, client: int, channel: int, announced: Announced) -> None:
        """Makes a client ready to publish on a topic.

        Args:
            client: Number of the client.
            channel: Number that the client has given to the topic.
            announced: What it will publish.

        Raises:
            ValueError: The name, the type or the encoding is unknown.
            TypeError: The topic carries messages of another type.
        """
        if announced.encoding not in ENCODINGS:
            raise ValueError(f"messages must be encoded in {' or '.join(ENCODINGS)}, got {quoted(announced.encoding)}")
        package, _, name = announced.ros_type.partition("/")
        ros_type = f"{package}/msg/{name.removeprefix('msg/')}"
        found = self._bus.find_topic(announced.topic)
        kind = found.msg_type if found is not None and found.msg_type.ros_type == ros_type else _CLASSES.get(ros_type)
        if kind is None:
            near = nearest(ros_type, _CLASSES)
            raise ValueError(
                f"{announced.topic}: unknown type {quoted(announced.ros_type)}"
                + (f"; did you mean {near[0]}?" if near else "")
            )
        qos = QoS.LATCHED if found is not None and found.latched else QoS.DEFAULT
        self.withdraw(client, channel)
        publisher = self._node.create_publisher(kind, announced.topic, qos)
        self._publishers[client, channel] = publisher, announced.encoding

    def withdraw(self, client: int, channel: int) -> None:
        """Ends what `announce` has begun. Has no effect if it has not."""
        if (found := self._publishers.pop((client, channel), None)) is not None:
            self._node.destroy_publisher(found[0])

    def publish(self, client: int, channel: int, data: bytes) -> None:
        """Publishes a message of a client.

        Raises:
            ValueError: The bytes are not a message of the type, or the client has not announced the topic.
            TypeError: A field holds a value of a wrong type.
        """
        if (client, channel) not in self._publishers:
            raise ValueError(f"a client must announce a topic before it publishes, got a message on its channel {channel}")
        publisher, encoding = self._publishers[client, channel]
        if self._bus.find_topic(publisher.topic_name) is not publisher.topic:  # a restore has removed it
            publisher = self._node.create_publisher(publisher.topic.msg_type, publisher.topic_name)
            self._publishers[client, channel] = publisher, encoding
        try:
            publisher.publish(decoded(data, publisher.topic.msg_type, encoding))
        except (ValueError, TypeError) as error:
            raise ValueError(f"{publisher.topic_name}: {error}") from None
