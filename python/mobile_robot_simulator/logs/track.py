"""Track: where a frame was over time."""

from __future__ import annotations

from bisect import bisect_left

from ..nodes.rigid_transform import RigidTransform

LONGEST_GAP_NS = 1_000_000_000
"""Longest time between two poses of a moving robot between which its pose is interpolated [ns]."""


class Track:
    """Poses of a frame in its parent over time, added in any order. A second pose of a stamp replaces the first."""

    def __init__(self) -> None:
        self._poses: dict[int, RigidTransform] = {}
        self._stamps: list[int] = []

    def __len__(self) -> int:
        return len(self._poses)

    @property
    def stamps(self) -> list[int]:
        """Times of the poses in ascending order [ns]."""
        if len(self._stamps) != len(self._poses):
            self._stamps = sorted(self._poses)
        return self._stamps

    def add(self, stamp: int, pose: RigidTransform) -> None:
        """Adds the pose at a time [ns]."""
        self._poses[stamp] = pose
        self._stamps = []

    def at(self, stamp: int, *, moving: bool) -> RigidTransform | None:
        """Returns the pose at a time, interpolated between the poses before and after it.

        Args:
            stamp: The time [ns].
            moving: The frame moves. Then it has a pose only between two poses at most `LONGEST_GAP_NS` apart. Otherwise the
                poses are corrections that come now and then: they are interpolated over any gap, and the last one stays.

        Returns:
            The pose, or None if there is none at that time.
        """
        if stamp in self._poses:
            return self._poses[stamp]
        stamps = self.stamps
        after = bisect_left(stamps, stamp)
        if after == 0:
            return None
        if after == len(stamps):
            return None if moving else self._poses[stamps[-1]]
        start, end = stamps[after - 1], stamps[after]
        if moving and end - start > LONGEST_GAP_NS:
            return None
        return self._poses[start].interpolate(self._poses[end], (stamp - start) / (end - start))
