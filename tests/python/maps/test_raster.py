"""raster: cells on hand-drawn examples, and against rules that look at every cell and every edge with exact fractions."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from mobile_robot_simulator.maps.raster import Raster

SEED = 22
Point = tuple[Fraction, Fraction]


def drawn(raster: Raster) -> list[str]:
    """The cells as text, top row first: # is occupied."""
    return ["".join("#" if cell else "." for cell in row) for row in raster.cell_map().cells[::-1]]


def points(*corners: tuple[float, float]) -> NDArray[np.float64]:
    return np.array(corners, np.float64)


def test_an_area_on_the_edges_of_cells_covers_these_cells_only() -> None:
    raster = Raster((0, 0), (3, 2), 1.0)
    raster.add_area([points((0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2))])
    assert drawn(raster) == [".....", ".#...", ".###.", "....."]
    assert raster.cell_map()[1:] == (1.0, (-1.0, -1.0, 0.0), None)


def test_a_cell_that_is_covered_in_part_is_occupied() -> None:
    raster = Raster((0, 0), (3, 2), 1.0)
    raster.add_area([points((0.9, 0.5), (2.01, 0.5), (2.01, 1.5), (0.9, 1.5))])
    assert drawn(raster) == [".....", ".###.", ".###.", "....."]


def test_a_sum_of_decimals_is_the_edge_that_it_means() -> None:
    """0.15 / 0.05 and 0.1 + 0.2 are not whole numbers of cells in float64, but are meant so."""
    raster = Raster((0, 0), (0.3, 0.15), 0.05)
    raster.add_area([points((0, 0), (0.1 + 0.2, 0), (0.1 + 0.2, 0.15), (0, 0.15))])
    assert drawn(raster) == ["........", ".######.", ".######.", ".######.", "........"]


def test_a_wall_between_cells_is_in_the_right_and_in_the_upper_one() -> None:
    raster = Raster((0, 0), (3, 3), 1.0)
    raster.add_walls([points((1, 0), (1, 2.5)), points((2.2, 1), (2.8, 1))])
    assert drawn(raster) == [".....", "..#..", "..##.", "..#..", "....."]


def test_a_diagonal_wall_has_no_gap_wider_than_a_corner() -> None:
    raster = Raster((0, 0), (3, 3), 1.0)
    raster.add_walls([points((0, 0), (3, 3)), points((0.5, 2.5))])
    assert drawn(raster) == ["....#", ".#.#.", "..#..", ".#...", "....."]


def test_holes_and_both_fill_rules() -> None:
    outer, inner = points((0, 0), (3, 0), (3, 3), (0, 3)), points((1, 1), (2, 1), (2, 2), (1, 2))
    for rings, is_even_odd, middle in (
        ([outer, inner], True, "."),
        ([outer, inner], False, "#"),
        ([outer, inner[::-1]], False, "."),
    ):
        raster = Raster((0, 0), (3, 3), 1.0)
        raster.add_area(rings, is_even_odd=is_even_odd)
        assert drawn(raster) == [".....", ".###.", f".#{middle}#.", ".###.", "....."]


def test_the_outside_of_a_room() -> None:
    raster = Raster((0, 0), (4, 2), 1.0)
    raster.add_outside(points((0, 0), (4, 0), (4, 1), (2.5, 1), (2.5, 2), (0, 2)))
    assert drawn(raster) == ["######", "#..###", "#....#", "######"]


def test_a_disc_covers_the_cells_that_are_nearer_than_its_radius() -> None:
    raster = Raster((0, 0), (4, 4), 1.0)
    raster.add_disc((2, 2), 2.0)
    raster.add_disc((0.5, 0.5), 0.1)
    assert drawn(raster) == ["......", ".####.", ".####.", ".####.", ".####.", "......"]
    raster = Raster((0, 0), (4, 4), 1.0)
    raster.add_disc((2, 2), 1.0 + 2**-20)
    assert drawn(raster) == ["......", "..##..", ".####.", ".####.", "..##..", "......"]


def test_a_cell_that_only_touches_a_disc_stays_free() -> None:
    """The corner (8, 9) is 5 m from (5, 5), as 3² + 4² = 5²."""
    raster = Raster((0, 0), (10, 10), 1.0)
    raster.add_disc((5, 5), 5.0)
    cells = raster.cell_map().cells[1:-1, 1:-1]
    assert (cells[9, 8], cells[9, 7], cells[8, 8]) == (0, 100, 100)


