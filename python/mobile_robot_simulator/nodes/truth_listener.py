"""TruthListener: the true pose of a robot, as it publishes it on a topic."""

from __future__ import annotations

from dataclasses import dataclass

from .._core import Pose
from ..handle import Handles
from ..instant import NANOSECONDS
from ..messages import Odometry
from .interface import Node, QoS
from .transforms import check_frame

MAX_EXTRAPOLATION_NS = 1_000_000_000
"""The pose is extrapolated at most this long before or after the stamp of the last message [ns]."""


@dataclass(frozen=True)
class TruthSnapshot:
    """Saved state of a `TruthListener`: the last message, None if there was none."""

    latest: Odometry | None


class TruthListener:
    """Receives the ground truth of a robot. Between messages, the pose is extrapolated with the last velocity.

    Args:
        node: Node to subscribe through.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._latest: Odometry | None = None
        self._topic = ""
        self._frames = ("", "")
        self._has_warned = False

    @property
    def has_heard(self) -> bool:
        """True if a true pose has ever arrived."""
        return self._latest is not None

    def start(self, topic: str, map_frame: str, base_frame: str, handles: Handles) -> None:
        """Subscribes to a topic. What came on another topic before is forgotten.

        Args:
            topic: Name of the topic; empty for none.
            map_frame: Frame that the pose must be in.
            base_frame: Frame of the robot that the pose must be of.
            handles: Takes what has to be released to stop.
        """
        name = topic and self._node.resolve_topic_name(topic)
        if (name, (map_frame, base_frame)) != (self._topic, self._frames):
            self._latest, self._topic, self._frames, self._has_warned = None, name, (map_frame, base_frame), False
        if not topic:
            return
        handles.add(
            self._node.destroy_subscription, self._node.create_subscription(Odometry, topic, self._take, QoS.DEFAULT)
        )

    def pose(self, time_ns: int) -> Pose | None:
        """Returns the true pose in the map frame at a time, or None if the last message is too far from it.

        Args:
            time_ns: The time [ns].
        """
        if self._latest is None:
            return None
        elapsed_ns = time_ns - self._latest.header.stamp.nanoseconds
        if abs(elapsed_ns) > MAX_EXTRAPOLATION_NS:
            return None
        twist = self._latest.twist.twist
        velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        return self._latest.pose.pose.to_planar().integrate(velocity, elapsed_ns / NANOSECONDS).wrapped()

    def explain_missing(self, time_ns: int) -> str:
        """Returns why there is no pose at a time [ns], after one has arrived."""
        assert self._latest is not None
        age = (time_ns - self._latest.header.stamp.nanoseconds) / NANOSECONDS
        when = f"{age:.1f} s old" if age > 0.0 else f"{-age:.1f} s ahead of the clock"
        return f"on topic {self._topic}, where the last one is {when}"

    def save(self) -> TruthSnapshot:
        """Returns the state that `restore` takes."""
        return TruthSnapshot(self._latest)

    def restore(self, state: TruthSnapshot) -> None:
        """Puts the listener back into a saved state. The bus restores the subscription."""
        self._latest = state.latest

    def _take(self, message: Odometry) -> None:
        twist, (map_frame, base_frame) = message.twist.twist, self._frames
        try:
            check_frame(message.header, map_frame)
            if message.child_frame_id not in ("", base_frame):
                raise ValueError(f"it must be of frame {base_frame}, got {message.child_frame_id}")
            # Checks that pose and velocity are finite.
            message.pose.pose.to_planar().integrate((twist.linear.x, twist.linear.y, twist.angular.z), 0.0)
        except ValueError as error:
            if not self._has_warned:
                self._has_warned = True
                self._node.get_logger().warning(f"ground truth on {self._topic} refused: {error}")
            return
        self._latest = message
