"""GroundTruth: the true pose, velocity, path, contacts and clearance of a robot."""

from __future__ import annotations

import math
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._core import Pose, Shape, advance, clearance, clearance_batch
from ..handle import Handle
from ..instant import NANOSECONDS
from ..quoting import quoted

if TYPE_CHECKING:
    from ..nodes.robot import MobileRobotSimulator
    from ..physics.motion import ContactEvent
    from ..physics.velocity_profile import Velocity
    from ..physics.world import World

PATH_STEP = 0.1
"""Longest time between two points of a path [s], unless the path would have more than `MAX_STEPS` of them."""

MAX_STEPS = 50_000
"""Number of steps in time of a path, beside its changes of velocity."""

FARTHEST = 10.0
"""Upper limit of clearances [m]; a larger distance is reported as this value."""

POINT = Shape.disc(1e-6)
"""Footprint used for the clearance of a robot that has none."""


class GroundTruth(Handle):
    """The true state of a robot, now and in the past, in the map frame.

    It shows where the robot really is. The robot's messages show what the robot believes; odometry errors, noise and message
    faults affect only those.

    Args:
        world: World that the robot moves in.
        robot: The robot.
    """

    def __init__(self, world: World, robot: MobileRobotSimulator) -> None:
        self._world, self._robot = world, robot

    def __repr__(self) -> str:
        x, y, yaw = self.pose
        name = f"robot {self._robot.body_name!r}" if self._robot.body_name else "the robot"
        return f"GroundTruth({name} at ({x:.2f}, {y:.2f}, {yaw:.2f}), {self.distance:.2f} m driven in {self.time:g} s)"

    @property
    def time(self) -> float:
        """Simulated time since the start of the simulation [s]."""
        return self._world.now_ns() / NANOSECONDS

    @property
    def start(self) -> float:
        """Simulated time from which on the path is known [s]: when the robot was added."""
        return self._robot.motion.segments[0].start_ns / NANOSECONDS

    @property
    def pose(self) -> Pose:
        """Current pose in the map frame."""
        return self._robot.pose

    @property
    def velocity(self) -> Velocity:
        """Current velocity (vx, vy, wz) in the robot's frame: forward and left [m/s], counter-clockwise [rad/s]."""
        return self._robot.velocity

    @property
    def distance(self) -> float:
        """Length of the path driven so far [m], without what pushes add."""
        return self._robot.distance

    @property
    def contacts(self) -> list[ContactEvent]:
        """All contacts that have begun so far, in order of time; the last `physics.motion.MAX_CONTACTS` if there were more.

        Raises:
            ValueError: The robot has no footprint.
        """
        if self._robot.footprint is None:
            raise ValueError("contacts need a footprint: give the parameter robot_radius or footprint")
        return list(self._robot.motion.contacts_until(self._world.now_ns()))

    @property
    def contact_times(self) -> list[float]:
        """Times at which the contacts began [s], as in `contacts`; none without a footprint."""
        return [contact.time for contact in self.contacts] if self._robot.footprint is not None else []

    @property
    def clearance(self) -> float:
        """Current distance from the footprint to the nearest wall, obstacle or robot [m], at most `FARTHEST`.

        Without a footprint, the distance is measured from the robot's origin.
        """
        grid, now = self._world.grid, self._world.now_ns()
        if grid is None:
            return FARTHEST
        others = self._world.around_at(self._robot, now)
        return clearance(grid, self._footprint, self.pose, limit=FARTHEST, obstacles=others)

    def clearances(self, path: NDArray[np.float64], limit: float = FARTHEST) -> NDArray[np.float64]:
        """Returns the clearance at each point of a path, with obstacles and other robots where they were at that time.

        The map is the present one, also for points in the past.

        Args:
            path: (N, 4) float64, rows of time [s], x [m], y [m], yaw [rad], as returned by `path`.
            limit: Upper limit of the clearances [m].

        Returns:
            (N,) float64, distance to the nearest wall, obstacle or robot [m], at most `limit`.
        """
        grid = self._world.grid
        if grid is None:
            return np.full(len(path), limit)
        if self._world.stands_around(self._robot):
            others = self._world.around_at(self._robot, self._world.now_ns())
            return clearance_batch(grid, self._footprint, path[:, 1:], limit=limit, obstacles=others)
        around = [self._world.around_at(self._robot, round(time * NANOSECONDS)) for time in path[:, 0]]
        # One call for all points in a row with the same surroundings.
        parts, start = [], 0
        for others, group in groupby(around):
            end = start + len(list(group))
            parts.append(clearance_batch(grid, self._footprint, path[start:end, 1:], limit=limit, obstacles=others))
            start = end
        return np.concatenate(parts) if parts else np.zeros(0)

    def times_to_contact(self, times: ArrayLike, horizon: float = 10.0) -> NDArray[np.float64]:
        """Returns how long the robot could keep its velocity at past times until it touches something.

        At each time, the robot is moved on along its exact arc (`advance`), while obstacles and other robots stand where
        they were at that time. Without a footprint, the robot is a point.

        Args:
            times: (N,) simulated times [s], as for `poses_at`.
            horizon: Upper limit of the result [s].

        Returns:
            (N,) float64, time until the contact [s], at most `horizon`.

        Raises:
            ValueError: The times are not valid for `poses_at`, or the horizon is not positive and finite.
        """
        if not 0.0 < horizon < math.inf:
            raise ValueError(f"the horizon must be positive and finite, got {quoted(horizon)} s")
        poses, velocities = self.poses_at(times), self.velocities_at(times)
        found = np.full(len(poses), horizon)
        grid = self._world.grid
        if grid is None:
            return found
        for index in np.flatnonzero(velocities.any(axis=1)):
            around = self._world.around_at(self._robot, round(float(np.asarray(times)[index]) * NANOSECONDS))
            twist = tuple(velocities[index].tolist())
            _, contact = advance(grid, self._footprint, Pose(*poses[index].tolist()), twist, horizon, obstacles=around)
            if contact is not None:
                found[index] = contact.fraction * horizon
        return found

    def pose_at(self, time: float) -> Pose:
        """Returns the pose in the map frame at a past time.

        Args:
            time: Simulated time [s], from the time at which the robot was added until now.

        Raises:
            ValueError: The time is outside that range.
        """
        return self._robot.motion.map_pose_at(self._past_ns(time))

    def poses_at(self, times: ArrayLike) -> NDArray[np.float64]:
        """Returns the poses in the map frame at past times: those of `pose_at`, with yaws that are not wrapped.

        Args:
            times: (N,) simulated times [s], increasing, from the time at which the robot was added until now.

        Returns:
            (N, 3) float64, rows x [m], y [m], yaw [rad].

        Raises:
            ValueError: There are no times, they decrease, or one is outside that range.
        """
        return self._robot.motion.map_poses_at(self._past_times_ns(times))

    def velocities_at(self, times: ArrayLike) -> NDArray[np.float64]:
        """Returns the velocities at past times, as in `velocity`. Where the velocity jumps, it is the one after the jump.

        Args:
            times: (N,) simulated times [s], as for `poses_at`.

        Returns:
            (N, 3) float64, rows (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].

        Raises:
            ValueError: There are no times, they decrease, or one is outside the range of `poses_at`.
        """
        return self._robot.motion.velocities_at(self._past_times_ns(times))

    @property
    def path(self) -> NDArray[np.float64]:
        """The path driven so far, (N, 4) float64: time [s], x [m], y [m], yaw [rad] in the map frame.

        There is a point at each change of velocity and at least every `PATH_STEP` seconds in between. Every point is exact.
        In drives of more than `physics.motion.MAX_SEGMENTS` commands, older parts are thinned: the robot then moves at a
        constant velocity between exact points. In drives of more than 5000 s, points are farther apart. When the robot is
        moved to another pose, there are two points at that time: before and after.
        """
        now = self._world.now_ns()
        segments = self._robot.motion.trajectory(now)
        longest = max(PATH_STEP, (now - segments[0].start_ns) / NANOSECONDS / MAX_STEPS)
        rows: list[tuple[float, ...]] = []
        for segment, end_ns in zip(segments, [*(after.start_ns for after in segments[1:]), now], strict=True):
            length_ns = end_ns - segment.start_ns
            count = max(1, math.ceil(length_ns / NANOSECONDS / longest))
            for step in range(count + (end_ns == now)):
                time_ns = segment.start_ns + length_ns * step / count
                rows.append((time_ns / NANOSECONDS, *segment.pose_at(time_ns)))
        return np.array(rows)

    @property
    def _footprint(self) -> Shape:
        return self._robot.footprint or POINT

    def _past_times_ns(self, times: ArrayLike) -> NDArray[np.int64]:
        seconds = np.asarray(times, np.float64)
        with np.errstate(over="ignore"):
            times_ns = np.rint(seconds * NANOSECONDS)
        first, now = self._robot.motion.segments[0].start_ns, self._world.now_ns()
        for wrong in seconds[~((times_ns >= first) & (times_ns <= now))]:
            self._past_ns(float(wrong))  # raises
        if not len(times_ns) or np.any(np.diff(times_ns) < 0):
            raise ValueError(f"the times must be one or more and must not decrease, got {quoted(times)}")
        return times_ns.astype(np.int64)

    def _past_ns(self, time: float) -> int:
        first, now = self._robot.motion.segments[0].start_ns, self._world.now_ns()
        time_ns = round(time * NANOSECONDS) if math.isfinite(time) else -1
        if not first <= time_ns <= now:
            raise ValueError(f"the time must be in {first / NANOSECONDS:g}..{now / NANOSECONDS:g} s, got {quoted(time)}")
        return time_ns
