"""Transforms between frames: a small tf buffer whose lookups extrapolate instead of waiting."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from .._core import Pose
from ..handle import Handles
from ..instant import NANOSECONDS
from ..messages import Header, Odometry, TFMessage, Transform, TransformStamped
from ..physics.velocity_profile import STANDING, Velocity
from .interface import Node, QoS
from .rigid_transform import RigidTransform

MAX_EXTRAPOLATION_NS = 1_000_000_000
"""A pose is extrapolated at most this long before or after the stamp of the last transform [ns]."""

SHOWN_FRAMES = 10
"""Number of frames that a message names at most."""


@dataclass(frozen=True)
class TransformSnapshot:
    """Saved state of a `TransformBuffer`: the last transforms and the last twist of each frame."""

    links: dict[str, _Link]
    twists: dict[str, Velocity]


class TransformBuffer:
    """Stores where each frame is in its parent frame, and extrapolates the frames that move.

    For each frame the buffer keeps the last two transforms to its parent, and the last odometry twist if there is one. The
    robot's frame moves between two transforms, so it is extrapolated. The frames above the robot's frame (such as `odom` in
    `map`) only receive corrections, so their last transform is valid until the next one.
    """

    def __init__(self) -> None:
        self._links: dict[str, _Link] = {}
        self._twists: dict[str, Velocity] = {}

    def add(self, transform: TransformStamped, *, static: bool = False) -> None:
        """Stores a transform.

        Args:
            transform: Pose of the child frame in the header's frame. If its stamp equals the last one, it replaces the last
                transform. If its stamp is earlier or its parent is another frame, all older transforms of the child are
                dropped.
            static: True if the transform is valid at all times.

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
        self._links[child] = _Link(parent, stamp, pose, transform.transform, static, before and replace(before, before=None))

    def add_twist(self, odometry: Odometry) -> None:
        """Stores the twist of an odometry message's child frame. A twist that is not finite counts as zero."""
        twist = odometry.twist.twist
        velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        self._twists[_without_slash(odometry.child_frame_id)] = velocity if all(map(math.isfinite, velocity)) else STANDING

    def lookup(self, target: str, source: str, time_ns: int) -> Pose | None:
        """Returns the pose of the source frame in the target frame, or None if the frames are not connected at that time.

        A frame with odometry is extrapolated from its last transform with its last twist. Without odometry, the first frame
        on the way up from the source (or from the target) whose transform is not static counts as the robot's frame, and is
        extrapolated with its last two transforms. Both are limited to `MAX_EXTRAPOLATION_NS`.

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

    def lookup_in_space(self, target: str, source: str) -> RigidTransform | None:
        """Returns the last known pose of the source frame in the target frame, in space. None if they are not connected.

        Args:
            target: Frame of the result.
            source: Frame whose pose is wanted.
        """
        up_from_source = self._ancestors_in_space(_without_slash(source))
        up_from_target = self._ancestors_in_space(_without_slash(target))
        for frame, frame_from_source in up_from_source.items():
            if frame in up_from_target:
                return up_from_target[frame].inverse() * frame_from_source
        return None

    def lookup_or_root(self, target: str, source: str, time_ns: int) -> Pose | None:
        """Like `lookup`, but the root of the tree that contains the source frame replaces an unknown target frame.

        Args:
            target: Frame of the result.
            source: Frame whose pose is wanted.
            time_ns: Time of the pose [ns].

        Returns:
            The pose, or None if the target is known but not connected, or if the source has no parent.
        """
        pose = self.lookup(target, source, time_ns)
        if pose is not None or self._knows(_without_slash(target)):
            return pose
        ancestors = list(self._ancestors(_without_slash(source), time_ns).values())
        return ancestors[-1] if len(ancestors) > 1 else None

    def explain_missing(self, target: str, source: str, time_ns: int) -> str:
        """Returns why `lookup_or_root` finds no pose: which transform is missing or too old.

        Args:
            target: Frame of the result.
            source: Frame whose pose is wanted.
            time_ns: Time of the pose [ns].
        """
        target, source = _without_slash(target), _without_slash(source)
        for known in (self._ancestors(source, time_ns), self._ancestors(target, time_ns)):
            root = list(known)[-1]
            link = self._links.get(root)
            if link is not None and link.parent in known:
                return f"but the transforms from {root} to {link.parent} and back form a loop"
            if link is not None:
                age = (time_ns - link.stamp) / NANOSECONDS
                when = f"{age:.1f} s old" if age > 0.0 else f"{-age:.1f} s ahead of the clock"
                return f"but the last one from {root} to {link.parent} is {when}"
        frames = sorted({*self._links, *(link.parent for link in self._links.values())})
        shown = ", ".join(frames[:SHOWN_FRAMES]) + (", ..." if len(frames) > SHOWN_FRAMES else "")
        return f"on topic /tf, which has the frames {shown}" if frames else "on topic /tf, where none has arrived"

    def save(self) -> TransformSnapshot:
        """Returns the state that `restore` takes."""
        return TransformSnapshot(dict(self._links), dict(self._twists))

    def restore(self, state: TransformSnapshot) -> None:
        """Puts the buffer back into a saved state."""
        self._links, self._twists = dict(state.links), dict(state.twists)

    def _knows(self, frame: str) -> bool:
        return frame in self._links or any(link.parent == frame for link in self._links.values())

    def _ancestors_in_space(self, frame: str) -> dict[str, RigidTransform]:
        """Like `_ancestors`, in space and with the last transforms."""
        pose = RigidTransform()
        found = {frame: pose}
        while (link := self._links.get(frame)) is not None and link.parent not in found:
            pose = RigidTransform.from_message(link.transform.translation, link.transform.rotation) * pose
            frame = link.parent
            found[frame] = pose
        return found

    def _ancestors(self, frame: str, time_ns: int) -> dict[str, Pose]:
        """Returns a frame's pose in itself, in its parent, in its parent's parent and so on, by the ancestor's name."""
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

    @property
    def buffer(self) -> TransformBuffer:
        """The buffer that the listener fills."""
        return self._buffer

    def start(self, odometry_topic: str) -> None:
        """Subscribes to the topics. Has no effect if the listener is running.

        Args:
            odometry_topic: Name of the odometry topic.
        """
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

    def save(self) -> Handles | None:
        """Returns the state that `restore` takes: the subscriptions, None while the listener is stopped."""
        return self._running

    def restore(self, state: Handles | None) -> None:
        """Puts the listener back into a saved state. The bus restores what the handles refer to."""
        self._running = state

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
    """Pose of a frame in its parent at a stamp [ns], in the plane and in space, and the previous such pose."""

    parent: str
    stamp: int
    pose: Pose
    transform: Transform
    static: bool
    before: _Link | None

    def at(self, time_ns: int, twist: Velocity | None, may_move: bool) -> Pose | None:
        """Returns the pose in the parent at a time, or None if the time is too far from the stamp.

        A frame moves with its twist if it has one. Without one, it moves through its last two poses if `may_move` is true,
        and stands still otherwise.
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


def check_frame(header: Header, needed: str) -> None:
    """Checks that a message is in a frame. An empty frame counts as the needed one.

    Raises:
        ValueError: It is in another frame.
    """
    frame = _without_slash(header.frame_id)
    if frame not in ("", _without_slash(needed)):
        raise ValueError(f"it must be in frame {needed}, got {frame}")


def _without_slash(frame: str) -> str:
    """Returns a frame's name without the leading slash that ROS 1 allowed."""
    return frame.removeprefix("/")
