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
        first = np.cumsum([0, *(parts.size for parts in labels)])[:-1]
        self._labels = np.concatenate([parts.ravel() for parts in labels])
        cells = [np.flatnonzero(parts).astype(np.int32) for parts in labels]
        self._counts = np.array([len(some) for some in cells])
        self._first_cell = np.cumsum([0, *self._counts])[:-1]
        self._cells = np.concatenate(cells)
        origins = np.array([tuple(world.origin) for world in worlds])
        # One table, so that all numbers of some worlds are one look-up.
        self._frames = np.array(
            [
                *origins[:, :2].T,
                np.cos(origins[:, 2]),
                np.sin(origins[:, 2]),
                [world.resolution for world in worlds],
                *zip(*(parts.shape for parts in labels), strict=True),
                first,
            ]
        )

    def are_connected(self, world: int, start: Sequence[float], goal: Sequence[float]) -> bool:
        """Tells whether two points (x, y) [m] in the map frame of a world are in the same connected part."""
        one, other = self._labels_at(np.array([world, world]), *np.array([start[:2], goal[:2]], float).T)
        return bool(one == other and one != 0)

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
        left, bottom, cos, sin, resolutions, _, widths, first = self._frames[:, worlds]
        cells = self._cells[self._first_cell[worlds] + (numbers[:, 0] * self._counts[worlds]).astype(np.intp)]
        rows, cols = np.divmod(cells, widths)
        dx, dy = (cols + numbers[:, 1]) * resolutions, (rows + numbers[:, 2]) * resolutions
        starts = np.empty((len(worlds), 3))
        starts[:, 0] = left + cos * dx - sin * dy
        starts[:, 1] = bottom + sin * dx + cos * dy
        starts[:, 2] = (numbers[:, 3] * 2.0 - 1.0) * math.pi
        # One row for each attempt: NumPy is slow where it must repeat numbers itself.
        every = np.repeat(np.arange(len(worlds)), self.ATTEMPTS)
        directions = numbers[:, 4::2].ravel() * math.tau
        lengths = distances[0] + numbers[:, 5::2].ravel() * (distances[1] - distances[0])
        x, y = starts[every, 0] + lengths * np.cos(directions), starts[every, 1] + lengths * np.sin(directions)
        own = self._labels[first.astype(np.intp) + cells]
        fits = self._labels_at(worlds[every], x, y) == own[every]
        chosen = fits.reshape(-1, self.ATTEMPTS).argmax(axis=1) + np.arange(0, len(every), self.ATTEMPTS)
        return starts, np.array([x[chosen], y[chosen]]).T, fits[chosen]

    def _labels_at(self, worlds: NDArray[np.intp], x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.int32]:
        """Returns the labels of the parts at points (M,) of the map frames of worlds (M,); 0 where there is none."""
        left, bottom, cos, sin, resolutions, heights, widths, first = self._frames[:, worlds]
        dx, dy = x - left, y - bottom
        cols = np.floor((cos * dx + sin * dy) / resolutions)
        rows = np.floor((cos * dy - sin * dx) / resolutions)
        inside = (cols >= 0) & (cols < widths) & (rows >= 0) & (rows < heights)
        cells = np.where(inside, first + rows * widths + cols, 0.0).astype(np.intp)
        return np.where(inside, self._labels[cells], np.int32(0))


def _labels(world: OccupancyGrid, radius: float) -> NDArray[np.int32]:
    """Returns the label of the connected part of each cell, (H, W); 0 for cells that do not belong to one."""
    # The distances are those between centres. Points of two cells are nearer than the centres by at most a diagonal.
    needed = radius + math.sqrt(2.0) * world.resolution
    free = world.distances(needed * 1.01) >= needed
    return label(free & (world.cells >= 0))
