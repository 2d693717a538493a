"""raycast: the range is the distance to the boundary at which a ray enters the first blocking cell."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
import reference
from map_folders import maps

RAYS_SEED = 20_240_501
WALLS_SEED = 77
PI = math.pi


def grid_of(text: str, **options: Any) -> mrs.OccupancyGrid:
    """A grid from a drawing with the top row first: # blocks, . is free, ? is unknown."""
    rows = [line.strip() for line in text.strip().splitlines()][::-1]
    cells = np.array([[{"#": 100, ".": 0, "?": -1}[cell] for cell in row] for row in rows], np.int8)
    return mrs.OccupancyGrid(cells, **{"resolution": 1.0, **options})


def cast_one(grid: mrs.OccupancyGrid, x: float, y: float, angle: float, max_range: float = 50.0) -> float:
    return float(mrs.cast_rays(grid, np.array([[x, y, angle]]), max_range)[0])


def rays_around(grid: mrs.OccupancyGrid, count: int, seed: int, margin: float = 0.25) -> NDArray[np.float64]:
    """Rays that start on and around a grid. Every eighth ray is parallel to an axis of the grid."""
    rng = np.random.default_rng(seed)
    height, width = grid.shape
    size = np.array([width, height]) * grid.resolution
    local = rng.uniform(-margin, 1.0 + margin, (count, 2)) * size
    angles = rng.uniform(-2.0 * PI, 2.0 * PI, count)
    angles[::8] = grid.origin.yaw + rng.integers(-4, 5, angles[::8].shape) * (PI / 2.0)
    cos, sin = math.cos(grid.origin.yaw), math.sin(grid.origin.yaw)
    x = grid.origin.x + cos * local[:, 0] - sin * local[:, 1]
    y = grid.origin.y + sin * local[:, 0] + cos * local[:, 1]
    return np.column_stack([x, y, angles])


# Ranges derived by hand from the traversal of Amanatides and Woo, on 5x5 cells of 1 m. Only cell (2, 2) blocks.
HAND_DERIVED = [
    (0.5, 2.5, 0.0, 1.5),
    (0.5, 0.5, PI / 4, np.float32(1.5 * math.sqrt(2.0))),
    (2.5, 2.5, 1.0, 0.0),
    (-3.0, 2.5, 0.0, 5.0),
    (-1.0, -1.0, PI / 4, np.float32(3.0 * math.sqrt(2.0))),
    (-3.0, 2.5, PI, 50.0),
    (0.5, 2.0, 0.0, 1.5),
    (0.5, 3.0, 0.0, 50.0),
]


@pytest.mark.parametrize(("x", "y", "angle", "expected"), HAND_DERIVED)
def test_hand_derived_ranges(post: mrs.OccupancyGrid, x: float, y: float, angle: float, expected: float) -> None:
    assert cast_one(post, x, y, angle) == expected


@pytest.mark.parametrize(("x", "y", "angle", "expected"), HAND_DERIVED)
def test_the_reference_gives_the_hand_derived_ranges_too(
    post: mrs.OccupancyGrid, x: float, y: float, angle: float, expected: float
) -> None:
    reference.assert_ranges(np.array([expected], np.float32), reference.cast(post, [(x, y, angle)], 50.0))


def test_the_reference_rejects_wrong_ranges(post: mrs.OccupancyGrid) -> None:
    bounds = reference.cast(post, [(0.5, 2.5, 0.0)], 50.0)
    for wrong in (1.4999, 1.5001, 50.0, math.nan):
        with pytest.raises(AssertionError):
            reference.assert_ranges(np.array([wrong], np.float32), bounds)


