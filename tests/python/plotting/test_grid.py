"""Pictures of a grid: in axes of Matplotlib, and in notebooks."""

from __future__ import annotations

import io
import subprocess
import sys
import time

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

import mobile_robot_simulator as mrs

CELLS = np.array([[0, 100, 0, -1], [100, 0, 0, 0], [0, 0, 100, 100]], np.int8)
SHADES = {0: (255, 255, 255), 100: (38, 42, 51), -1: (226, 229, 233)}


def colour(axes: Axes, x: float, y: float) -> tuple[int, ...]:
    """The colour drawn at a point of the map frame."""
    assert isinstance(axes.figure, Figure)
    canvas = FigureCanvasAgg(axes.figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    col, row = axes.transData.transform((x, y))
    return tuple(int(value) for value in pixels[len(pixels) - 1 - int(row), int(col), :3])


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (10.0, -4.0, 0.7)])
def test_every_cell_is_drawn_in_place(origin: tuple[float, float, float]) -> None:
    grid = mrs.OccupancyGrid(CELLS, resolution=2.0, origin=origin)
    axes = Figure().add_subplot()
    assert grid.plot(axes) is axes
    for (row, col), value in np.ndenumerate(CELLS):
        assert colour(axes, *grid.center(row, col)) == SHADES[int(value)], (row, col)


def test_the_axes_show_the_whole_grid_in_metres() -> None:
    axes = mrs.OccupancyGrid(CELLS, resolution=2.0, origin=(10.0, -4.0, 0.0)).plot(Figure().add_subplot())
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    assert left < 10.0 < 18.0 < right and bottom < -4.0 < 2.0 < top
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_aspect()) == ("x [m]", "y [m]", 1.0)


def test_without_axes_a_pyplot_figure_opens(agg: None) -> None:
    assert mrs.OccupancyGrid(CELLS, resolution=2.0).plot() is pyplot.gca()


def test_a_notebook_shows_a_png_image() -> None:
    grid = mrs.OccupancyGrid(CELLS, resolution=2.0)
    image = grid._repr_png_()
    assert image is not None and image == grid._repr_png_()
    picture = np.asarray(Image.open(io.BytesIO(image)).convert("RGB"))
    assert max(picture.shape) < 900
    assert {SHADES[0], SHADES[100], SHADES[-1]} <= {tuple(map(int, pixel)) for pixel in picture.reshape(-1, 3)}


def test_a_large_map_is_drawn_quickly_and_keeps_its_thin_walls() -> None:
    cells = np.zeros((8000, 8000), np.int8)
    cells[4000, :] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.05)
    start = time.perf_counter()
    image = grid._repr_png_()
    assert time.perf_counter() - start < 10.0
    assert image is not None
    grey = np.asarray(Image.open(io.BytesIO(image)).convert("L"))
    middle = grey[:, grey.shape[1] // 2]
    assert middle[len(middle) // 4 : 3 * len(middle) // 4].min() < 120


def test_without_matplotlib_a_notebook_shows_the_repr() -> None:
    script = """
import sys
sys.modules["matplotlib"] = None
import numpy as np, mobile_robot_simulator as mrs
grid = mrs.OccupancyGrid(np.zeros((2, 2), np.int8), resolution=1.0)
assert grid._repr_png_() is None
try:
    grid.plot()
except ImportError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=60)
    assert "pip install 'mobile-robot-simulator[plotting]'" in run.stdout
