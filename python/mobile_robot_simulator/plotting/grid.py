"""GridPicture: a whole occupancy grid."""

from __future__ import annotations

from matplotlib.axes import Axes

from .._core import OccupancyGrid
from .layers import draw_cells
from .picture import Picture
from .view import Points, grid_corners, view_of


class GridPicture(Picture):
    """A picture of a whole grid.

    Args:
        grid: Grid to draw. If it has more cells than the axes have pixels, it is down-sampled. Thin walls stay visible.
    """

    def __init__(self, grid: OccupancyGrid) -> None:
        self._grid = grid

    def view(self) -> Points:
        """Returns the corners of the grid with a small margin, (2, 2)."""
        return view_of(grid_corners(self._grid), margin=0.02)

    def draw(self, axes: Axes) -> None:
        """Draws the cells."""
        draw_cells(axes, self._grid)


def plot_grid(grid: OccupancyGrid, ax: Axes | None = None) -> Axes:
    """Draws a whole grid in Matplotlib axes and returns the axes. `OccupancyGrid.plot` calls this.

    Args:
        grid: Grid to draw. If it has more cells than the axes have pixels, it is down-sampled. Thin walls stay visible.
        ax: Axes to draw in. None opens a new pyplot figure.
    """
    return GridPicture(grid).plot(ax)


def grid_png(grid: OccupancyGrid) -> bytes:
    """Returns a PNG image of a whole grid, at most about 800 pixels a side. Notebooks show it for a grid."""
    return GridPicture(grid).to_png()
