"""Transforms between frames over time: a small tf buffer that never waits."""

from __future__ import annotations

from bisect import bisect_right

from ._core import Pose
from .messages import TransformStamped

KEPT = 64
"""Transforms kept of each frame."""

EXTRAPOLATION_NS = 1_000_000_000
"""How far past its last transform a frame is taken to go on as it did."""


class TransformBuffer:
    """The latest transforms of each frame to its parent."""

    def __init__(self) -> None:
        self._frames: dict[str, _Frame] = {}

    def add(self, transform: TransformStamped, *, static: bool = False) -> None:
        """Take in a transform. A child that gets another parent, or a time before its last, starts anew."""
        child, parent = _bare(transform.child_frame_id), _bare(transform.header.frame_id)
        frame = self._frames.get(child)
        stamp = transform.header.stamp.nanoseconds
        if frame is None or frame.parent != parent or frame.static != static or (static or stamp < frame.stamps[-1]):
            frame = self._frames[child] = _Frame(parent, static)
        frame.add(stamp, transform.transform.to_planar())

    def lookup(self, target: str, source: str, time_ns: int) -> Pose | None:
        """The pose of the source frame in the target frame at a time, None if that is not known.

        Between two transforms a frame moves along the arc through them, and on along it for up to a second past the last.
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

    def _knows(self, frame: str) -> bool:
        return frame in self._frames or any(link.parent == frame for link in self._frames.values())

    def _ancestors(self, frame: str, time_ns: int) -> dict[str, Pose]:
        """The pose of a frame in itself, its parent, its parent's parent and so on."""
        pose = Pose()
        found = {frame: pose}
        while (link := self._frames.get(frame)) is not None:
            parent_from_frame = link.at(time_ns)
            if parent_from_frame is None or link.parent in found:
                break
            frame, pose = link.parent, parent_from_frame * pose
            found[frame] = pose
        return found


class _Frame:
    """One frame in its parent, over time."""

    def __init__(self, parent: str, static: bool) -> None:
        self.parent, self.static = parent, static
        self.stamps: list[int] = []
        self.poses: list[Pose] = []

    def add(self, stamp: int, pose: Pose) -> None:
        if self.stamps and stamp == self.stamps[-1]:
            self.poses[-1] = pose
            return
        self.stamps.append(stamp)
        self.poses.append(pose)
        del self.stamps[:-KEPT], self.poses[:-KEPT]

    def at(self, time_ns: int) -> Pose | None:
        if self.static:
            return self.poses[-1]
        after = bisect_right(self.stamps, time_ns)
        if after and self.stamps[after - 1] == time_ns:
            return self.poses[after - 1]
        if after == 0 or time_ns - self.stamps[-1] > EXTRAPOLATION_NS:
            return None
        first = min(after, len(self.stamps) - 1) - 1
        if first < 0:
            return self.poses[0]
        fraction = (time_ns - self.stamps[first]) / (self.stamps[first + 1] - self.stamps[first])
        return self.poses[first].interpolate(self.poses[first + 1], fraction)


def _bare(frame: str) -> str:
    """A frame's name without the slash that ROS 1 users put before it."""
    return frame.removeprefix("/")
