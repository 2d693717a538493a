"""GroundTruth: what really happened to a robot, whatever it believes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .._core import Pose, Shape, clearance, integrate_twist
from ..handle import Handle
from ..instant import NANOSECONDS

if TYPE_CHECKING:
    from ..nodes.robot import MobileRobotSimulator
    from ..physics.motion import ContactEvent, Velocity
    from ..physics.world import World

PATH_STEP = 0.1
"""Seconds from one point of a path to the next, at most."""

FARTHEST = 10.0
"""Clearances beyond this [m] are not told apart."""

POINT = Shape.disc(1e-6)


class GroundTruth(Handle):
    """Where a robot really is and was, in the map frame."""

    def __init__(self, world: World, robot: MobileRobotSimulator) -> None:
        self._world, self._robot = world, robot

    @property
    def time(self) -> float:
        """Seconds since the simulation began."""
        return self._world.now_ns() / NANOSECONDS

    @property
    def pose(self) -> Pose:
        """Where the robot is now."""
        return self._robot.pose

    @property
    def velocity(self) -> Velocity:
        """How it moves now: forward, leftward [m/s] and turning [rad/s]."""
        return self._robot.velocity

    @property
    def distance(self) -> float:
        """Length of its way so far [m]."""
        return self._robot.distance

    @property
    def contacts(self) -> list[ContactEvent]:
        """Contacts that began so far. raises: ValueError if the robot has no footprint."""
        if self._robot.footprint is None:
            raise ValueError("contacts need a footprint: give the parameter robot_radius or footprint")
        return list(self._robot.motion.contacts_until(self._world.now_ns()))

    @property
    def clearance(self) -> float:
        """Distance [m] from the footprint to the nearest wall, obstacle or robot now, at most FARTHEST.

        Without a footprint, from the robot's origin.
        """
        return self._clearance(self.pose, self._world.now_ns(), FARTHEST)

    def clearances(self, path: NDArray[np.float64], limit: float = FARTHEST) -> NDArray[np.float64]:
        """Distances as of `clearance` at the points of a path, with all others where they were at those times.

        path: (N, 4) float64 as of `path`. limit: what is farther counts as this [m]. returns: (N,) float64 [m].
        """
        return np.array([self._clearance(Pose(*row[1:]), round(row[0] * NANOSECONDS), limit) for row in path])

    def pose_at(self, time: float) -> Pose:
        """Where the robot was at a time [s]. raises: ValueError for a time before the first or to come."""
        return self._robot.motion.map_pose_at(self._time_ns(time))

    def _time_ns(self, time: float) -> int:
        first, now = self._robot.motion.segments[0].start_ns, self._world.now_ns()
        time_ns = round(time * NANOSECONDS) if math.isfinite(time) else -1
        if not first <= time_ns <= now:
            raise ValueError(f"the time must be in {first / NANOSECONDS:g}..{now / NANOSECONDS:g} s, got {time}")
        return time_ns

    def _clearance(self, pose: Pose, time_ns: int, limit: float) -> float:
        others = self._world.around_at(self._robot, time_ns)
        grid, footprint = self._world.grid, self._robot.footprint or POINT
        return limit if grid is None else clearance(grid, footprint, pose, limit=limit, obstacles=others)

    @property
    def path(self) -> NDArray[np.float64]:
        """Its way so far, (N, 4) float64: time [s], x, y [m], yaw [rad].

        A point at each change of velocity, and at least one each tenth of a second in between; exact at each. Where the
        robot was put elsewhere there are two points at one time.
        """
        now = self._world.now_ns()
        pieces = self._robot.motion.trajectory(now)
        rows: list[tuple[float, ...]] = []
        for piece, end_ns in zip(pieces, [*(after.start_ns for after in pieces[1:]), now], strict=True):
            start, length = piece.start_ns / NANOSECONDS, (end_ns - piece.start_ns) / NANOSECONDS
            count = max(1, int(np.ceil(length / PATH_STEP)))
            for step in range(count + (end_ns == now)):
                after = length * step / count
                rows.append(
                    (
                        start + after,
                        *piece.pose,
                        *piece.velocity,
                        min(after, (piece.until_ns - piece.start_ns) / NANOSECONDS),
                    )
                )
        table = np.array(rows)
        poses = integrate_twist(table[:, 1:4], table[:, 4:7] * table[:, 7:], 1.0)
        path: NDArray[np.float64] = np.column_stack([table[:, 0], poses])
        return path