@pytest.mark.parametrize(
    ("x", "y", "angle", "expected"),
    [
        # On the lower and left boundary of the post, which belong to the post.
        (2.0, 2.0, 0.0, 0.0),
        (2.0, 2.5, 0.0, 0.0),
        (2.5, 2.0, 1.0, 0.0),
        # On its upper and right boundary, which belong to the neighbours.
        (3.0, 2.5, 0.0, 50.0),
        (2.5, 3.0, PI / 2, 50.0),
        # From the upper and right boundary towards the post.
        (3.0, 2.5, PI, 0.0),
        (2.5, 3.0, -PI / 2, 0.0),
        # Upwards along its left and right boundary.
        (2.0, 0.5, PI / 2, 1.5),
        (3.0, 0.5, PI / 2, 50.0),
        # On the boundary of the grid.
        (0.0, 2.5, 0.0, 2.0),
        (5.0, 2.5, PI, 2.0),
        (2.5, 0.0, PI / 2, 2.0),
        (2.5, 5.0, -PI / 2, 2.0),
        (5.0, 2.5, 0.0, 50.0),
        # Along the boundary, outside the grid.
        (0.5, 5.0, 0.0, 50.0),
        (-1.0, 5.0, 0.0, 50.0),
        (-1.0, 0.0, 0.0, 50.0),
    ],
)
def test_boundaries(post: mrs.OccupancyGrid, x: float, y: float, angle: float, expected: float) -> None:
    assert cast_one(post, x, y, angle) == expected


@pytest.mark.parametrize(("x", "y"), [(2.0, 2.0), (2.0, 2.5), (3.0, 2.5), (0.0, 0.0)])
def test_a_range_is_never_minus_zero(post: mrs.OccupancyGrid, x: float, y: float) -> None:
    ranges = mrs.cast_rays(post, np.array([[x, y, angle] for angle in np.arange(-8, 9) * PI / 8]), 50.0)
    assert not np.signbit(ranges).any()


@pytest.mark.parametrize("angle", [0.0, -0.0])
def test_both_signs_of_zero_give_the_same_range(post: mrs.OccupancyGrid, angle: float) -> None:
    assert cast_one(post, 0.5, 2.0, angle) == 1.5
    assert cast_one(post, 0.5, 3.0, angle) == 50.0


@pytest.mark.parametrize("max_range", [1.5, 1.25, 1e-3])
def test_no_hit_within_max_range_is_exactly_max_range(post: mrs.OccupancyGrid, max_range: float) -> None:
    assert cast_one(post, 0.5, 2.5, 0.0, max_range) == np.float32(max_range)


def test_a_hit_just_within_max_range_counts(post: mrs.OccupancyGrid) -> None:
    assert cast_one(post, 0.5, 2.5, 0.0, 1.5 + 2**-20) == 1.5


def test_a_very_near_hit_counts(post: mrs.OccupancyGrid) -> None:
    assert cast_one(post, 2.0 - 2**-30, 2.5, 0.0) == 2**-30


@pytest.mark.parametrize(
    ("value", "threshold", "unknown", "blocks"),
    [
        (60, 60, "free", True),
        (59, 60, "free", False),
        (100, 100, "free", True),
        (99, 100, "free", False),
        (1, 1, "free", True),
        (0, 1, "free", False),
        (-1, 1, "free", False),
        (-1, 60, "occupied", True),
        (0, 60, "occupied", False),
    ],
)
def test_the_threshold_and_unknown_decide_what_blocks(value: int, threshold: int, unknown: str, blocks: bool) -> None:
    cells = np.array([[0, 0, value]], np.int8)
    grid = mrs.OccupancyGrid(cells, resolution=1.0, occupied_threshold=threshold, unknown=unknown)
    assert cast_one(grid, 0.5, 0.5, 0.0) == (1.5 if blocks else 50.0)


