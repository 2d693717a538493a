"""Goal: a driver that takes a robot to a pose, around walls and obstacles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid, Pose, Shape, clearance_batch
from ..physics.velocity_profile import Velocity

MARGINS = (0.3, 0.15, 0.05, 0.01)
"""Distances that a route keeps from everything [m]. The first with which there is a route is chosen."""

MOST_CELLS = 250
"""Cells of the route's own grid along the longer side of the map. It is coarser than the map if that is larger."""

NEAR, ALIGNED = 0.05, 0.03
"""Distance [m] and angle [rad] at which a robot has arrived."""

Obstacles = Sequence[tuple[Shape, Pose]]
"""Shapes with their poses in the map frame."""

_NEIGHBOURS = ((0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))


@dataclass(frozen=True)
class Goal:
    """A driver that takes a robot to a pose.

    It knows the map, the obstacles and the true pose of the robot. It plans a route on a grid of its own, heads for the
    farthest point of the route that it can reach in a straight line, and plans again when its way is blocked.

    Args:
        pose: Pose to reach, in the map frame.
        radius: Radius of the robot [m].
        speed: Largest speed [m/s].
        turn_rate: Largest turn rate [rad/s].
    """

    pose: Pose
    radius: float = 0.2
    speed: float = 0.8
    turn_rate: float = 1.2


@dataclass
class Travel:
    """The way of a robot to its goal.

    Attributes:
        goal: The goal.
        route: Points (x, y) of the route in the map frame [m], empty before the first plan.
        margin: Distance that the route keeps from everything [m].
    """

    goal: Goal
    route: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    margin: float = MARGINS[0]

    def velocity(self, grid: OccupancyGrid, obstacles: Obstacles, pose: Pose) -> Velocity | None:
        """Returns the velocity (vx, vy, wz) [m/s, m/s, rad/s] that leads to the goal, or None if the robot is there.

        Args:
            grid: The map.
            obstacles: Shapes with their poses now.
            pose: Pose of the robot in the map frame.

        Raises:
            ValueError: There is no way to the goal.
        """
        goal = self.goal
        if math.hypot(goal.pose.x - pose.x, goal.pose.y - pose.y) <= NEAR:
            left = _wrapped(goal.pose.yaw - pose.yaw)
            return None if abs(left) <= ALIGNED else (0.0, 0.0, _limited(2.0 * left, goal.turn_rate))
        target = self._target(grid, obstacles, pose)
        if target is None:
            self.route, self.margin = plan(grid, obstacles, goal.radius, pose, goal.pose)
            target = self._target(grid, obstacles, pose)
        x, y = self.route[0] if target is None else target
        left = _wrapped(math.atan2(y - pose.y, x - pose.x) - pose.yaw)
        turn = _limited(2.5 * left, goal.turn_rate)
        if abs(left) > 0.6:
            return 0.0, 0.0, turn
        return min(goal.speed, max(0.1, math.hypot(x - pose.x, y - pose.y))) * math.cos(left) ** 4, 0.0, turn

    def _target(self, grid: OccupancyGrid, obstacles: Obstacles, pose: Pose) -> tuple[float, float] | None:
        """Returns the farthest point of the route that the robot can reach in a straight line, and forgets those before."""
        body = Shape.disc(self.goal.radius)
        for index in range(len(self.route) - 1, -1, -1):
            x, y = self.route[index]
            length = math.hypot(x - pose.x, y - pose.y)
            if length > 6.0 and index:
                continue
            count = max(2, math.ceil(length / 0.1))
            line = np.zeros((count, 3))
            line[:, 0], line[:, 1] = np.linspace(pose.x, x, count), np.linspace(pose.y, y, count)
            # The robot may stand closer to something than the route does, so its own place does not count.
            if (
                clearance_batch(grid, body, line[1:], limit=self.margin, obstacles=obstacles, threads=1) > 0.5 * self.margin
            ).all():
                self.route = self.route[index:]
                return float(x), float(y)
        return None


