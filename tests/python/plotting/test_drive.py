"""DrivePicture: everything is drawn at its place in the map, and the view contains all of it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.figure import Figure

from mobile_robot_simulator import OccupancyGrid, Pose, Shape
from mobile_robot_simulator.plotting import DrivePicture, layers, style
from rendering import GOAL, HITS, PATH, ROBOT, SCAN, SHAPE, Rendered, room

# --- Where things are drawn ---


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (-3.0, 7.5, 0.0), (10.0, -4.0, 0.7), (1.0, 2.0, -2.0)])
def test_every_cell_is_drawn_in_place(origin: tuple[float, float, float]) -> None:
    cells = np.array([[0, 100, 0, -1], [100, 0, 0, 0], [0, 0, 100, 100]], np.int8)
    grid = OccupancyGrid(cells, resolution=2.0, origin=origin)
    # The path must not cover a cell's centre.
    corner = Pose(*origin) * Pose(0.05, 0.05)
    drawn = Rendered(DrivePicture(grid, np.array([[corner.x, corner.y]])))
    for (row, col), value in np.ndenumerate(cells):
        if (row, col) != (0, 0):
            expected = {0: style.FREE, 100: style.OCCUPIED, -1: style.UNKNOWN}[int(value)]
            assert drawn(*grid.center(row, col)) == expected, (row, col)


def test_shades_between_free_and_occupied() -> None:
    cells = np.array([[0, 25, 50, 75, 100]], np.int8)
    grid = OccupancyGrid(cells, resolution=1.0)
    drawn = Rendered(DrivePicture(grid, np.array([[0.1, 0.1]])))
    shades = [drawn(col + 0.5, 0.8)[0] for col in range(5)]
    assert shades == sorted(shades, reverse=True) and len(set(shades)) == 5


def test_a_single_occupied_cell_is_visible_on_a_large_map() -> None:
    cells = np.zeros((4000, 6000), np.int8)
    cells[2345, 4321] = 100
    grid = OccupancyGrid(cells, resolution=0.01)
    drawn = Rendered(DrivePicture(grid, np.array([[30.0, 10.0], [55.0, 12.0]])))
    # Rounding decides which of the nearby pixels it colours.
    x, y = grid.center(2345, 4321)
    assert min(drawn(x + dx, y + dy)[0] for dx in (-0.05, 0.0, 0.05) for dy in (-0.05, 0.0, 0.05)) < 160


def test_path_scan_robot_and_goal_are_drawn_in_place() -> None:
    path = np.array([[1.0, 1.0, 0.0], [2.5, 1.0, 0.0], [2.5, 2.5, 0.5]])
    drawn = Rendered(
        DrivePicture(room(), path, scan_points=HITS, laser_pose=(2.5, 2.5, 0.5), goal=(1.5, 3.0), title="Office")
    )
    assert drawn(2.5, 2.5) == ROBOT
    assert drawn(1.5, 3.0) == GOAL
    assert drawn(1.0, 1.0) == (255, 255, 255)  # the start is a ring
    assert all(drawn(*hit) == SCAN for hit in HITS)
    red, green, blue = drawn(1.75, 1.0)  # the first of the path's two segments is blue
    assert blue > 120 > max(red, green)
    red, green, blue = drawn(3.25, 2.75)  # a beam tints the floor
    assert red > 240 and 150 < green < 250 and 150 < blue < 250
    assert drawn(1.75, 1.75) == style.FREE
    assert drawn.axes.get_title(loc="left") == "Office"
    assert [text.get_text() for text in drawn.axes.texts] == []


def test_the_arrow_points_along_the_heading() -> None:
    for yaw in (0.0, math.pi / 2, 2.5):
        drawn = Rendered(DrivePicture(room(), np.array([[1.0, 1.0, 0.0], [2.5, 2.5, yaw]])))
        along = np.linspace(-0.1, 0.1, 201)
        blue = [d for d in along if drawn(2.5 + d * math.cos(yaw), 2.5 + d * math.sin(yaw)) == ROBOT]
        assert max(blue) > -1.5 * min(blue) > 0


# --- The view ---


def test_the_view_contains_the_known_cells() -> None:
    drawn = Rendered(DrivePicture(room(), PATH))
    assert drawn.view == (0.42, 4.58, 0.42, 4.58)


def test_the_view_contains_a_path_off_the_map() -> None:
    drawn = Rendered(DrivePicture(room(), np.array([[-8.0, 2.0], [2.0, 2.0]])))
    assert drawn.view[0] < -8.0


def test_the_view_stays_near_a_short_drive_on_a_large_map() -> None:
    grid = OccupancyGrid(np.zeros((4000, 4000), np.int8), resolution=0.05)
    drawn = Rendered(DrivePicture(grid, 100.0 + PATH))
    low_x, high_x, low_y, high_y = drawn.view
    assert 80 < low_x < 100 < high_x < 120 and 80 < low_y < 100 < high_y < 120


def test_x_and_y_have_the_same_scale() -> None:
    for grid in (room(), OccupancyGrid(np.zeros((3, 4000), np.int8), resolution=0.05)):
        drawn = Rendered(DrivePicture(grid, np.array([[1.0, 0.1], [190.0, 0.1]])))
        origin, x, y = drawn.axes.transData.transform([(0, 0), (1, 0), (0, 1)])
        assert x[0] - origin[0] == pytest.approx(y[1] - origin[1])
        height, width = drawn.pixels.shape[:2]
        assert height < 2000 and width < 2000


def test_other_robots_and_shapes_are_drawn_in_place() -> None:
    other = np.column_stack([np.full(20, 1.5), np.linspace(3.0, 4.0, 20), np.zeros(20)])
    disc, box = Shape.disc(0.2), Shape.rectangle(0.6, 0.2)
    shapes = [(disc, Pose(3.5, 3.5, 0.0)), (box, Pose(2.5, 3.5, math.pi / 2))]
    drawn = Rendered(DrivePicture(room(), PATH, name="one", others={"two": other}, shapes=shapes))
    assert drawn(1.5, 4.0) == ROBOT and drawn(1.5, 3.4) not in (style.FREE, ROBOT)
    assert {text.get_text(): text.xy for text in drawn.axes.texts} == {"one": tuple(PATH[-1, :2]), "two": (1.5, 4.0)}
    for x, y, filled in ((3.65, 3.5, True), (3.75, 3.5, False), (2.5, 3.75, True), (2.65, 3.5, False)):
        assert drawn(x, y) == (SHAPE if filled else style.FREE)
    assert drawn.axes.get_legend_handles_labels()[1] == ["start", "path", "end"]


def test_the_view_contains_other_robots_and_shapes() -> None:
    drawn = Rendered(
        DrivePicture(room(), PATH, others={"two": np.array([[30.0, 2.0]])}, shapes=[(Shape.disc(1.0), Pose(2.0, -20.0))])
    )
    assert drawn.axes.get_xlim()[1] > 30.0 and drawn.axes.get_ylim()[0] < -21.0


# --- Invalid arguments ---


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"path": np.zeros((0, 3))}, "path must have at least one row"),
        ({"path": np.zeros((5, 4))}, r"path must have shape \(N, 2\) or \(N, 3\), got \(5, 4\)"),
        ({"path": np.full((2, 2), np.nan)}, "path must be finite, got"),
        ({"scan_points": np.zeros((3, 3))}, r"scan_points must have shape \(N, 2\), got \(3, 3\)"),
        ({"scan_points": np.array([[1.0, np.inf]])}, r"scan_points must be finite, got \[ *1\. +inf\]"),
        ({"laser_pose": (0.0, 1.0)}, "laser_pose must have shape"),
        ({"goal": (0.0,)}, "goal must have shape"),
    ],
)
def test_arrays_are_checked(arguments: dict[str, Any], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        DrivePicture(room(), **({"path": PATH} | arguments))


# --- In axes ---


def test_given_axes_show_the_drive_and_keep_their_legend() -> None:
    axes = Figure().add_subplot()
    assert DrivePicture(room(), PATH, goal=(1.0, 3.0), title="Office").plot(axes) is axes
    assert axes.get_legend_handles_labels()[1] == ["start", "path", "end", "goal"] and axes.get_legend() is None
    assert axes.get_title() == "Office" and axes.get_xlim()[0] < 0.5 and axes.get_xlim()[1] > 4.5


def test_without_axes_a_pyplot_figure_opens_with_a_legend(agg: None) -> None:
    axes = DrivePicture(room(), PATH).plot()
    assert axes is pyplot.gca() and axes.get_legend() is not None


# --- Long paths ---


def test_a_long_path_keeps_its_corners() -> None:
    # Ten thousand points wait at the start, then one second of driving visits three corners.
    path = np.vstack(
        [np.full((10_000, 2), 0.5), [(0.5, 0.5), (3.5, 0.5), (3.5, 3.5), (0.5, 3.5)], np.full((10_000, 2), 0.5)]
    )
    drawn = Rendered(DrivePicture(room(), path))
    half_way = 255.0 * np.array(style.TIME(0.5)[:3])
    for x, y in [(2.0, 0.5), (3.5, 1.5), (2.0, 3.5)]:
        assert drawn(x, y) == pytest.approx(half_way, abs=2.0)
    assert drawn(2.0, 2.0) == style.FREE


def test_a_path_is_thinned_where_it_is_straight() -> None:
    line = np.column_stack([np.linspace(0.0, 100.0, 60_001), np.zeros(60_001)])
    wave = line + [0.0, 1.0] * np.sin(line[:, :1])
    assert np.array_equal(layers._shown(line[:7999]), range(7999))
    shown = layers._shown(line)
    assert (shown[0], shown[-1]) == (0, 60_000) and len(shown) == 4001
    shown = layers._shown(wave)
    drawn = np.interp(line[:, 0], *wave[shown].T)
    assert len(shown) < 6000 and np.abs(drawn - wave[:, 1]).max() < 0.1


def test_a_path_that_is_nowhere_straight_is_thinned_in_the_end() -> None:
    noise = np.random.default_rng(1).normal(size=(300_000, 2))
    shown = layers._shown(noise)
    assert 25_000 < len(shown) <= 50_001 and (shown[0], shown[-1]) == (0, 299_999) and (np.diff(shown) > 0).all()