@pytest.mark.parametrize("size", [2, 3, 9, 40])
def test_diagonal_walls_never_leak(size: int) -> None:
    """The rays point exactly at the corners where two cells of a diagonal wall touch."""
    rng = np.random.default_rng(RAYS_SEED)
    for cells in (np.eye(size, dtype=np.int8) * 100, np.eye(size, dtype=np.int8)[::-1] * 100):
        grid = mrs.OccupancyGrid(np.ascontiguousarray(cells), resolution=1.0)
        falls = cells[0, 0] == 0
        for corner in range(1, size):
            x, y = float(corner), float(size - corner if falls else corner)
            side = np.array([1.0, 1.0]) if falls else np.array([1.0, -1.0])
            starts = np.array([x, y]) + rng.uniform(0.1, 20.0, (200, 1)) * side + rng.uniform(-0.05, 0.05, (200, 2))
            starts[:50] = np.round(starts[:50])
            starts = starts[(np.floor(starts) != np.floor([x, y])).any(axis=1)]
            angles = np.arctan2(y - starts[:, 1], x - starts[:, 0])
            ranges = mrs.cast_rays(grid, np.column_stack([starts, angles]), 100.0)
            assert (ranges <= np.hypot(x - starts[:, 0], y - starts[:, 1]) + 1e-5).all()


def test_a_ray_through_a_corner_may_visit_either_neighbour() -> None:
    """At 45° the sine and the cosine differ in the last bit, so the ray visits one of the two cells beside the corner."""
    assert cast_one(grid_of("#.\n.#"), 0.5, 0.5, PI / 4) == np.float32(math.sqrt(0.5))
    for drawn in ("#.\n..", "..\n.#"):
        assert cast_one(grid_of(drawn), 0.5, 0.5, PI / 4) in (np.float32(math.sqrt(0.5)), 50.0)


SHAPES = {
    "sparse": lambda rng: rng.random((40, 56)) < 0.01,
    "dense": lambda rng: rng.random((32, 23)) < 0.4,
    "half": lambda rng: rng.random((18, 31)) < 0.1,
    "poles": lambda rng: np.pad(np.ones((1, 1), bool), ((13, 30), (40, 9))),
    "empty": lambda rng: np.zeros((20, 20), bool),
    "full": lambda rng: np.ones((12, 17), bool),
    "diagonal": lambda rng: np.eye(33, dtype=bool),
    "antidiagonals": lambda rng: np.eye(33, dtype=bool)[::-1] | np.eye(33, k=9, dtype=bool),
    "checkerboard": lambda rng: np.indices((21, 22)).sum(axis=0) % 7 == 0,
    "room": lambda rng: np.pad(np.zeros((300, 290), bool), 1, constant_values=True),
    "one cell": lambda rng: np.ones((1, 1), bool),
    "one row": lambda rng: rng.random((1, 90)) < 0.05,
    "one column": lambda rng: rng.random((90, 1)) < 0.05,
}
ORIGINS = {
    "plain": (0.0, 0.0, 0.0),
    "shifted": (-3.7, 12.25, 0.0),
    "yawed": (1.5, -2.0, 0.7),
    "quarter": (0.0, 0.0, PI / 2),
    "reversed": (10.0, 5.0, 3.14),
}


@pytest.mark.parametrize("origin", ORIGINS.values(), ids=ORIGINS)
@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_random_rays_agree_with_the_reference(
    shape: Callable[[np.random.Generator], NDArray[np.bool_]], origin: tuple[float, float, float]
) -> None:
    cells = shape(np.random.default_rng(RAYS_SEED)).astype(np.int8) * 100
    grid = mrs.OccupancyGrid(cells, resolution=0.05, origin=origin)
    rays = rays_around(grid, 200, RAYS_SEED)
    reference.assert_ranges(mrs.cast_rays(grid, rays, 4.0), reference.cast(grid, rays, 4.0))


def test_a_grid_far_from_the_origin_loses_only_precision() -> None:
    """At 5,000 km, a float64 resolves 1e-9 m. Only rays that graze a cell may miss it."""
    cells = SHAPES["sparse"](np.random.default_rng(RAYS_SEED)).astype(np.int8) * 100
    grid = mrs.OccupancyGrid(cells, resolution=0.05, origin=(4e5, -5e6, -2.5))
    rays = rays_around(grid, 1000, RAYS_SEED)
    found, bounds = mrs.cast_rays(grid, rays, 4.0), reference.cast(grid, rays, 4.0)
    assert ((found >= bounds.smallest - 1e-6) & (found <= bounds.largest + 1e-6)).mean() > 0.995


