"""Commander: publishes velocity commands."""

from __future__ import annotations

from collections.abc import Callable

from ..messages import Header, Time, Twist, TwistStamped, Vector3
from ..nodes.interface import Node, QoS


class Commander:
    """Publishes velocity commands as Twist or TwistStamped messages.

    Args:
        node: Node that publishes.
        topic: Topic of the commands.
        stamped: Publish TwistStamped instead of Twist.
    """

    def __init__(self, node: Node, topic: str, *, stamped: bool) -> None:
        self._node = node
        self._publish: Callable[[Twist], None]
        if stamped:
            stamped_publisher = node.create_publisher(TwistStamped, topic, QoS.DEFAULT)
            self._publish = lambda twist: stamped_publisher.publish(TwistStamped(self._header(), twist))
        else:
            self._publish = node.create_publisher(Twist, topic, QoS.DEFAULT).publish

    def command(self, vx: float, vy: float, wz: float) -> None:
        """Publishes a velocity in the robot's frame [m/s, m/s, rad/s]."""
        self._publish(Twist(Vector3(vx, vy), Vector3(z=wz)))

    def _header(self) -> Header:
        return Header(Time.from_nanoseconds(self._node.get_clock().now().nanoseconds), "base_link")
