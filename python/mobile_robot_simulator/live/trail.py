"""Trail: the path of a robot, as a page draws it."""

from __future__ import annotations

from dataclasses import dataclass, field

from .._core import Pose

LONGEST_TRAIL = 20_000
"""Points of a path that a page can show. If there are more, the older half is thinned to every second point."""

_TRAIL_STEP = 0.02
"""Shortest distance between two points of a path [m]."""


@dataclass
class Trail:
    """The path of a robot: where it was and where its odometry believed it to be.

    Attributes:
        points: Rows x, y, believed x, believed y in the map frame [m]; None where the robot was moved.
        epoch: Number that changes when earlier points change.
    """

    points: list[tuple[float, float, float, float] | None] = field(default_factory=list)
    epoch: int = 0

    def clear(self) -> None:
        """Forgets the path so far."""
        self.points.clear()
        self.epoch += 1

    def add(self, pose: Pose, believed: Pose, *, is_moved: bool = False) -> None:
        """Adds a point, unless the robot has hardly moved. With `is_moved`, it is not joined to the last one."""
        point = (round(pose.x, 3), round(pose.y, 3), round(believed.x, 3), round(believed.y, 3))
        last = next((each for each in reversed(self.points[-2:]) if each is not None), None)
        if last is not None:
            moved = max(abs(a - b) for a, b in zip(point, last, strict=True))
            if moved < _TRAIL_STEP and not is_moved:
                return
            if is_moved and self.points[-1] is not None:
                self.points.append(None)
        self.points.append(point)
        if len(self.points) > LONGEST_TRAIL:
            half = LONGEST_TRAIL // 2
            self.points = self.points[:half:2] + self.points[half:]
            self.epoch += 1