@given(
    cells=st.integers(1, 14).flatmap(
        lambda width: st.lists(
            st.lists(st.sampled_from([0, 0, 0, 100]), min_size=width, max_size=width), min_size=1, max_size=12
        )
    ),
    rays=st.lists(
        st.tuples(
            st.one_of(st.floats(-20.0, 20.0), st.integers(-40, 40).map(lambda half: half / 2)),
            st.one_of(st.floats(-20.0, 20.0), st.integers(-40, 40).map(lambda half: half / 2)),
            st.one_of(st.floats(-7.0, 7.0), st.integers(-16, 16).map(lambda eighth: eighth * PI / 8)),
        ),
        min_size=1,
        max_size=30,
    ),
)
def test_any_ray_on_any_grid_agrees_with_the_reference(
    cells: list[list[int]], rays: list[tuple[float, float, float]]
) -> None:
    grid = mrs.OccupancyGrid(np.array(cells, np.int8), resolution=1.0)
    reference.assert_ranges(mrs.cast_rays(grid, np.array(rays), 30.0), reference.cast(grid, rays, 30.0))


MAPS = maps(
    carried=["office", "office_turned", "warehouse_grey_is_free", "corridor_shades", "cave_turned", "maze_negated"],
    real=[
        "nav2_tb3_sandbox/map.yaml",
        "nav2_depot/map.yaml",
        "willow_2010_0.10/map.yaml",
        "radish_intel/map_logframe.yaml",
        "mit_basement_fixed/map.yaml",
        "f1_berlin/map.yaml",
        "ros1_testmap2_negate/map.yaml",
    ],
)


@pytest.mark.parametrize("path", MAPS)
def test_whole_maps_agree_with_the_reference(path: Path) -> None:
    grid = mrs.load_map(path)
    rays = rays_around(grid, 60, RAYS_SEED, margin=0.1)
    bounds = reference.cast(grid, rays, 30.0)
    assert bounds.is_unique.mean() > 0.9
    reference.assert_ranges(mrs.cast_rays(grid, rays, 30.0), bounds)


@pytest.fixture
def clutter() -> mrs.OccupancyGrid:
    """Random cells of 0.25 m. Sums of their coordinates are exact in float64."""
    cells = (np.random.default_rng(RAYS_SEED).random((37, 53)) < 0.06).astype(np.int8) * 100
    return mrs.OccupancyGrid(cells, resolution=0.25)


def dyadic_rays(grid: mrs.OccupancyGrid, count: int) -> NDArray[np.float64]:
    rays = rays_around(grid, count, RAYS_SEED)
    rays[:, :2] = np.round(rays[:, :2] * 1024) / 1024
    return rays


@pytest.mark.parametrize("cells", [(1, 0), (0, -1), (64, 1024), (-5, 7)])
def test_a_shift_by_whole_cells_changes_no_byte(clutter: mrs.OccupancyGrid, cells: tuple[int, int]) -> None:
    rays = dyadic_rays(clutter, 2000)
    shift = np.array([*cells, 0.0]) * clutter.resolution
    moved = mrs.OccupancyGrid(clutter.cells, resolution=clutter.resolution, origin=tuple(shift.tolist()))
    assert np.array_equal(mrs.cast_rays(moved, rays + shift, 9.0), mrs.cast_rays(clutter, rays, 9.0))


def share_of_equal(left: NDArray[np.float32], right: NDArray[np.float32]) -> float:
    """Share of rays with equal ranges. Rays through corners may differ."""
    return float(np.isclose(left, right, rtol=1e-6, atol=1e-6).mean())


