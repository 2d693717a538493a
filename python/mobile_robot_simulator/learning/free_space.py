"""Where a robot can go in its world, and starts and goals that are connected."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid
from ..maps.floor_plans.connectivity import label


class FreeSpace:
    """The connected free space of a disc in each of some worlds.

    A cell belongs to it if it is known to be free, and the disc overlaps nothing wherever in the cell its centre is.
    Two cells are connected if a chain of such cells with common sides joins them. So the disc can move from any point
    of one to any point of the other. Passages that are wider than the disc by less than about three cells do not count.

    Args:
        worlds: The worlds.
        radius: Radius of the disc [m].

    Raises:
        ValueError: The radius is negative, or a world has no such cell.

    Example:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> cells = np.zeros((9, 21), np.int8)
        >>> cells[:, 10] = 100  # a wall between two rooms
        >>> space = FreeSpace([mrs.OccupancyGrid(cells, resolution=0.5)], radius=0.5)
        >>> [space.are_connected(0, (1.0, 1.0), goal) for goal in [(2.0, 3.0), (9.0, 1.0)]]
        [True, False]
    """

    ATTEMPTS = 16
    """Number of goals that are tried for a start."""

    NUMBERS = 4 + 2 * ATTEMPTS
    """Number of random numbers for a start and its goal."""

    def __init__(self, worlds: Sequence[OccupancyGrid], radius: float) -> None:
        if not (math.isfinite(radius) and radius >= 0.0):
            raise ValueError(f"radius must be at least 0, got {radius} m")
        labels = [_labels(world, radius) for world in worlds]
        for index, parts in enumerate(labels):
            if not parts.any():
                raise ValueError(
                    f"a world must have free space for a robot of radius {radius:g} m, got none in world {index}"
                )
        self._worlds = [_World(world, parts) for world, parts in zip(worlds, labels, strict=True)]

    def are_connected(self, world: int, start: Sequence[float], goal: Sequence[float]) -> bool:
        """Tells whether two points (x, y) [m] in the map frame of a world are in the same connected part."""
        one, other = (self._worlds[world].label_at(*point[:2]) for point in (start, goal))
        return one == other != 0

    def draw(
        self, worlds: NDArray[np.intp], distances: tuple[float, float], numbers: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Draws a start and a goal that is connected to it in each of some worlds.

        The start is uniform over the free space, and its yaw over [-π, π). The goal is the first one of some in random
        directions that is connected; its distance from the start, in a straight line, is uniform between two limits
        before that choice.

        Args:
            worlds: (M,), indices of the worlds.
            distances: Least and largest distance [m].
            numbers: (M, NUMBERS), random numbers in [0, 1).

        Returns:
            The starts, (M, 3), poses x, y, yaw [m, m, rad] in the map frame; the goals, (M, 2), points x, y [m] in the
            map frame; and whether a goal was found, (M,) bool.
        """
        starts, goals, found = np.empty((len(worlds), 3)), np.empty((len(worlds), 2)), np.empty(len(worlds), np.bool_)
        for row, (world, some) in enumerate(zip(worlds.tolist(), numbers.tolist(), strict=True)):
            starts[row], goals[row], found[row] = self.draw_one(world, distances, some)
        return starts, goals, found

    def draw_one(
        self, world: int, distances: tuple[float, float], numbers: Sequence[float]
    ) -> tuple[tuple[float, float, float], tuple[float, float], bool]:
        """Draws a start and a goal in one world, from NUMBERS random numbers; see `draw`."""
        return self._worlds[world].draw(*distances, numbers)


class _World:
    """The free space of one world. Its methods take single numbers, because mostly one episode begins at a time."""

    def __init__(self, grid: OccupancyGrid, labels: NDArray[np.int32]) -> None:
        (self._left, self._bottom, yaw), self._resolution = grid.origin, grid.resolution
        self._cos, self._sin = math.cos(yaw), math.sin(yaw)
        self._height, self._width = labels.shape
        self._labels = labels.ravel()
        self._cells = np.flatnonzero(labels).astype(np.int32)

    def draw(
        self, low: float, high: float, numbers: Sequence[float]
    ) -> tuple[tuple[float, float, float], tuple[float, float], bool]:
        """Draws a start, and a goal at a distance between two limits [m]; see `FreeSpace.draw`."""
        cell = self._cells.item(int(numbers[0] * len(self._cells)))
        row, col = divmod(cell, self._width)
        dx, dy = (col + numbers[1]) * self._resolution, (row + numbers[2]) * self._resolution
        x = self._left + self._cos * dx - self._sin * dy
        y = self._bottom + self._sin * dx + self._cos * dy
        own, goals = self._labels.item(cell), []
        for turn, share in zip(numbers[4::2], numbers[5::2], strict=True):
            direction, length = turn * math.tau, low + share * (high - low)
            goals.append((x + length * math.cos(direction), y + length * math.sin(direction)))
            if self.label_at(*goals[-1]) == own:
                return (x, y, (numbers[3] * 2.0 - 1.0) * math.pi), goals[-1], True
        return (x, y, (numbers[3] * 2.0 - 1.0) * math.pi), goals[0], False

    def label_at(self, x: float, y: float) -> int:
        """Returns the label of the part at a point [m] of the map frame; 0 where there is none."""
        dx, dy = x - self._left, y - self._bottom
        col = math.floor((self._cos * dx + self._sin * dy) / self._resolution)
        row = math.floor((self._cos * dy - self._sin * dx) / self._resolution)
        inside = 0 <= col < self._width and 0 <= row < self._height
        return self._labels.item(row * self._width + col) if inside else 0


def _labels(world: OccupancyGrid, radius: float) -> NDArray[np.int32]:
    """Returns the label of the connected part of each cell, (H, W); 0 for cells that do not belong to one."""
    # The distances are those between centres. Points of two cells are nearer than the centres by at most a diagonal.
    needed = radius + math.sqrt(2.0) * world.resolution
    free = world.distances(needed * 1.01) >= needed
    return label(free & (world.cells >= 0))
