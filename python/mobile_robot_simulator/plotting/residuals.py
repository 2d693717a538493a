"""ResidualPicture: where on a map measured ranges differ from simulated ones."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from .._core import OccupancyGrid
from .layers import draw_cells
from .picture import Picture
from .style import FAINT, FARTHER, NEARER
from .view import Points, finite_rows, view_of

_MOST_POINTS = 30_000  # of each kind
_MARGIN = 2.0  # of the view around the path [m]
_SHARE = 1.0  # share of the ends that may lie beyond each side of the view [%]


class ResidualPicture(Picture):
    """A picture of where real beams ended, by whether that is nearer or farther than simulated.

    Args:
        grid: The map.
        path: Poses of the scanner in the map frame, (N, 2) or (N, 3) float64 with N >= 1: x, y [m] and yaw [rad].
        ends: Where beams ended in the map frame [m], (M, 2) float64.
        residuals: (M,) measured ranges less simulated ones [m].
        limit: Residuals up to this size are right [m].
        title: Title above the axes.

    Raises:
        ValueError: An array has a wrong shape or a number that is not finite, or the path is empty.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        path: Points,
        ends: Points,
        residuals: NDArray[np.floating],
        *,
        limit: float = 0.1,
        title: str | None = None,
    ) -> None:
        self._grid, self._limit, self.title = grid, limit, title
        self._path, self._ends = finite_rows("path", path, (2, 3)), finite_rows("ends", ends, (2,))
        self._residuals = np.asarray(residuals, np.float64)
        if not len(self._path):
            raise ValueError("path must have at least one row, got none")
        if self._residuals.shape != (len(self._ends),) or not np.isfinite(self._residuals).all():
            raise ValueError(f"residuals must be finite numbers, one for each of {len(self._ends)} ends")

    def view(self) -> Points:
        """Returns the corners of an area with the path and nearly all ends, (2, 2). A few may be far away."""
        path = self._path[:, :2]
        seen = [path - _MARGIN, path + _MARGIN]
        if len(self._ends):
            seen.append(np.percentile(self._ends, [_SHARE, 100.0 - _SHARE], axis=0))
        return view_of(np.vstack(seen), margin=0.05)

    def draw(self, axes: Axes) -> None:
        """Draws the map, the path, and a dot where each beam ended. Of very many, dots at equal distances in time."""
        draw_cells(axes, self._grid)
        axes.plot(*self._path[:, :2].T, color=FAINT, lw=1.0, zorder=3, label="path")
        kinds = (
            (np.abs(self._residuals) <= self._limit, FAINT, f"within {self._limit:g} m", 0.8),
            (self._residuals > self._limit, FARTHER, "farther than simulated", 1.6),
            (self._residuals < -self._limit, NEARER, "nearer than simulated", 1.6),
        )
        for order, (is_kind, colour, label, size) in enumerate(kinds):
            ends = self._ends[is_kind]
            ends = ends[:: max(1, -(-len(ends) // _MOST_POINTS))]
            axes.plot(*ends.T, "o", ms=size, mec="none", mfc=colour, zorder=4 + order, rasterized=True)
            axes.plot([], [], "o", ms=5, mec="none", mfc=colour, label=label)
