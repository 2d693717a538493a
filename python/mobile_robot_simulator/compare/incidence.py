"""Incidence: the angle at which beams meet the walls of a map."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid

RADIUS = 5
"""Blocking cells within this many cells of a beam's end make the wall's direction."""

_BEFORE = 1.5  # cells before a wall's face; otherwise the normal of a thin wall is not certain
_CHUNK = 100_000


def incidence_of(
    grid: OccupancyGrid,
    ends: NDArray[np.float64],
    directions: NDArray[np.float64],
    *,
    progress: Callable[[float], None] = lambda _: None,
) -> NDArray[np.float32]:
    """Returns the angle between each beam and the normal of its wall: 0 for a beam at right angles to the wall.

    The normal points from the centre of the blocking cells near the end to a point just before the end. Near cells count
    more. So a wall of one cell has a normal too, and the steps of a slanting wall are averaged: half of the angles are
    within 4° of the right one. In a corner, the normal is between those of the walls.

    Args:
        grid: The map.
        ends: (N, 2) float64, where each beam meets its wall in the map frame [m].
        directions: (N,) float64, direction of each beam in the map frame [rad].
        progress: Called repeatedly with the share of the beams that are done, up to 1.

    Returns:
        (N,) float32 [rad], 0 to π/2. NaN if no cell near the end blocks, as where only the middle of a cell is near.
    """
    is_blocking = np.pad(_blocking(grid), RADIUS + 1, constant_values=False)
    x0, y0, turn = grid.origin
    angles = np.empty(len(ends), np.float32)
    for first in range(0, len(ends), _CHUNK):
        rows = slice(first, min(first + _CHUNK, len(ends)))
        dx, dy = ends[rows, 0] - x0, ends[rows, 1] - y0
        ahead = np.column_stack([np.cos(directions[rows] - turn), np.sin(directions[rows] - turn)])
        at = np.column_stack([np.cos(turn) * dx + np.sin(turn) * dy, np.cos(turn) * dy - np.sin(turn) * dx])
        at = at / grid.resolution - _BEFORE * ahead
        moment = _moment(is_blocking, at)
        size = np.hypot(moment[:, 0], moment[:, 1])
        cosine = np.abs((moment * ahead).sum(axis=1)) / np.where(size > 0.0, size, np.nan)
        angles[rows] = np.arccos(np.minimum(cosine, 1.0))
        progress(rows.stop / len(ends))
    return angles


def _blocking(grid: OccupancyGrid) -> NDArray[np.bool_]:
    """Returns which cells block beams, (H, W)."""
    is_blocking: NDArray[np.bool_] = grid.cells >= grid.occupied_threshold
    if grid.unknown == "occupied":
        is_blocking |= grid.cells < 0
    return is_blocking


def _moment(is_blocking: NDArray[np.bool_], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the weighted sum (N, 2) of the ways from points to the centres of blocking cells, in cells.

    Args:
        is_blocking: Cells with a margin of `RADIUS` + 1 on each side.
        at: (N, 2) points, in cells from the corner without the margin: column, row.
    """
    margin = RADIUS + 1
    high = np.array(is_blocking.shape[::-1]) - 2 * margin
    cells = np.clip(np.floor(at), -1, high).astype(np.intp)
    moment = np.zeros_like(at)
    for row in range(-RADIUS, RADIUS + 1):
        for col in range(-RADIUS, RADIUS + 1):
            way = cells + np.array([col, row]) + 0.5 - at
            weight = 1.0 - (way**2).sum(axis=1) / (RADIUS + 0.5) ** 2
            weight *= is_blocking[cells[:, 1] + row + margin, cells[:, 0] + col + margin]
            moment += np.maximum(weight, 0.0)[:, None] * way
    return moment
