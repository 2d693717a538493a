"""grid: cells and their positions in the map frame, free poses, and invalid arguments."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mobile_robot_simulator as mrs
import reference

PI = math.pi
CELLS = np.array([[0, 100, -1], [59, 60, 1]], np.int8)
DRAWS = 2000


def test_a_grid_keeps_its_arguments() -> None:
    grid = mrs.OccupancyGrid(CELLS, resolution=0.05, origin=(1.0, -2.0, 0.3), occupied_threshold=70, unknown="occupied")
    assert grid.cells.dtype == np.int8
    assert np.array_equal(grid.cells, CELLS)
    assert grid.shape == (2, 3)
    assert grid.resolution == 0.05
    assert grid.origin == mrs.Pose(1.0, -2.0, 0.3)
    assert grid.occupied_threshold == 70
    assert grid.unknown == "occupied"


def test_defaults() -> None:
    grid = mrs.OccupancyGrid(CELLS, resolution=1.0)
    assert (grid.origin, grid.occupied_threshold, grid.unknown) == (mrs.Pose(), 60, "free")


def test_cells_are_copied_and_read_only() -> None:
    cells = CELLS.copy()
    grid = mrs.OccupancyGrid(cells, resolution=1.0)
    cells[:] = 100
    assert np.array_equal(grid.cells, CELLS)
    with pytest.raises(ValueError, match="read-only"):
        grid.cells[0, 0] = 1


@pytest.mark.parametrize(
    "view", [np.asfortranarray, lambda cells: cells[::-1, ::-1], lambda cells: np.repeat(cells, 2, 1)[:, ::2]]
)
def test_every_memory_layout_is_accepted(view: Any) -> None:
    cells = view(CELLS)
    assert np.array_equal(mrs.OccupancyGrid(cells, resolution=1.0).cells, cells)


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda grid: pickle.loads(pickle.dumps(grid))])
def test_copies_equal_the_grid(duplicate: Any) -> None:
    grid = mrs.OccupancyGrid(CELLS, resolution=0.1, origin=(1.0, 2.0, 0.3), occupied_threshold=10, unknown="occupied")
    other = duplicate(grid)
    assert np.array_equal(other.cells, grid.cells)
    for name in ("shape", "resolution", "origin", "occupied_threshold", "unknown"):
        assert getattr(other, name) == getattr(grid, name)
    rays = np.random.default_rng(1).uniform(0.0, 3.0, (100, 3))
    assert np.array_equal(mrs.cast_rays(other, rays, 5.0), mrs.cast_rays(grid, rays, 5.0))


def test_repr_shows_size_and_options() -> None:
    grid = mrs.OccupancyGrid(CELLS, resolution=0.05, origin=(1.0, -2.0, 0.3), occupied_threshold=70, unknown="occupied")
    assert repr(grid) == (
        "OccupancyGrid(3x2 cells, 0.05 m, origin=(1.0, -2.0, 0.3), occupied_threshold=70, unknown='occupied')"
    )


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (3.0, -4.0, 0.0), (1.0, 2.0, PI / 2), (-1.0, 0.5, -2.2)])
def test_the_centre_of_every_cell_is_in_the_cell(origin: tuple[float, float, float]) -> None:
    grid = mrs.OccupancyGrid(CELLS, resolution=0.25, origin=origin)
    for row in range(2):
        for col in range(3):
            x, y = grid.center(row, col)
            expected = mrs.Pose(*origin) * mrs.Pose((col + 0.5) * 0.25, (row + 0.5) * 0.25)
            assert (x, y) == pytest.approx((expected.x, expected.y), abs=1e-12)
            assert grid.cell_at(x, y) == (row, col)


@pytest.mark.parametrize(
    ("x", "y", "cell"),
    [
        (0.0, 0.0, (0, 0)),
        (1.0, 0.0, (0, 1)),
        (0.0, 1.0, (1, 0)),
        (2.999, 1.999, (1, 2)),
        (3.0, 0.0, None),
        (0.0, 2.0, None),
        (-1e-9, 0.0, None),
        (math.nan, 0.0, None),
        (math.inf, 0.0, None),
        (1e308, -1e308, None),
    ],
)
def test_a_cell_includes_its_lower_and_left_boundary(x: float, y: float, cell: tuple[int, int] | None) -> None:
    assert mrs.OccupancyGrid(CELLS, resolution=1.0).cell_at(x, y) == cell


@pytest.mark.parametrize(
    ("x", "y", "radius", "free"),
    [
        (0.5, 2.5, 1.5, True),
        (0.5, 2.5, 1.5 + 2**-40, False),
        (1.0, 1.0, math.sqrt(2.0) - 1e-12, True),
        (1.0, 1.0, math.sqrt(2.0) + 1e-12, False),
        (2.5, 2.5, 0.0, False),
        (2.0, 2.0, 0.0, False),
        (3.0, 2.5, 0.0, True),
        (-5.0, 2.5, 7.0, True),
        (-5.0, 2.5, 7.001, False),
        (1e300, 0.0, 1.0, True),
        (2.5, 9.0, 1e6, False),
    ],
)
def test_free_discs(post: mrs.OccupancyGrid, x: float, y: float, radius: float, free: bool) -> None:
    assert post.is_free_disc(x, y, radius) is free


@pytest.mark.parametrize(
    ("x", "y", "radius"), [(math.nan, 0.0, 0.1), (0.0, math.inf, 0.1), (0.0, 0.0, math.nan), (0.0, 0.0, -1.0)]
)
def test_invalid_discs_are_rejected(post: mrs.OccupancyGrid, x: float, y: float, radius: float) -> None:
    with pytest.raises(ValueError, match="must be"):
        post.is_free_disc(x, y, radius)


def test_drawn_poses_are_free_repeatable_and_spread() -> None:
    cells = np.zeros((6, 8), np.int8)
    cells[2:4, 3:5] = 100
    cells[:, 0] = -1
    grid = mrs.OccupancyGrid(cells, resolution=1.0, origin=(5.0, 5.0, 0.4))
    drawn = [grid.draw_free_pose(radius=0.2, seed=seed) for seed in range(DRAWS)]
    assert drawn == [grid.draw_free_pose(radius=0.2, seed=seed) for seed in range(DRAWS)]
    assert all(grid.is_free_disc(pose.x, pose.y, 0.2) and -PI <= pose.yaw <= PI for pose in drawn)
    places = [grid.cell_at(pose.x, pose.y) for pose in drawn]
    assert set(places) == {(row, col) for row in range(6) for col in range(1, 8) if cells[row, col] == 0}
    # 38 cells with 52.6 draws each on average; the bounds are 7 standard deviations of 7.2.
    counts = [places.count(place) for place in set(places)]
    assert 3 <= min(counts) and max(counts) <= 103
    assert abs(np.mean([pose.yaw for pose in drawn])) < 7 * 2 * PI / math.sqrt(12 * DRAWS)


def test_many_drawn_poses_are_the_same_for_any_split_and_number_of_threads(post: mrs.OccupancyGrid) -> None:
    whole = post.draw_free_poses(5000, radius=0.1, seed=3)
    assert whole.shape == (5000, 3) and whole.dtype == np.float64
    assert all(post.is_free_disc(x, y, 0.1) for x, y, _ in whole)
    assert tuple(whole[0]) == tuple(post.draw_free_pose(radius=0.1, seed=3))
    for threads in (1, 3):
        parts = [
            post.draw_free_poses(end - start, radius=0.1, seed=3, first_index=start, threads=threads)
            for start, end in ((0, 1), (1, 1), (1, 4000), (4000, 5000))
        ]
        assert np.concatenate(parts).tobytes() == whole.tobytes()
    out = np.full((5000, 3), np.nan)
    assert post.draw_free_poses(5000, radius=0.1, seed=3, out=out) is out and out.tobytes() == whole.tobytes()


def test_the_error_of_a_disc_that_fits_nowhere_names_the_largest_one(post: mrs.OccupancyGrid) -> None:
    for draw in (lambda: post.draw_free_pose(radius=50.0, seed=1), lambda: post.draw_free_poses(2, radius=50.0, seed=1)):
        with pytest.raises(ValueError, match="radius 50 m on this grid, where the largest that fits has a radius of"):
            draw()
    with pytest.raises(ValueError, match="n must be"):
        post.draw_free_poses(-1, radius=0.1, seed=1)
    with pytest.raises(ValueError, match=r"out must have shape \(2, 3\), got \(3, 3\)"):
        post.draw_free_poses(2, radius=0.1, seed=1, out=np.zeros((3, 3)))


@pytest.mark.parametrize(
    ("cells", "radius"),
    [(np.full((3, 3), 100, np.int8), 0.0), (np.full((3, 3), -1, np.int8), 0.0), (np.eye(3, dtype=np.int8) * 100, 5.0)],
    ids=["full", "unknown", "narrow"],
)
def test_no_free_place_is_an_error(cells: Any, radius: float) -> None:
    with pytest.raises(ValueError, match="free place"):
        mrs.OccupancyGrid(cells, resolution=1.0).draw_free_pose(radius=radius, seed=1)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"radius": -0.1, "seed": 1}, ValueError, "radius must be"),
        ({"radius": math.nan, "seed": 1}, ValueError, "radius must be"),
        ({"radius": 0.1, "seed": -1}, ValueError, "seed must be in 0..2**64 - 1, got -1"),
        ({"radius": 0.1, "seed": 2**64}, ValueError, f"got {2**64}"),
        ({"radius": 0.1, "seed": 0.5}, TypeError, "seed must be an integer or a RandomStream, got float"),
    ],
)
def test_invalid_draws_are_rejected(
    post: mrs.OccupancyGrid, arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as caught:
        post.draw_free_pose(**arguments)
    assert message in reference.message_of(caught.value)


def with_value(value: int) -> Any:
    cells = np.zeros((2, 3), np.int8)
    cells[1, 2] = value
    return cells


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"cells": with_value(101)}, ValueError, "cells must be in -1..100, got 101 at row 1, column 2"),
        ({"cells": with_value(-2)}, ValueError, "cells must be in -1..100, got -2 at row 1, column 2"),
        ({"cells": with_value(-128)}, ValueError, "got -128"),
        ({"cells": np.zeros((0, 3), np.int8)}, ValueError, "cells must be at least 1, got 0"),
        ({"cells": np.zeros((3, 0), np.int8)}, ValueError, "cells must be at least 1, got 0"),
        ({"cells": np.zeros(3, np.int8)}, ValueError, "cells must have shape (H, W), got (3,)"),
        ({"cells": np.zeros((1, 2, 3), np.int8)}, ValueError, "cells must have shape (H, W), got (1, 2, 3)"),
        ({"cells": np.zeros((2, 3))}, TypeError, "cells must have dtype int8, got float64"),
        ({"cells": np.zeros((2, 3), np.uint8)}, TypeError, "cells must have dtype int8, got uint8"),
        ({"cells": np.zeros((2, 3), bool)}, TypeError, "cells must have dtype int8, got bool"),
        ({"cells": [[0, 0]]}, TypeError, "cells must have dtype int8, got int64"),
        ({"cells": np.zeros((1, 65_536), np.int8)}, ValueError, "at most 65535 cells, got 65536"),
        ({"cells": np.zeros((65_536, 1), np.int8)}, ValueError, "at most 65535 cells, got 65536"),
        ({"resolution": 0.0}, ValueError, "resolution must be positive, got 0"),
        ({"resolution": -0.05}, ValueError, "resolution must be positive, got -0.05"),
        ({"resolution": math.nan}, ValueError, "resolution must be positive, got NaN"),
        ({"resolution": math.inf}, ValueError, "resolution must be"),
        ({"resolution": "0.05"}, TypeError, "resolution"),
        ({"resolution": None}, TypeError, "resolution"),
        ({"origin": (0.0, math.nan, 0.0)}, ValueError, "origin"),
        ({"origin": (0.0, 0.0, math.inf)}, ValueError, "origin"),
        ({"origin": (0.0, 0.0)}, ValueError, "three numbers (x, y, yaw), got tuple: (0.0, 0.0)"),
        ({"origin": 5}, TypeError, "three numbers (x, y, yaw), got int: 5"),
        ({"occupied_threshold": 0}, ValueError, "occupied_threshold must be in 1..100, got 0"),
        ({"occupied_threshold": -1}, ValueError, "occupied_threshold must be in 1..100, got -1"),
        ({"occupied_threshold": 101}, ValueError, "occupied_threshold must be in 1..100, got 101"),
        ({"occupied_threshold": 300}, ValueError, "occupied_threshold must be in 1..100, got 300"),
        ({"occupied_threshold": 0.65}, TypeError, "occupied_threshold must be an integer, got float"),
        ({"unknown": "maybe"}, ValueError, "unknown must be 'free' or 'occupied', got 'maybe'"),
        ({"unknown": None}, TypeError, "unknown"),
    ],
)
def test_invalid_input_is_rejected(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    given = {"cells": CELLS, "resolution": 1.0, **arguments}
    with pytest.raises(error) as caught:
        mrs.OccupancyGrid(given.pop("cells"), **given)
    assert message in reference.message_of(caught.value)


def test_options_are_keyword_only() -> None:
    with pytest.raises(TypeError):
        mrs.OccupancyGrid(CELLS, 0.05)  # type: ignore[misc]


anything = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=3),
    st.lists(st.floats(), max_size=4),
    st.binary(max_size=3),
)


@given(anything, anything, anything, anything)
def test_no_argument_causes_a_panic(resolution: Any, origin: Any, threshold: Any, unknown: Any) -> None:
    for options in ({"resolution": resolution}, {"origin": origin}, {"occupied_threshold": threshold}, {"unknown": unknown}):
        try:
            grid = mrs.OccupancyGrid(CELLS, **{"resolution": 0.5, **options})
        except (ValueError, TypeError):
            continue
        assert np.isfinite(mrs.cast_rays(grid, np.array([[0.1, 0.1, 0.1]]), 9.0)).all()


@given(st.integers(-(2**70), 2**70), st.integers(-(2**70), 2**70))
def test_no_cell_index_causes_a_panic(row: int, col: int) -> None:
    try:
        center = mrs.OccupancyGrid(CELLS, resolution=1.0).center(row, col)
    except (ValueError, TypeError, IndexError):
        return
    assert 0 <= row < 2 and 0 <= col < 3 and center == (col + 0.5, row + 0.5)


def test_cells_cannot_be_made_writeable():
    grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
    for array in (grid.cells, grid.cells[0], grid.cells.base):
        with pytest.raises(ValueError, match="cannot set WRITEABLE"):
            array.flags.writeable = True


def slanted_half_plane(angle: float, size: int = 41) -> mrs.OccupancyGrid:
    """A grid whose cells block on the left of a line through its middle, at an angle to the x axis."""
    y, x = np.mgrid[0:size, 0:size] + 0.5 - size / 2
    return mrs.OccupancyGrid((100 * (y * math.cos(angle) - x * math.sin(angle) > 0.0)).astype(np.int8), resolution=0.05)


def test_wall_directions_are_those_of_known_walls() -> None:
    errors = []
    for angle in np.linspace(0.0, PI, 200, endpoint=False):
        directions = slanted_half_plane(float(angle)).wall_directions()
        middle = directions[14:27, 14:27]
        found = middle[np.isfinite(middle)]
        errors += [abs((direction - angle + PI / 2) % PI - PI / 2) for direction in found.tolist()]
    assert len(errors) > 2000
    median, most = np.degrees(np.percentile(errors, [50, 95]))
    assert median < 1.0 and most < 4.0 and np.degrees(max(errors)) < 9.0


def test_wall_directions_follow_changes_and_are_the_same_for_any_threads() -> None:
    grid = mrs.floor_plan("office", seed=1)
    before = grid.wall_directions(threads=1)
    assert grid.wall_directions().tobytes() == before.tobytes()
    assert np.isnan(before[grid.cells < 60]).all() and np.isfinite(before).any()
    patch = np.full((5, 9), 100, np.int8)
    grid.set_cells(20, 30, patch)
    cells = grid.cells
    again = mrs.OccupancyGrid(cells, resolution=grid.resolution, origin=grid.origin)
    out = np.empty(grid.shape, np.float32)
    assert grid.wall_directions(out=out) is out
    assert out.tobytes() == again.wall_directions(threads=2).tobytes() != before.tobytes()
    with pytest.raises(ValueError, match="out must have shape"):
        grid.wall_directions(out=np.empty((2, 3), np.float32))
    with pytest.raises(ValueError, match="threads must be"):
        grid.wall_directions(threads=0)


def test_a_revision_counts_changes_of_the_cells() -> None:
    grid = mrs.OccupancyGrid(np.zeros((3, 4), np.int8), resolution=1.0)
    scan = mrs.LaserScanner(beam_count=1).scan(grid, (0.5, 0.5, 0.0))  # A table that is built is no change.
    before = grid.revision
    grid.set_cells(0, 2, np.array([[100]], np.int8))
    with pytest.raises(ValueError, match="must fit on the grid"):
        grid.set_cells(0, 9, np.array([[100]], np.int8))
    assert (before, grid.revision) == (0, 1) and scan > 2.0
