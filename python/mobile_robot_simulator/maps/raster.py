"""Rasters: draws areas, walls and discs, given in metres, into the cells of a grid.

Which cells are occupied:

- **Areas and discs**: every cell that they cover in part. A cell that only touches their boundary stays free.
- **Walls** have no thickness: every cell that they pass through. A cell includes its left and its lower edge, so a wall
  between two cells is in the right or in the upper one.

So no gap opens, and free space never becomes larger than drawn. Coordinates are rounded to 1/1024 of a cell first. Then
areas and walls are drawn with whole numbers, without further rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from .cell_map import CellMap

__all__ = ["Raster"]

_Points = NDArray[np.float64]
_Ticks = NDArray[np.int64]

_CELL = 2048
"""Ticks per cell. Corners of areas have even numbers. Walls have odd ones, so that they are never between two cells."""

_MAX_CELLS = 2**28
_MAX_SIDE = 65_535


class Raster:
    """A grid that is drawn on. Edges of its cells are multiples of the resolution, so that round numbers of metres are."""

    def __init__(self, low: Sequence[float], high: Sequence[float], resolution: float) -> None:
        """Makes a grid of free cells around a rectangle, with a margin of one cell.

        Args:
            low: Lower-left corner (x, y) of the rectangle [m].
            high: Upper-right corner (x, y) of the rectangle [m].
            resolution: Side of a cell [m].

        Raises:
            ValueError: The rectangle is not finite, or the grid is too large.
        """
        first, last = (np.rint(np.asarray(corner, np.float64) / resolution * (_CELL // 2)) for corner in (low, high))
        if not np.isfinite([first, last]).all():
            raise ValueError(f"coordinates must be finite, got from {tuple(low)} to {tuple(high)}")
        first, last = np.floor(2 * first / _CELL) - 1, np.ceil(2 * last / _CELL) + 1
        width, height = last - first
        if max(width, height) > _MAX_SIDE or width * height > _MAX_CELLS:
            raise ValueError(
                f"a grid must have at most {_MAX_CELLS} cells and {_MAX_SIDE} in a row, got {width:.0f} x {height:.0f}: "
                f"{width * resolution:g} m x {height * resolution:g} m in cells of {resolution:g} m"
            )
        self._first = first
        self._resolution = resolution
        self._occupied = np.zeros((int(height), int(width)), np.bool_)

    def add_area(self, rings: Iterable[_Points], *, is_even_odd: bool = False) -> None:
        """Adds an area.

        Args:
            rings: Closed polygons (N, 2) [m]; an edge joins the last corner to the first.
            is_even_odd: Whether a point is inside if the rings enclose it an odd number of times, otherwise if they wind
                around it, counted with their direction. These are the two fill rules of SVG.
        """
        edges = np.concatenate([_closed(self._ticks(ring)) for ring in rings])
        first = edges.min(axis=0).reshape(2, 2).min(axis=0) // _CELL
        last = -(-edges.max(axis=0).reshape(2, 2).max(axis=0) // _CELL)
        edges -= np.tile(first * _CELL, 2)
        width, height = last - first
        winding = _winding((height, width), edges)
        block = self._occupied[first[1] : last[1], first[0] : last[0]]
        block |= _crossed((height, width), edges) | (winding & 1 != 0 if is_even_odd else winding != 0)

    def add_outside(self, ring: _Points) -> None:
        """Adds everything outside of a closed polygon.

        Args:
            ring: Corners (N, 2) of the polygon [m]. A point is inside if it is enclosed an odd number of times.
        """
        edges = _closed(self._ticks(ring))
        self._occupied |= _crossed(self._occupied.shape, edges) | (_winding(self._occupied.shape, edges) & 1 == 0)

    def add_walls(self, lines: Iterable[_Points]) -> None:
        """Adds walls.

        Args:
            lines: Polylines (N, 2) of at least one point [m]. A single point is a wall too.
        """
        edges = [_open(self._ticks(line) + 1) for line in lines]
        if edges:
            self._occupied |= _crossed(self._occupied.shape, np.concatenate(edges))

    def add_disc(self, centre: Sequence[float], radius: float) -> None:
        """Adds a disc: the cells that are nearer to its centre than its radius, computed in float64.

        Args:
            centre: Its centre (x, y) [m].
            radius: Its radius [m]. It must lie in the rectangle of the grid.
        """
        middle = np.asarray(centre, np.float64) / self._resolution - self._first
        reach = radius / self._resolution
        low, high = np.floor(middle - reach).astype(int), np.ceil(middle + reach).astype(int)
        cols, rows = np.arange(low[0], high[0]), np.arange(low[1], high[1])[:, None]
        near = np.hypot(_gaps(cols, middle[0]), _gaps(rows, middle[1])) < reach - 1e-9
        self._occupied[low[1] : high[1], low[0] : high[0]] |= near

    def cell_map(self) -> CellMap:
        """Returns what has been drawn: 100 in occupied cells, 0 in free ones."""
        x, y = (float(first) * self._resolution for first in self._first)
        return CellMap(self._occupied.view(np.int8) * np.int8(100), self._resolution, (x, y, 0.0))

    def _ticks(self, points: _Points) -> _Ticks:
        """Returns points (N, 2) in ticks from the lower-left corner of the grid. All are even."""
        rounded = np.rint(points / self._resolution * (_CELL // 2)).astype(np.int64)
        return 2 * rounded - self._first.astype(np.int64) * _CELL


def _gaps(cells: NDArray[np.int_], at: float) -> NDArray[np.float64]:
    """Returns the distance of each cell from a coordinate along one axis, 0 in the cell itself [cells]."""
    gaps: NDArray[np.float64] = np.maximum(np.maximum(cells - at, at - cells - 1), 0)
    return gaps


def _open(points: _Ticks) -> _Ticks:
    """Returns the edges (N, 4) of a polyline: x and y of both ends. A single point is an edge of length 0."""
    return np.hstack([points[:-1], points[1:]] if len(points) > 1 else [points, points])


def _closed(points: _Ticks) -> _Ticks:
    """Returns the edges (N, 4) of a polygon."""
    return np.hstack([points, np.roll(points, -1, axis=0)])


def _crossed(shape: tuple[int, ...], edges: _Ticks) -> NDArray[np.bool_]:
    """Returns whether an edge passes through the interior of each cell (H, W)."""
    x0, y0, x1, y1 = np.where(edges[:, 1:2] <= edges[:, 3:4], edges, edges[:, [2, 3, 0, 1]]).T
    # An edge in one row of cells, or between two of them.
    level = y0 == y1
    rows = y0[level] // _CELL
    low, high = np.minimum(x0, x1)[level], np.maximum(x0, x1)[level]
    spans = [(rows, low // _CELL, np.where(y0[level] % _CELL, -(-high // _CELL), 0))]
    # Other edges: the piece in each row that they cross, from lower to upper. x = (x0 dy + dx (y - y0)) / dy.
    x0, y0, x1, y1 = x0[~level], y0[~level], x1[~level], y1[~level]
    edge, rows = _rows(y0 // _CELL, -(-y1 // _CELL))
    x0, y0, dx, y1 = x0[edge], y0[edge], (x1 - x0)[edge], y1[edge]
    dy = y1 - y0
    lower = x0 * dy + dx * (np.maximum(y0, rows * _CELL) - y0)
    upper = x0 * dy + dx * (np.minimum(y1, (rows + 1) * _CELL) - y0)
    step = dy * _CELL
    spans.append((rows, np.minimum(lower, upper) // step, -(-np.maximum(lower, upper) // step)))
    rows, first, last = (np.concatenate(parts) for parts in zip(*spans, strict=True))
    is_used = first < last
    return _sums(shape, [(rows[is_used], first[is_used], 1), (rows[is_used], last[is_used], -1)]) > 0


def _winding(shape: tuple[int, ...], edges: _Ticks) -> NDArray[np.int32]:
    """Returns how often closed edges wind around the centre of each cell (H, W), if none runs through its interior."""
    x0, y0, x1, y1 = edges.T
    half = _CELL // 2
    below, above = np.minimum(y0, y1), np.maximum(y0, y1)
    edge, rows = _rows(-((half - below) // _CELL), -((half - above) // _CELL))
    # Where the edge crosses the line through the centres of a row, as above, and the first centre to its right.
    dy = (y1 - y0)[edge]
    crossing = x0[edge] * dy + (x1 - x0)[edge] * (rows * _CELL + half - y0[edge])
    sign = np.sign(dy)
    step = np.abs(dy) * _CELL
    first = -((half * np.abs(dy) - sign * crossing) // step)
    return _sums(shape, [(rows, first, sign)])


def _rows(first: _Ticks, last: _Ticks) -> tuple[_Ticks, _Ticks]:
    """Returns the pairs of an edge and a row, for all rows from its first one up to, but not including, its last one."""
    counts = np.maximum(last - first, 0)
    edge = np.repeat(np.arange(len(counts)), counts)
    return edge, np.arange(len(edge)) + (first - np.cumsum(counts) + counts)[edge]


def _sums(shape: tuple[int, ...], steps: Iterable[tuple[_Ticks, _Ticks, int | _Ticks]]) -> NDArray[np.int32]:
    """Returns (H, W): in each cell, the sum of the steps in its row at this cell and to its left."""
    height, width = shape
    sums = np.zeros((height, width + 1), np.int32)
    for rows, cols, values in steps:
        np.add.at(sums.reshape(-1), rows * (width + 1) + cols, np.asarray(values, np.int32))
    return np.cumsum(sums, axis=1, out=sums)[:, :-1]
