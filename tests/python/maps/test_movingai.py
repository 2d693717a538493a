"""movingai: characters become cells, and scenario cells become poses, against files written by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.maps import Scenario, load_scenarios

SMALL = b"type octile\nheight 2\nwidth 4\nmap\n.G@O\nSTW.\n"
SEED = 22


def write(folder: Path, data: bytes, name: str = "small.map") -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def test_every_character_becomes_its_cell_and_the_first_line_is_the_top_row(tmp_path: Path) -> None:
    grid = mrs.load_map(write(tmp_path, SMALL))
    assert grid.cells.tolist() == [[0, 100, 100, 0], [0, 0, 100, 100]]
    assert (grid.resolution, tuple(grid.origin)) == (1.0, (0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    "data",
    [
        SMALL.replace(b"\n", b"\r\n"),
        SMALL.replace(b"\n", b"\r\n") + b"\x1a",
        SMALL.rstrip(b"\n"),
        SMALL + b"\n\n",
        SMALL.replace(b"height 2\nwidth 4", b"width 4\nheight 2"),
        SMALL.replace(b"height 2\nwidth 4\nmap\n", b"height  2 \nwidth\t4 \n map \n"),
        SMALL.replace(b"\nSTW.", b" \nSTW. "),
    ],
)
def test_oddities_of_published_files_do_not_matter(tmp_path: Path, data: bytes) -> None:
    assert np.array_equal(mrs.load_map(write(tmp_path, data)).cells, mrs.load_map(write(tmp_path, SMALL, "plain.map")).cells)


def test_a_generated_map_is_read_cell_by_cell(tmp_path: Path) -> None:
    letters = np.random.default_rng(SEED).choice(list(".GS@OTW"), size=(70, 90))
    rows = ["".join(row) for row in letters]
    grid = mrs.load_map(write(tmp_path, "\n".join(["type octile", "height 70", "width 90", "map", *rows, ""]).encode()))
    for y in range(70):
        for x in range(90):
            assert (grid.cells[69 - y, x] == 0) == (rows[y][x] in ".GS")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (SMALL[:-3], "must have 2 x 4 = 8 cells, got 6"),
        (SMALL + b".", "must have 2 x 4 = 8 cells, got 9"),
        (SMALL.replace(b"STW.", b"S#W."), "a cell must be one of .GS@OTW, got '#' in row 2, column 2 of the map"),
        (SMALL.replace(b".G@O", b"xG@O"), "a cell must be one of .GS@OTW, got 'x' in row 1, column 1 of the map"),
        (SMALL.replace(b"STW.", b"StW."), "a cell must be one of .GS@OTW, got 't' in row 2, column 2 of the map"),
        (SMALL.replace(b".G@O", b"s..g"), "a cell must be one of .GS@OTW, got 's' in row 1, column 1 of the map"),
        (SMALL.replace(b"octile", b"quad"), "the type must be octile, got 'quad'"),
        (SMALL.replace(b"octile", b"octile-corner"), "the type must be octile, got 'octile-corner'"),
        (SMALL.replace(b"height 2", b"height 0"), "height must be a whole number from 1 to 999999, got '0'"),
        (SMALL.replace(b"width 4", b"width -4"), "width must be a whole number from 1 to 999999, got '-4'"),
        (SMALL.replace(b"width 4", b"height 4"), "must begin with the lines type octile, height, width and map, got"),
        (b"@@@\n@.@\n", r"must begin with the lines type octile, height, width and map, got '@@@\n@.@\n'"),
        (b"", "must begin with the lines type octile, height, width and map, got ''"),
        (b"\x89PNG\r\n", "must begin with the lines type octile, height, width and map, got"),
    ],
)
def test_malformed_maps_are_errors(tmp_path: Path, data: bytes, message: str) -> None:
    path = write(tmp_path, data)
    with pytest.raises(ValueError) as caught:
        mrs.load_map(path)
    assert str(caught.value).startswith(f"{path}: {message}")


# --- Scenarios ---

PROBLEMS = "version 1\n0\tmaps/a b/small.map\t4\t2\t0\t1\t1\t0\t1.41421\n12\tsmall.map\t4\t2\t0\t0\t3\t1\t5\n"


def test_problems_are_read_in_order(tmp_path: Path) -> None:
    first, second = load_scenarios(write(tmp_path, PROBLEMS.encode(), "small.map.scen"))
    assert first == Scenario(0, "maps/a b/small.map", (4, 2), (0, 1), (1, 0), 1.41421)
    assert (second.bucket, second.goal, second.optimal_length) == (12, (3, 1), 5.0)


@pytest.mark.parametrize("version", ["version 1", "version 1.0", "version 1.0 ", "version\t1"])
def test_blanks_and_other_line_ends_are_read(tmp_path: Path, version: str) -> None:
    text = f"{version}\r\n0 small.map 4 2 0 1 1 0 1.5\r\n\r\n"
    assert load_scenarios(write(tmp_path, text.encode())) == [Scenario(0, "small.map", (4, 2), (0, 1), (1, 0), 1.5)]


def test_cells_of_a_problem_are_places_on_the_grid(tmp_path: Path) -> None:
    """The start (0, 1) is the S of the map, at the lower left; the goal (1, 0) is the G, above and to the right of it."""
    grid = mrs.load_map(write(tmp_path, SMALL), resolution=0.5)
    start, goal = load_scenarios(write(tmp_path, PROBLEMS.encode(), "small.map.scen"))[0].poses_on(grid)
    assert (tuple(start), tuple(goal)) == ((0.25, 0.25, 0.0), (0.75, 0.75, 0.0))
    assert grid.cell_at(start.x, start.y) == (0, 0) and grid.cell_at(goal.x, goal.y) == (1, 1)


def test_a_problem_of_another_map_is_an_error(tmp_path: Path) -> None:
    grid = mrs.OccupancyGrid(np.zeros((4, 2), np.int8), resolution=1.0)
    with pytest.raises(ValueError, match=r"must have 4 x 2 cells, got 2 x 4"):
        Scenario(0, "small.map", (4, 2), (0, 1), (1, 0), 1.5).poses_on(grid)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ": must begin with the line version 1, got ''"),
        ("version 2\n", ": must begin with the line version 1, got 'version 2'"),
        ("version 1\n0 small.map 4 2 0 1 1 0\n", ", line 2: must have 9 fields, got 8"),
        ("version 1\n\n0 small.map 4 2 0 1 4 0 1\n", ", line 3: the goal must be on the map of 4 x 2 cells, got (4, 0)"),
        ("version 1\n0 small.map 4 2 0 2 1 0 1\n", ", line 2: the start must be on the map of 4 x 2 cells, got (0, 2)"),
        ("version 1\n0 small.map 4 2 0 -1 1 0 1\n", ", line 2: must have whole numbers, got '-1'"),
        ("version 1\n0 small.map 4 2 0 1 1 0 far\n", ", line 2: the length must be a number of at least 0, got 'far'"),
        ("version 1\n0 small.map 4 2 0 1 1 0 nan\n", ", line 2: the length must be a number of at least 0, got 'nan'"),
    ],
)
def test_malformed_scenarios_are_errors(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text.encode(), "small.scen")
    with pytest.raises(ValueError) as caught:
        load_scenarios(path)
    assert str(caught.value).startswith(f"{path}{message}")