@pytest.mark.parametrize("turns", [1, 2, 3])
def test_quarter_turns_keep_the_ranges(clutter: mrs.OccupancyGrid, turns: int) -> None:
    rays = rays_around(clutter, 2000, RAYS_SEED)
    height, width = np.array(clutter.shape) * clutter.resolution
    x, y, angle = rays.T
    for _ in range(turns):
        x, y, angle, width, height = height - y, x, angle + PI / 2, height, width
    turned = mrs.OccupancyGrid(np.ascontiguousarray(np.rot90(clutter.cells, -turns)), resolution=clutter.resolution)
    found = mrs.cast_rays(turned, np.column_stack([x, y, angle]), 9.0)
    assert share_of_equal(found, mrs.cast_rays(clutter, rays, 9.0)) > 0.999


def test_a_mirror_image_has_the_same_ranges(clutter: mrs.OccupancyGrid) -> None:
    rays = rays_around(clutter, 2000, RAYS_SEED)
    mirrored = mrs.OccupancyGrid(np.ascontiguousarray(clutter.cells[:, ::-1]), resolution=clutter.resolution)
    width = clutter.shape[1] * clutter.resolution
    flipped = np.column_stack([width - rays[:, 0], rays[:, 1], PI - rays[:, 2]])
    assert share_of_equal(mrs.cast_rays(mirrored, flipped, 9.0), mrs.cast_rays(clutter, rays, 9.0)) > 0.999


def test_a_scaled_world_has_scaled_ranges(clutter: mrs.OccupancyGrid) -> None:
    rays = dyadic_rays(clutter, 1000)
    doubled = mrs.OccupancyGrid(clutter.cells, resolution=0.5)
    twice = rays * [2.0, 2.0, 1.0]
    assert np.array_equal(mrs.cast_rays(doubled, twice, 18.0), 2.0 * mrs.cast_rays(clutter, rays, 9.0))


def test_more_walls_never_lengthen_a_range(clutter: mrs.OccupancyGrid) -> None:
    rng = np.random.default_rng(WALLS_SEED)
    rays = rays_around(clutter, 3000, RAYS_SEED)
    before = mrs.cast_rays(clutter, rays, 9.0)
    for _ in range(5):
        cells = clutter.cells.copy()
        cells[rng.random(cells.shape) < 0.02] = 100
        after = mrs.cast_rays(mrs.OccupancyGrid(cells, resolution=clutter.resolution), rays, 9.0)
        assert (after <= before).all()
        assert (after < before).any()


def test_a_longer_max_range_changes_no_hit(clutter: mrs.OccupancyGrid) -> None:
    rays = rays_around(clutter, 3000, RAYS_SEED)
    short, long = mrs.cast_rays(clutter, rays, 2.0), mrs.cast_rays(clutter, rays, 20.0)
    assert np.array_equal(short, np.minimum(long, np.float32(2.0)))


@pytest.mark.parametrize(
    ("x", "y", "angle", "expected"),
    [
        (-1e9, 2.5, 0.0, 1e9 + 2.0),
        (1e9, 2.5, PI, None),
        (1e300, 1e300, 0.0, None),
        (-1e308, 2.5, 0.0, None),
        (1.7e308, -1.7e308, 2.3, None),
        (0.5, 2.5, 1e308, None),
        (0.5, 2.5, -1e15, None),
        (5e-324, 2.5, 5e-324, 2.0),
    ],
)
def test_huge_and_tiny_coordinates_give_valid_ranges(
    post: mrs.OccupancyGrid, x: float, y: float, angle: float, expected: float | None
) -> None:
    found = cast_one(post, x, y, angle, 2e9)
    assert 0.0 <= found <= np.float32(2e9)
    if expected is not None:
        assert found == np.float32(expected)


def test_a_heading_that_overflows_gives_a_valid_range(post: mrs.OccupancyGrid) -> None:
    far = mrs.OccupancyGrid(post.cells, resolution=1.0, origin=(0.0, 0.0, -1.7e308))
    found = cast_one(far, 0.5, 2.5, 1.7e308)
    assert 0.0 <= found <= 50.0


