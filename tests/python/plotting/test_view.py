"""Views: what they contain, and their shape."""

import numpy as np

from mobile_robot_simulator import OccupancyGrid
from mobile_robot_simulator.plotting.view import LONGEST_SIDE, SHORTEST_SIDE, known_corners, view_of


def test_a_view_has_a_margin_and_is_never_a_thin_strip() -> None:
    low, high = view_of(np.array([[0.0, 0.0], [10.0, 0.0]]), margin=0.1)
    assert np.allclose((low[0], high[0]), (-1.0, 11.0))
    assert np.isclose(high[1] - low[1], 10.0 * SHORTEST_SIDE / LONGEST_SIDE)


def test_known_corners_ignore_unknown_cells() -> None:
    cells = np.full((10, 10), -1, np.int8)
    cells[2:4, 5:9] = 0
    grid = OccupancyGrid(cells, resolution=0.5, origin=(1.0, 0.0, 0.0))
    assert known_corners(grid, np.array([[3.0, 1.0]])).tolist() == [[3.5, 1.0], [5.5, 2.0]]
    unknown = OccupancyGrid(np.full((4, 4), -1, np.int8), resolution=0.5)
    assert known_corners(unknown, np.array([[1.0, 1.0]])).tolist() == [[0.0, 0.0], [2.0, 2.0]]
