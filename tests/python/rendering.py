"""Pictures rendered to pixels, for the tests of plotting."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from mobile_robot_simulator import OccupancyGrid
from mobile_robot_simulator.plotting import Picture, style

ROBOT, GOAL, SCAN, SHAPE = (
    tuple(round(255 * share) for share in to_rgb(name)) for name in (style.ROBOT, style.GOAL, style.SCAN, style.SHAPE)
)
PATH = np.column_stack([np.linspace(1.0, 4.0, 50), np.linspace(1.0, 2.0, 50), np.zeros(50)])
HITS = np.array([[4.5, 2.0], [4.5, 2.5], [4.0, 3.0]])


def room(size: int = 100, **options: Any) -> OccupancyGrid:
    """A square room of free cells with walls, surrounded by unknown cells."""
    cells = np.full((size, size), -1, np.int8)
    cells[10:-10, 10:-10] = 100
    cells[12:-12, 12:-12] = 0
    return OccupancyGrid(cells, resolution=0.05, **options)


class Rendered:
    """The pixels of a picture. A call returns the colour at a point of the map frame."""

    def __init__(self, picture: Picture) -> None:
        figure = picture.to_figure()
        canvas = FigureCanvasAgg(figure)
        canvas.draw()  # type: ignore[no-untyped-call]
        self.axes: Axes = figure.axes[0]
        self.pixels: NDArray[np.uint8] = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]

    def __call__(self, x: float, y: float) -> tuple[int, ...]:
        col, row = self.axes.transData.transform((x, y))
        return tuple(int(value) for value in self.pixels[len(self.pixels) - 1 - int(row), int(col), :3])

    @property
    def view(self) -> tuple[float, ...]:
        """Limits of x, then of y, in the map frame."""
        return tuple(round(float(value), 2) for value in (*self.axes.get_xlim(), *self.axes.get_ylim()))
