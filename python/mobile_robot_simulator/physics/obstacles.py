"""Obstacles: things that stand or move in a simulation. Scanners see them, and robots collide with them."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from numbers import Real
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._core import Pose, Shape
from ..handle import Handle
from ..instant import NANOSECONDS
from ..quoting import quoted
from .motion import Motion, MotionSnapshot
from .velocity_profile import Velocity

PoseLike: TypeAlias = Pose | tuple[float, float, float]
"""A pose, or its x, y [m] and yaw [rad]."""

Course: TypeAlias = Pose | NDArray[np.float64]
"""One pose, or an (N, 3) array of poses at several times."""

Waypoints: TypeAlias = Sequence[tuple[float, float, float, float]]
"""Rows of time [s], x, y [m] and yaw [rad], with increasing times."""

Trajectory: TypeAlias = PoseLike | Waypoints | Callable[[float], PoseLike]
"""Where an obstacle is: one pose, waypoints, or a function from the time [s] to a pose."""


class Obstacle(Handle):
    """A shape that stands or moves in the map.

    An obstacle whose trajectory is one pose can be moved, with `Simulation.move_obstacle`. It does not stop at anything.

    Args:
        name: Name of the obstacle, as contacts report it.
        shape: Outline in the obstacle's own frame.
        trajectory: Poses in the map frame, in one of three forms:

            - a pose: the obstacle stands there until it is moved;
            - waypoints (time [s], x, y [m], yaw [rad]) with increasing times: x, y and yaw are interpolated linearly;
              the obstacle stands at the first waypoint before its time and at the last one after its time;
            - a function from the time [s] to a pose. It can be called at any time and any number of times, also for past
              times. Its result must depend only on the time and on state that the simulation saves.

    Raises:
        ValueError: There are no waypoints, a waypoint is not four finite numbers, or the times do not increase.

    """

    def __init__(self, name: str, shape: Shape, trajectory: Trajectory) -> None:
        self.name, self.shape = name, shape
        self._pose_at = _pose_function(trajectory)
        self._motion: Motion | None = None
        """How the obstacle has moved since it was moved for the first time."""
        self._standing = (shape, self._pose_at.pose) if isinstance(self._pose_at, _Standing) else None

    def __repr__(self) -> str:
        return f"Obstacle({self.name!r}, {self.shape!r})"

    def pose(self, time_ns: int) -> Pose:
        """Returns the pose in the map frame at a time.

        Args:
            time_ns: The time [ns].

        Raises:
            TypeError: The trajectory's function did not return a pose.
            ValueError: The pose is not finite.
            Exception: Any error that the trajectory's function raises.

        """
        if self._motion is not None:
            return self._motion.map_pose_at(time_ns)
        pose = self._pose_at(time_ns / NANOSECONDS)
        if isinstance(pose, Pose):
            return pose
        message = f"the trajectory of obstacle {self.name} must return poses (x, y, yaw), got {quoted(pose)}"
        try:
            x, y, yaw = pose
        except (TypeError, ValueError) as error:
            raise TypeError(message) from error
        try:
            return Pose(x, y, yaw)
        except TypeError as error:
            raise TypeError(message) from error

    @property
    def stands(self) -> bool:
        """True if the obstacle has one pose and was never moved."""
        return self._standing is not None and self._motion is None

    def placed(self, time_ns: int) -> tuple[Shape, Pose]:
        """Returns the shape and the pose in the map frame at a time; always the same tuple if the obstacle stands.

        Args:
            time_ns: The time [ns].

        Raises:
            Exception: Those of `pose`.
        """
        if self._standing is not None and self._motion is None:
            return self._standing
        return self.shape, self.pose(time_ns)

    def course(self, times_ns: NDArray[np.int64]) -> Course:
        """Returns where the obstacle is at several times: those of `pose`.

        Args:
            times_ns: (N,) int64, increasing times [ns].

        Returns:
            The pose of an obstacle that was never moved; else (N, 3) float64, rows (x, y, yaw) [m, m, rad].

        Raises:
            Exception: Those of `pose`.
        """
        if self._motion is not None:
            return self._motion.map_poses_at(times_ns)
        if isinstance(self._pose_at, _Standing):
            return self._pose_at.pose
        return np.array([tuple(self.pose(time_ns)) for time_ns in times_ns.tolist()])

    def move(self, time_ns: int, *, pose: Pose | None = None, velocity: Velocity | None = None) -> None:
        """Moves the obstacle from now on.

        Args:
            time_ns: The present [ns].
            pose: Pose in the map frame to move to at once. Default: where it is.
            velocity: Velocity (vx, vy, wz) from now on, in the obstacle's own frame [m/s, m/s, rad/s]. Default: as before.

        Raises:
            ValueError: The obstacle follows waypoints or a function.
        """
        if not isinstance(self._pose_at, _Standing):
            raise ValueError(f"obstacle {self.name} must have one pose as its trajectory to be moved, it has a moving one")
        if self._motion is None:
            self._motion = Motion(0, 0.0, Pose(), self._pose_at.pose)
        if pose is not None:
            self._motion.move_frame(pose * self._motion.pose(time_ns).inverse(), time_ns)
        if velocity is not None:
            self._motion.command(velocity, time_ns)

    def save(self) -> ObstacleSnapshot:
        """Returns the state that `restore` takes."""
        return ObstacleSnapshot(self, None if self._motion is None else (self._motion, self._motion.save()))

    def restore(self, state: ObstacleSnapshot) -> None:
        """Puts the obstacle back into a saved state."""
        self._motion = None
        if state.motion is not None:
            self._motion, moved = state.motion
            self._motion.restore(moved)


@dataclass(frozen=True, slots=True)
class ObstacleSnapshot:
    """Saved state of an `Obstacle`: how it has moved, None if it was never moved."""

    obstacle: Obstacle
    motion: tuple[Motion, MotionSnapshot] | None


@dataclass(frozen=True, slots=True)
class _Standing:
    """A trajectory that stands still."""

    pose: Pose

    def __call__(self, time: float) -> Pose:
        return self.pose


def _pose_function(trajectory: Trajectory) -> Callable[[float], PoseLike]:
    """Returns the trajectory as a function from the time [s] to a pose."""
    if callable(trajectory):
        return trajectory
    if isinstance(trajectory, Pose):
        return _Standing(trajectory)
    if not isinstance(trajectory, Sequence | np.ndarray) or isinstance(trajectory, str):
        needed = "a pose (x, y, yaw), waypoints (time, x, y, yaw), or a function from the time to a pose"
        raise TypeError(f"a trajectory must be {needed}, got {quoted(trajectory)}")
    if not len(trajectory):
        raise ValueError("a trajectory must have at least one waypoint, got none")
    if isinstance(trajectory[0], Real):
        if len(trajectory) != 3:
            raise ValueError(f"the pose of an obstacle must be three numbers (x, y, yaw), got {quoted(trajectory)}")
        return _Standing(Pose(*trajectory))
    try:
        rows = [tuple(map(float, row)) for row in trajectory]  # type: ignore[arg-type]
    except TypeError:
        raise TypeError(f"a waypoint must be four numbers (time, x, y, yaw), got {quoted(trajectory)}") from None
    if any(len(row) != 4 or not math.isfinite(row[0]) for row in rows):
        raise ValueError(f"a waypoint must be four finite numbers (time, x, y, yaw), got {quoted(rows)}")
    times, poses = [row[0] for row in rows], [Pose(*row[1:]) for row in rows]
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise ValueError(f"the times of waypoints must increase, got {quoted(times)}")

    def interpolated(time: float) -> PoseLike:
        after = bisect_right(times, time)
        if after in (0, len(times)):
            return poses[max(0, after - 1)]
        share = (time - times[after - 1]) / (times[after] - times[after - 1])
        (x0, y0, yaw0), (x1, y1, yaw1) = poses[after - 1], poses[after]
        return x0 + share * (x1 - x0), y0 + share * (y1 - y0), yaw0 + share * (yaw1 - yaw0)

    return interpolated
