"""Transforms between frames: a small tf buffer that never waits."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from .._core import Pose
from ..handle import Handles
from ..messages import Odometry, TFMessage, TransformStamped
from .interface import Node, QoS

Velocity = tuple[float, float, float]

LONGEST_CARRY_NS = 1_000_000_000
"""How long after its last transform, or before, a frame is taken to move as its odometry says."""


class TransformBuffer:
    """The last transform of each frame to its parent, and the twist that carries the frame on from there.

    Between map and odom there is no motion, only correction: frames above the robot's stay where their last transform says.
    """

    def __init__(self) -> None:
        self._links: dict[str, _Link] = {}
        self._twists: dict[str, Velocity] = {}

    def add(self, transform: TransformStamped, *, static: bool = False) -> None:
        """Take in a transform.

        raises: ValueError for one that is no pose.
        """
        child, parent = _bare(transform.child_frame_id), _bare(transform.header.frame_id)
        stamp, pose = transform.header.stamp.nanoseconds, transform.transform.to_planar()
        before = self._links.get(child)
        if before is not None and before.stamp == stamp:
            before = before.before
        if before is not None and (before.parent != parent or before.stamp > stamp):
            before = None
        self._links[child] = _Link(parent, stamp, pose, static, before and replace(before, before=None))

    def add_twist(self, odometry: Odometry) -> None:
        """Take in how the child frame of an odometry moves; a twist that is not finite is no motion."""
        twist = odometry.twist.twist
        velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        self._twists[_bare(odometry.child_frame_id)] = velocity if all(map(math.isfinite, velocity)) else (0.0, 0.0, 0.0)

    def lookup(self, target: str, source: str, time_ns: int) -> Pose | None:
        """The pose of the source frame in the target frame at a time, None if that is not known.

        A frame with odometry moves on from its last transform under its last twist, for up to a second. Of the frames on
        the way, the first that is not static is taken for the robot's: without odometry it moves on as it did before.
        """
        up_from_source = self._ancestors(_bare(source), time_ns)
        up_from_target = self._ancestors(_bare(target), time_ns)
        for frame, frame_from_source in up_from_source.items():
            if frame in up_from_target:
                return up_from_target[frame].inverse() * frame_from_source
        return None

    def lookup_or_root(self, target: str, source: str, time_ns: int) -> Pose | None:
        """As `lookup`, but if nothing was ever heard of the target frame, the source's root frame stands for it."""
        pose = self.lookup(target, source, time_ns)
        if pose is not None or self._knows(_bare(target)):
            return pose
        ancestors = list(self._ancestors(_bare(source), time_ns).values())
        return ancestors[-1] if len(ancestors) > 1 else None

    def save(self) -> Any:
        """All that is known now."""
        return dict(self._links), dict(self._twists)

    def restore(self, state: Any) -> None:
        """Know what was known then."""
        links, twists = state
        self._links, self._twists = dict(links), dict(twists)

    def _knows(self, frame: str) -> bool:
        return frame in self._links or any(link.parent == frame for link in self._links.values())

    def _ancestors(self, frame: str, time_ns: int) -> dict[str, Pose]:
        """The pose of a frame in itself, its parent, its parent's parent and so on."""
        pose, is_robot = Pose(), True
        found = {frame: pose}
        while (link := self._links.get(frame)) is not None:
            parent_from_frame = link.at(time_ns, self._twists.get(frame), is_robot)
            is_robot &= link.static
            if parent_from_frame is None or link.parent in found:
                break
            frame, pose = link.parent, parent_from_frame * pose
            found[frame] = pose
        return found


class TransformListener:
    """Fills a buffer with what goes over /tf, /tf_static and topics of odometry."""

    def __init__(self, node: Node, buffer: TransformBuffer) -> None:
        self._node, self._buffer = node, buffer
        self._running: Handles | None = None

    def start(self, odometry_topic: str) -> None:
        """Listen from now on."""
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
        """Listen no more."""
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
    """One frame in its parent, and where it was before."""

    parent: str
    stamp: int
    pose: Pose
    static: bool
    before: _Link | None

    def at(self, time_ns: int, twist: Velocity | None, is_robot: bool) -> Pose | None:
        elapsed = time_ns - self.stamp
        if self.static or elapsed == 0 or (twist is None and not is_robot):
            return self.pose
        if abs(elapsed) > LONGEST_CARRY_NS:
            return None
        if twist is not None:
            return self.pose.integrate(twist, elapsed / 1e9)
        if self.before is None:
            return self.pose
        gap = self.stamp - self.before.stamp
        return self.before.pose.interpolate(self.pose, (elapsed + gap) / gap)


def _bare(frame: str) -> str:
    """A frame's name without the slash that ROS 1 users put before it."""
    return frame.removeprefix("/")
