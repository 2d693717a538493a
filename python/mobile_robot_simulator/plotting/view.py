"""Views: the part of the map frame that a picture shows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike, NDArray

from .._core import OccupancyGrid, Pose

Points: TypeAlias = NDArray[np.float64]
PoseLike: TypeAlias = Pose | Sequence[float]

LONGEST_SIDE, SHORTEST_SIDE = 9.0, 3.0  # of the axes of a saved picture [in]


def finite_rows(name: str, values: ArrayLike | Pose | None, widths: tuple[int, ...]) -> Points:
    """Returns rows of finite numbers, (N, width) float64. A single row may be one-dimensional; None gives no rows."""
    if values is None:
        return np.zeros((0, widths[-1]))
    rows = np.array(tuple(values) if isinstance(values, Pose) else values, np.float64)
    if rows.ndim == 1 and rows.size:
        rows = rows[None]
    if rows.ndim != 2 or rows.shape[1] not in widths:
        needed = " or ".join(f"(N, {width})" for width in widths)
        raise ValueError(f"{name} must have shape {needed}, got {np.shape(rows)}")
    if not np.isfinite(rows).all():
        raise ValueError(f"{name} must be finite, got {rows[~np.isfinite(rows).all(axis=1)][0]}")
    return rows


def view_of(points: Points, *, margin: float) -> Points:
    """Returns the lower left and upper right corner [m], (2, 2), of a view that contains all points.

    The margin is a fraction of the longest side. A narrow view is widened, so that no picture becomes a thin strip.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    longest = max((high - low).max(), 1e-3)
    half = np.maximum((high - low) / 2 + margin * longest, longest / 2 * SHORTEST_SIDE / LONGEST_SIDE)
    return np.array([(low + high) / 2 - half, (low + high) / 2 + half])


def map_from_cells(grid: OccupancyGrid) -> Affine2D:
    """Returns the transform from cells (column, row) to the map frame [m]."""
    x, y, yaw = grid.origin
    return Affine2D().scale(grid.resolution).rotate(yaw).translate(x, y)


def grid_corners(grid: OccupancyGrid) -> Points:
    """Returns the four corners of a grid in the map frame [m], (4, 2)."""
    height, width = grid.shape
    corners: Points = map_from_cells(grid).transform([(0, 0), (width, 0), (width, height), (0, height)])
    return corners


def known_corners(grid: OccupancyGrid, near: Points) -> Points:
    """Returns the lower left and upper right corner [m], (2, 2), of the known cells near some points in the map frame.

    Near means within the bounding box of the points, extended on each side by its longest side, but at least by 10 m. If
    no cell is known, all cells count.
    """
    known = grid.cells >= 0
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        rows, cols = (np.arange(size) for size in grid.shape)
    left, right, bottom, top = cols[0], cols[-1] + 1, rows[0], rows[-1] + 1
    corners = map_from_cells(grid).transform([(left, bottom), (right, bottom), (right, top), (left, top)])
    low, high = near.min(axis=0), near.max(axis=0)
    reach = max(10.0, (high - low).max())
    near_corners: Points = np.clip([corners.min(axis=0), corners.max(axis=0)], low - reach, high + reach)
    return near_corners
