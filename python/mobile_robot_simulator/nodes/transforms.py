"""Transforms between frames: a small tf buffer whose lookups never wait."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from .._core import Pose
from ..handle import Handles
from ..instant import NANOSECONDS
from ..messages import Odometry, TFMessage, TransformStamped
from ..physics.motion import STANDING, Velocity
from .interface import Node, QoS

MAX_EXTRAPOLATION_NS = 1_000_000_000
"""Longest time before or after a frame's last transform for which its pose is extrapolated [ns]."""


@dataclass(frozen=True)
class TransformSnapshot:
    """Saved state of a `TransformBuffer`: the last transform and the last twist of each frame."""

    links: dict[str, _Link]
    twists: dict[str, Velocity]


class TransformBuffer:
    """Stores the last transform of each frame to its parent, and the twist that extrapolates it.

    A robot's frame moves between transforms. Frames above it (`odom` in `map`) do not move: their transforms are only
    corrected from time to time, so the last one holds.
    """

    def __init__(self) -> None:
        self._links: dict[str, _Link] = {}
        self._twists: dict[str, Velocity] = {}

    def add(self, transform: TransformStamped, *, static: bool = False) -> None:
        """Stores a transform.

        Args:
            transform: Pose of the child frame in the header's frame. A transform with the same stamp replaces the last one.
                One with an earlier stamp or another parent starts a new history.
            static: True if the transform holds at all times.

        Raises:
            ValueError: The translation or the rotation is not finite, or the rotation's quaternion is zero.
        """
        child, parent = _without_slash(transform.child_frame_id), _without_slash(transform.header.frame_id)
        stamp, pose = transform.header.stamp.nanoseconds, transform.transform.to_planar()
        before = self._links.get(child)
        if before is not None and before.stamp == stamp:
            before = before.before
        if before is not None and (before.parent != parent or before.stamp > stamp):
            before = None
        self._links[child] = _Link(parent, stamp, pose, static, before and replace(before, before=None))

    def add_twist(self, odometry: Odometry) -> None:
        """Stores the twist of an odometry message's child frame. A twist that is not finite counts as standing still."""
        twist = odometry.twist.twist
        velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        self._twists[_without_slash(odometry.child_frame_id)] = velocity if all(map(math.isfinite, velocity)) else STANDING

    def lookup(self, target: str, source: str, time_ns: int) -> Pose | None:
        """Returns the pose of the source frame in the target frame, or None if the frames are not connected at that time.

        A frame with odometry is extrapolated from its last transform by its last twist, for at most
        `MAX_EXTRAPOLATION_NS`. A robot without odometry is extrapolated by its last two transforms; the first frame above
        the source (or the target) that is not static counts as the robot's.

        Args:
            target: Frame of the result.
            source: Frame whose pose is wanted.
            time_ns: Time of the pose [ns].
        """
        up_from_source = self._ancestors(_without_slash(source), time_ns)
        up_from_target = self._ancestors(_without_slash(target), time_ns)
        for frame, frame_from_source in up_from_source.items():
            if frame in up_from_target:
                return up_from_target[frame].inverse() * frame_from_source
        return None

    def lookup_or_root(self, target: str, source: str, time_ns: int) -> Pose | None:
        """Like `lookup`, but an unknown target frame is replaced by the root of the source frame's tree.

        Returns None if the target is known but not connected, or if the source has no parent.
        """
        pose = self.lookup(target, source, time_ns)
        if pose is not None or self._knows(_without_slash(target)):
            return pose
        ancestors = list(self._ancestors(_without_slash(source), time_ns).values())
        return ancestors[-1] if len(ancestors) > 1 else None

    def save(self) -> TransformSnapshot:
        """Returns the state that `restore` takes."""
        return TransformSnapshot(dict(self._links), dict(self._twists))

    def restore(self, state: TransformSnapshot) -> None:
        """Puts the buffer back into a saved state."""
        self._links, self._twists = dict(state.links), dict(state.twists)

    def _knows(self, frame: str) -> bool:
        return frame in self._links or any(link.parent == frame for link in self._links.values())

    def _ancestors(self, frame: str, time_ns: int) -> dict[str, Pose]:
        """Returns the pose of a frame in itself, in its parent, in its parent's parent, and so on."""
        pose, may_move = Pose(), True
        found = {frame: pose}
        while (link := self._links.get(frame)) is not None:
            parent_from_frame = link.at(time_ns, self._twists.get(frame), may_move)
            may_move &= link.static
            if parent_from_frame is None or link.parent in found:
                break
            frame, pose = link.parent, parent_from_frame * pose
            found[frame] = pose
        return found


class TransformListener:
    """Fills a buffer from the topics /tf and /tf_static and from an odometry topic.

    Args:
        node: Node to subscribe through.
        buffer: Buffer to fill.
    """

    def __init__(self, node: Node, buffer: TransformBuffer) -> None:
        self._node, self._buffer = node, buffer
        self._running: Handles | None = None

    def start(self, odometry_topic: str) -> None:
        """Subscribes to the topics. Has no effect if the listener is running."""
        if self._running is None:
            node = self._node
            with Handles() as handles:
                moving = node.create_subscription(TFMessage, "/tf", self._take, QoS.DEFAULT)
                handles.add(node.destroy_subscription, moving)
                twists = node.create_subscription(Odometry, odometry_topic, self._buffer.add_twist, QoS.DEFAULT)
                handles.add(node.destroy_subscription, twists)
                static = node.create_subscription(TFMessage, "/tf_static", self._take_static, QoS.LATCHED)
                handles.add(node.destroy_subscription, static)
            self._running = handles

    def stop(self) -> None:
        """Destroys the subscriptions."""
        if self._running is not None:
            self._running.close()
            self._running = None

    def _take(self, message: TFMessage) -> None:
        self._add(message, static=False)

    def _take_static(self, message: TFMessage) -> None:
        self._add(message, static=True)

    def _add(self, message: TFMessage, *, static: bool) -> None:
        for transform in message.transforms:
            try:
                self._buffer.add(transform, static=static)
            except ValueError as error:
                self._node.get_logger().warning(f"transform of {transform.child_frame_id} refused: {error}")


@dataclass(frozen=True)
class _Link:
    """Pose of a frame in its parent at a stamp [ns], and the transform before it."""

    parent: str
    stamp: int
    pose: Pose
    static: bool
    before: _Link | None

    def at(self, time_ns: int, twist: Velocity | None, may_move: bool) -> Pose | None:
        """Returns the pose in the parent at a time, or None if that is too far from the stamp to extrapolate.

        A frame moves if it has a twist, or if it may move and has two transforms.
        """
        elapsed = time_ns - self.stamp
        if self.static or elapsed == 0 or (twist is None and not may_move):
            return self.pose
        if abs(elapsed) > MAX_EXTRAPOLATION_NS:
            return None
        if twist is not None:
            return self.pose.integrate(twist, elapsed / NANOSECONDS)
        if self.before is None:
            return self.pose
        gap = self.stamp - self.before.stamp
        return self.before.pose.interpolate(self.pose, (elapsed + gap) / gap)


def _without_slash(frame: str) -> str:
    """Returns a frame's name without the leading slash that ROS 1 allowed."""
    return frame.removeprefix("/")
