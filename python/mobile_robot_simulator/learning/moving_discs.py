"""Discs that move to and fro in the worlds of environments."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .._core import Shape
from ..scenarios import Moving
from .free_space import FreeSpace

LEGS = (1.0, 5.0)
"""Least and largest distance between the ends of the way of a disc [m]."""

Disc = tuple[Shape, NDArray[np.float64] | None]
"""A disc and its waypoints (K, 4), rows (time, x, y, yaw) [s, m, m, rad]; None if it is not there."""


class MovingDiscs:
    """Draws the discs of episodes: how many there are, their sizes, and their ways.

    A disc moves to and fro between two places where the robot could be, in a straight line, also through walls. One that
    is slow enough to stand, or has no second place, stands. It is left out if it would be too near to the start of the
    robot, or if it would stand too near to its goal.

    Args:
        limits: What may differ between the discs.
        space: Where the robot can be.
        duration: Duration of an episode [s].

    Example:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> from mobile_robot_simulator.scenarios import Moving, Range
        >>> space = FreeSpace([mrs.OccupancyGrid(np.zeros((90, 90), np.int8), resolution=0.1)], radius=0.2)
        >>> discs = MovingDiscs(Moving(1, at_least=1, speed=Range(0.5, 0.5, "m/s")), space, duration=9.0)
        >>> [[(shape, waypoints)]] = discs.draw([0], np.zeros((1, 3)), np.zeros((1, 2)), [np.random.default_rng(1)])
        >>> round(shape.reach, 2), waypoints[:, 0].round(2)  # it turns back every 4.64 s, after 2.32 m
        (0.29, array([0.  , 4.64, 9.28]))
    """

    def __init__(self, limits: Moving, space: FreeSpace, duration: float) -> None:
        self._limits, self._space, self._duration = limits, space, duration

    @property
    def absent(self) -> list[Disc]:
        """The discs of an environment before its first episode: none of them is there."""
        return [(Shape.disc(self._limits.radius.high), None)] * self._limits.at_most

    def draw(
        self,
        worlds: Sequence[int] | NDArray[np.intp],
        starts: NDArray[np.float64],
        goals: NDArray[np.float64],
        generators: Sequence[np.random.Generator],
    ) -> list[list[Disc]]:
        """Draws the discs of one episode of each of some environments.

        Args:
            worlds: (M,), index of the world of each environment.
            starts: (M, 3), the starts of the robots [m, m, rad].
            goals: (M, 2), their goals [m].
            generators: The generator of each environment, from which the same number of draws is taken for each episode.

        Returns:
            For each environment, as many discs as there may be at most.
        """
        limits, each = self._limits, FreeSpace.NUMBERS + 2
        numbers = np.array([generator.random(1 + each * limits.at_most) for generator in generators])
        counts = limits.at_least + (numbers[:, 0] * (limits.at_most - limits.at_least + 1)).astype(np.intp)
        discs: list[list[Disc]] = [[] for _ in generators]
        for which in range(limits.at_most):
            own = numbers[:, 1 + which * each :][:, :each]
            begins, ends, found = self._space.draw(np.asarray(worlds), LEGS, own[:, 2:])
            radii = limits.radius.low + own[:, 0] * (limits.radius.high - limits.radius.low)
            speeds = limits.speed.low + own[:, 1] * (limits.speed.high - limits.speed.low)
            for index, radius in enumerate(radii.tolist()):
                begin, near = begins[index, :2], radius + limits.from_start
                way = self._way(begin, ends[index], speeds[index] if found[index] else 0.0)
                is_there = which < counts[index] and math.dist(begin, starts[index, :2]) >= near
                if len(way) == 1:
                    is_there = is_there and math.dist(begin, goals[index]) >= near
                discs[index].append((Shape.disc(radius), way if is_there else None))
        return discs

    def _way(self, begin: NDArray[np.float64], end: NDArray[np.float64], speed: float) -> NDArray[np.float64]:
        """Returns the waypoints of a disc that goes to and fro at a speed [m/s]."""
        leg = math.dist(begin, end) / speed if speed > 0.0 else math.inf
        count = 1 if leg > 1e3 * self._duration else math.ceil(self._duration / leg) + 1
        way = np.zeros((count, 4))
        way[1:, 0] = np.arange(1, count) * leg
        way[0::2, 1:3], way[1::2, 1:3] = begin, end
        return way