@pytest.mark.parametrize("shape", [(3, 65_535), (65_535, 3)])
def test_the_widest_grids_agree_with_the_reference(shape: tuple[int, int]) -> None:
    cells = np.zeros(shape, np.int8)
    cells[-1, -1] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.5)
    end = max(shape) * 0.5 - 0.5
    along = 0.0 if shape[1] > shape[0] else PI / 2
    across = (0.0, 1.25) if along == 0.0 else (1.25, 0.0)
    assert cast_one(grid, *across, along, 1e6) == end
    rays = rays_around(grid, 200, RAYS_SEED, margin=0.01)
    rays[:, 2] = along + np.linspace(-1e-4, 1e-4, 200)
    reference.assert_ranges(mrs.cast_rays(grid, rays, 1e6), reference.cast(grid, rays, 1e6))


def test_free_boxes_of_more_than_255_cells_agree_with_the_reference() -> None:
    cells = np.zeros((700, 700), np.int8)
    cells[:, -1] = 100
    grid = mrs.OccupancyGrid(cells, resolution=1.0)
    rays = np.column_stack([np.full(400, 0.25), np.linspace(250.1, 450.2, 400), np.linspace(-0.3, 0.3, 400)])
    reference.assert_ranges(mrs.cast_rays(grid, rays, 1000.0), reference.cast(grid, rays, 1000.0))


# --- Array arguments ---


def test_no_rays_give_no_ranges(post: mrs.OccupancyGrid) -> None:
    ranges = mrs.cast_rays(post, np.zeros((0, 3)), 9.0)
    assert (ranges.shape, ranges.dtype) == ((0,), np.float32)