def plan(
    grid: OccupancyGrid, obstacles: Obstacles, radius: float, start: Pose, goal: Pose
) -> tuple[NDArray[np.float64], float]:
    """Returns a short route for a disc, and the distance that it keeps from everything.

    The route is the shortest one over the cells of a grid of its own, by a wave from the goal.

    Args:
        grid: The map.
        obstacles: Shapes with their poses in the map frame.
        radius: Radius of the disc [m].
        start: Where the route starts.
        goal: Where it ends.

    Returns:
        (N, 2) points after the start, the last of them the goal [m], and the distance [m].

    Raises:
        ValueError: There is no route.
    """
    rows, columns = grid.shape
    cell = max(grid.resolution, max(rows, columns) * grid.resolution / MOST_CELLS)
    height, width = math.ceil(rows * grid.resolution / cell), math.ceil(columns * grid.resolution / cell)
    local = np.stack(np.meshgrid((np.arange(width) + 0.5) * cell, (np.arange(height) + 0.5) * cell), axis=-1)
    cos, sin = math.cos(grid.origin.yaw), math.sin(grid.origin.yaw)
    centres = np.zeros((height * width, 3))
    flat = local.reshape(-1, 2)
    centres[:, 0] = grid.origin.x + cos * flat[:, 0] - sin * flat[:, 1]
    centres[:, 1] = grid.origin.y + sin * flat[:, 0] + cos * flat[:, 1]
    room = clearance_batch(grid, Shape.disc(radius), centres, limit=2 * MARGINS[0], obstacles=obstacles)
    room = room.reshape(height, width)

    def cell_of(pose: Pose) -> tuple[int, int]:
        inside = grid.origin.inverse() * pose
        return int(inside.y // cell), int(inside.x // cell)

    first, last = cell_of(start), cell_of(goal)
    for where, at in (("robot", first), ("goal", last)):
        if not (0 <= at[0] < height and 0 <= at[1] < width):
            raise ValueError(f"the built-in driver needs the {where} on the map")
    for margin in MARGINS:
        free = room > margin
        free[first] = free[last] = True
        steps = _steps_from(last, free)
        if steps[first] >= 0:
            break
    else:
        raise ValueError(f"there is no way to the goal ({goal.x:.2f}, {goal.y:.2f}) that is wide enough for the robot")
    points, at = [], first
    while at != last:
        at = min(_around(at, steps), key=lambda each: (steps[each], abs(each[0] - at[0]) + abs(each[1] - at[1])))
        points.append(centres[at[0] * width + at[1], :2])
    points[-1:] = [np.array([goal.x, goal.y])]
    return np.array(points), margin


def _steps_from(source: tuple[int, int], free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Returns the number of steps from a cell to each free cell, -1 where none leads. Diagonal steps cut no corner."""
    steps = np.full(free.shape, -1, np.int32)
    steps[source] = 0
    wave, count = np.zeros_like(free), 0
    wave[source] = True
    while wave.any():
        count += 1
        spread = np.zeros_like(wave)
        spread[1:] |= wave[:-1]
        spread[:-1] |= wave[1:]
        spread[:, 1:] |= wave[:, :-1]
        spread[:, :-1] |= wave[:, 1:]
        if count % 2 == 0:
            # Every second step may also be diagonal. The distances are then those of an octagon, close to true lengths.
            beside = spread & free
            spread[1:] |= beside[:-1] & free[:-1]
            spread[:-1] |= beside[1:] & free[1:]
        wave = spread & free & (steps < 0)
        steps[wave] = count
    return steps


def _around(at: tuple[int, int], steps: NDArray[np.int32]) -> list[tuple[int, int]]:
    """Returns the cells beside a cell that the wave has reached, without cutting corners."""
    height, width = steps.shape
    found = []
    for down, right in _NEIGHBOURS:
        row, column = at[0] + down, at[1] + right
        if not (0 <= row < height and 0 <= column < width) or steps[row, column] < 0:
            continue
        if down and right and (steps[row, at[1]] < 0 or steps[at[0], column] < 0):
            continue
        found.append((row, column))
    return found


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)


def _limited(value: float, largest: float) -> float:
    return max(-largest, min(largest, value))
