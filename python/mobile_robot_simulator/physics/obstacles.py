"""Obstacles: things that stand or move in a simulation, that scanners see and robots bump into."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TypeAlias

from .._core import Pose, Shape
from ..handle import Handle

PoseLike: TypeAlias = Pose | tuple[float, float, float]
Waypoints: TypeAlias = Sequence[tuple[float, float, float, float]]
Way: TypeAlias = PoseLike | Waypoints | Callable[[float], PoseLike]
"""Where an obstacle is: for good, on a path of (time [s], x, y [m], yaw [rad]), or as a function of the time [s]."""


class Obstacle(Handle):
    """A shape on its way through the map.

    way: a pose to stand at; waypoints (time, x, y, yaw) with times that increase, to move between evenly, before the first
    and after the last of which it stands; or a function of the time that gives the pose. The function is called as often as
    need be, also for times past: what it gives must hang on the time, and on what the simulation saves, alone.

    raises: ValueError for waypoints that are none, or whose times do not increase.
    """

    def __init__(self, name: str, shape: Shape, way: Way) -> None:
        self.name, self.shape = name, shape
        self._at = _function_of(way)

    def pose(self, time_ns: int) -> Pose:
        """Where it is at a time. raises: what its function raises, and TypeError or ValueError for what is no pose."""
        pose = self._at(time_ns / 1e9)
        if isinstance(pose, Pose):
            return pose
        try:
            return Pose(*pose)
        except TypeError as error:
            raise TypeError(f"the way of obstacle {self.name} must give poses (x, y, yaw), got {pose!r}") from error


def _function_of(way: Way) -> Callable[[float], PoseLike]:
    if callable(way):
        return way
    if not len(way):
        raise ValueError("waypoints must be one or more, got none")
    if isinstance(way, Pose) or isinstance(way[0], (int, float)):
        pose = Pose(*way)
        return lambda time: pose
    rows = [tuple(map(float, row)) for row in way]  # type: ignore[arg-type]
    if any(len(row) != 4 or not math.isfinite(row[0]) for row in rows):
        raise ValueError(f"a waypoint must be time, x, y, yaw, all finite, got {rows}")
    times, poses = [row[0] for row in rows], [Pose(*row[1:]) for row in rows]
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise ValueError(f"the times of waypoints must increase, got {times}")

    def at(time: float) -> PoseLike:
        after = bisect_right(times, time)
        if after in (0, len(times)):
            return poses[max(0, after - 1)]
        share = (time - times[after - 1]) / (times[after] - times[after - 1])
        (x0, y0, yaw0), (x1, y1, yaw1) = poses[after - 1], poses[after]
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0), yaw0 + share * (yaw1 - yaw0)

    return at