def packed(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same rows as a field of packed records. Their stride is not a multiple of 8 bytes."""
    records = np.zeros(len(rows), [("row", "f8", (rows.shape[1],)), ("label", "i1")])
    records["row"] = rows
    return records["row"]


def unaligned(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same rows at an odd address."""
    return np.frombuffer(b"\0" + rows.tobytes(), np.float64, offset=1).reshape(rows.shape)


@pytest.mark.parametrize(
    "view",
    [
        np.asfortranarray,
        lambda rows: rows[::-1][::-1],
        lambda rows: np.repeat(rows, 2, axis=0)[::2],
        lambda rows: np.flip(np.flip(rows, axis=1).copy(), axis=1),
        lambda rows: np.hstack([rows, rows])[:, :3],
        packed,
        unaligned,
    ],
    ids=["fortran", "reversed", "strided", "flipped columns", "columns of a wider array", "packed records", "unaligned"],
)
def test_every_memory_layout_is_read_correctly(clutter: mrs.OccupancyGrid, view: Callable[[Any], Any]) -> None:
    rays = rays_around(clutter, 100, RAYS_SEED)
    assert np.array_equal(mrs.cast_rays(clutter, view(rays), 9.0), mrs.cast_rays(clutter, rays, 9.0))


@pytest.mark.parametrize("threads", [1, 2, 8, None])
def test_threads_change_no_byte(clutter: mrs.OccupancyGrid, threads: int | None) -> None:
    rays = rays_around(clutter, 20_000, RAYS_SEED)
    each = np.concatenate([mrs.cast_rays(clutter, part, 9.0, threads=1) for part in np.array_split(rays, 7)])
    assert np.array_equal(mrs.cast_rays(clutter, rays, 9.0, threads=threads), each)


def test_out_is_written_in_place_and_returned(post: mrs.OccupancyGrid) -> None:
    out = np.full(3, -7.0, np.float32)
    assert mrs.cast_rays(post, np.array([[0.5, 2.5, 0.0]] * 3), 9.0, out=out) is out
    assert out.tolist() == [1.5] * 3


@pytest.mark.parametrize("count", [3000, 150_000])
def test_out_may_overlap_the_rays(clutter: mrs.OccupancyGrid, count: int) -> None:
    rays = rays_around(clutter, count, RAYS_SEED)
    buffer = bytearray(rays.tobytes())
    shared, out = np.frombuffer(buffer).reshape(count, 3), np.frombuffer(buffer, np.float32)[5 * count :]
    expected = mrs.cast_rays(clutter, rays, 9.0)
    assert np.array_equal(mrs.cast_rays(clutter, shared, 9.0, out=out, threads=1), expected)


ONE = np.array([[0.5, 2.5, 0.0]])
LOCKED = np.zeros(1, np.float32)
LOCKED.flags.writeable = False


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"rays": np.zeros((2, 2))}, ValueError, "rays must have shape (N, 3), got (2, 2)"),
        ({"rays": np.zeros(3)}, ValueError, "rays must have shape (N, 3), got (3,)"),
        ({"rays": np.zeros((1, 1, 3))}, ValueError, "rays must have shape (N, 3), got (1, 1, 3)"),
        ({"rays": np.array(0.0)}, ValueError, "rays must have shape (N, 3), got ()"),
        ({"rays": np.zeros((1, 3), bool)}, TypeError, "rays must have dtype float64, got bool"),
        ({"rays": np.zeros((1, 3), complex)}, TypeError, "rays must have dtype float64, got complex128"),
        ({"rays": np.zeros((1, 3), object)}, TypeError, "rays must be an array of numbers, got ndarray"),
        ({"rays": None}, TypeError, "rays must be an array of numbers, got NoneType"),
        (
            {"rays": np.array([[0.0, 0.0, 0.0], [0.0, math.nan, 0.0]])},
            ValueError,
            "rays must be finite, got [0.0, NaN, 0.0] in row 1",
        ),
        ({"rays": np.array([[math.inf, 0.0, 0.0]])}, ValueError, "rays must be finite"),
        ({"rays": np.array([[0.0, 0.0, -math.inf]])}, ValueError, "rays must be finite"),
        ({"max_range": 0.0}, ValueError, "max_range must be positive"),
        ({"max_range": -1.0}, ValueError, "max_range must be positive"),
        ({"max_range": math.nan}, ValueError, "max_range must be positive"),
        ({"max_range": math.inf}, ValueError, "max_range must be"),
        ({"max_range": "9"}, TypeError, "max_range"),
        ({"threads": 0}, ValueError, "threads must be in 1..1024, got 0"),
        ({"threads": -1}, ValueError, "threads must be in 1..1024, got -1"),
        ({"threads": 1025}, ValueError, "threads must be in 1..1024, got 1025"),
        ({"threads": 1.5}, TypeError, "threads must be an integer, got float"),
        ({"out": np.zeros(2, np.float32)}, ValueError, "out must have shape (1,), got (2,)"),
        ({"out": np.zeros((1, 1), np.float32)}, ValueError, "out must have shape (1,), got (1, 1)"),
        ({"out": np.zeros(1)}, TypeError, "out must have dtype float32, got float64"),
        ({"out": [0.0]}, TypeError, "out must be a NumPy array of float32, got list"),
        ({"out": LOCKED}, ValueError, "out must be writeable"),
        ({"grid": None}, TypeError, "grid"),
    ],
)
def test_invalid_input_is_rejected(
    post: mrs.OccupancyGrid, arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    given = {"grid": post, "rays": ONE, "max_range": 9.0, **arguments}
    grid, rays, max_range = given.pop("grid"), given.pop("rays"), given.pop("max_range")
    with pytest.raises(error) as caught:
        mrs.cast_rays(grid, rays, max_range, **given)
    assert message in reference.message_of(caught.value)


def test_a_max_range_above_float32_is_rejected(post: mrs.OccupancyGrid) -> None:
    """Ranges are returned as float32, where such a maximum would become infinite."""
    with pytest.raises(ValueError, match="max_range"):
        cast_one(post, 0.5, 3.5, 0.0, 1e39)


def test_invalid_input_leaves_out_unchanged(post: mrs.OccupancyGrid) -> None:
    out = np.full(2, -7.0, np.float32)
    with pytest.raises(ValueError, match="finite"):
        mrs.cast_rays(post, np.array([[0.5, 2.5, 0.0], [math.nan, 0.0, 0.0]]), 9.0, out=out)
    assert out.tolist() == [-7.0, -7.0]