@pytest.mark.parametrize("high", [(1e9, 1.0), (30_000.0, 30_000.0), (float("inf"), 1.0), (float("nan"), 1.0)])
def test_a_grid_that_is_too_large_is_an_error(high: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"a grid must have at most|coordinates must be finite"):
        Raster((0, 0), high, 1.0)


# --- Against references ---


def passes_through(a: Point, b: Point, col: int, row: int) -> bool:
    """Whether a segment has a point in the interior of a cell, by cutting it at the four sides (Liang & Barsky 1984)."""
    enter, leave = Fraction(0), Fraction(1)
    for start, end, low in ((a[0], b[0], col), (a[1], b[1], row)):
        if start == end:
            if not low < start < low + 1:
                return False
            continue
        sides = sorted(((low - start) / (end - start), (low + 1 - start) / (end - start)))
        enter, leave = max(enter, sides[0]), min(leave, sides[1])
    return enter < leave or (a == b and enter <= leave)


def winds_around(corners: list[Point], at: Point) -> int:
    """Winding number: signed number of edges that cross the ray to the left."""
    count = 0
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        if (y0 <= at[1]) != (y1 <= at[1]) and x0 + (x1 - x0) * (at[1] - y0) / (y1 - y0) < at[0]:
            count += 1 if y1 > y0 else -1
    return count


def exact(corners: NDArray[np.float64]) -> list[Point]:
    """Corners in cells from the corner of a grid with a margin of one cell, rounded to 1/1024."""
    return [(1 + Fraction(round(x * 1024), 1024), 1 + Fraction(round(y * 1024), 1024)) for x, y in corners]


def random_corners(random: np.random.Generator, count: int) -> NDArray[np.float64]:
    """Corners on a plan of 9 x 7 cells: many on edges and corners of cells, some anywhere."""
    corners = random.uniform(0, 1, (count, 2)) * (9, 7)
    return np.where(random.random((count, 2)) < 0.6, np.rint(2 * corners) / 2, corners)


@pytest.mark.parametrize("is_even_odd", [True, False])
def test_areas_equal_the_definition(is_even_odd: bool) -> None:
    random = np.random.default_rng(SEED)
    half = Fraction(1, 2)
    for _ in range(60):
        corners = random_corners(random, random.integers(3, 8))
        raster, outside = Raster((0, 0), (9, 7), 1.0), Raster((0, 0), (9, 7), 1.0)
        raster.add_area([corners], is_even_odd=is_even_odd)
        outside.add_outside(corners)
        ring = exact(corners)
        for row in range(9):
            for col in range(11):
                edge = any(passes_through(a, b, col, row) for a, b in zip(ring, ring[1:] + ring[:1], strict=True))
                winding = winds_around(ring, (col + half, row + half))
                is_inside = bool(winding % 2 if is_even_odd else winding)
                assert (raster.cell_map().cells[row, col] == 100) == (edge or is_inside)
                assert (outside.cell_map().cells[row, col] == 100) == (edge or winding % 2 == 0)


def test_walls_equal_the_definition() -> None:
    """The reference moves a wall by half a tick, which takes it off the left and lower edges into their cells."""
    random = np.random.default_rng(SEED)
    tick = Fraction(1, 2048)
    for _ in range(60):
        corners = random_corners(random, random.integers(1, 6))
        raster = Raster((0, 0), (9, 7), 1.0)
        raster.add_walls([corners])
        line = [(x + tick, y + tick) for x, y in exact(corners)]
        pairs = list(pairwise(line)) or [(line[0], line[0])]
        for row in range(9):
            for col in range(11):
                expected = any(passes_through(a, b, col, row) for a, b in pairs)
                assert (raster.cell_map().cells[row, col] == 100) == expected


def test_walls_do_not_depend_on_their_direction() -> None:
    random = np.random.default_rng(SEED)
    for _ in range(50):
        corners = random_corners(random, 5)
        rasters = [Raster((0, 0), (9, 7), 1.0) for _ in range(2)]
        rasters[0].add_walls([corners])
        rasters[1].add_walls([corners[i : i + 2][::-1] for i in range(4)])
        assert drawn(rasters[0]) == drawn(rasters[1])
