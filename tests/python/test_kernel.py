"""kernel: every kernel gives the same bytes, an unknown one is an error, and changed cells take effect at once."""

import os
import subprocess
import sys

import numpy as np
import pytest

import mobile_robot_simulator as mrs

SCAN = """
import sys
import numpy as np
import mobile_robot_simulator as mrs

cells = np.zeros((60, 80), np.int8)
cells[::7, ::5] = 100
grid = mrs.OccupancyGrid(cells, resolution=0.1)
try:
    ranges = mrs.LaserScanner(beam_count=181).scan(grid, (2.22, 3.33, 0.4))
except ValueError as error:
    print(error)
else:
    sys.stdout.write(ranges.tobytes().hex())
"""


def scan(kernel: str | None) -> str:
    environment = {name: value for name, value in os.environ.items() if name != "MOBILE_ROBOT_SIMULATOR_KERNEL"}
    if kernel is not None:
        environment["MOBILE_ROBOT_SIMULATOR_KERNEL"] = kernel
    done = subprocess.run([sys.executable, "-c", SCAN], env=environment, capture_output=True, text=True, check=True)
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("kernel", ["traversal", "portable", "avx2", "avx512", "avx512-gather"])
def test_every_kernel_gives_the_same_bytes(kernel: str) -> None:
    found = scan(kernel)
    if found.startswith("MOBILE"):
        pytest.skip(found.strip())
    assert found == scan(None)


@pytest.mark.parametrize("name", ["", "AVX2", "neon"])
def test_an_unknown_kernel_is_rejected(name: str) -> None:
    message = scan(name)
    assert message.startswith("MOBILE_ROBOT_SIMULATOR_KERNEL must be one of traversal, portable")
    assert message.endswith(f'on this machine, got "{name}"\n')


def test_scans_see_changed_cells_at_once() -> None:
    grid = mrs.OccupancyGrid(np.zeros((50, 50), np.int8), resolution=1.0)
    laser = mrs.LaserScanner(beam_count=1, max_range=100.0)
    assert laser.scan(grid, (10.5, 10.5, 0.0)) == 100.0
    before = grid.cells
    grid.set_cells(10, 20, np.array([[100, -1]], np.int8))
    assert laser.scan(grid, (10.5, 10.5, 0.0)) == 9.5
    assert grid.cells[10, 20] == 100 and grid.cells[10, 21] == -1 and before[10, 20] == 0
    grid.set_cells(10, 20, np.zeros((1, 1), np.int8))
    assert laser.scan(grid, (10.5, 10.5, 0.0)) == 100.0


@pytest.mark.parametrize(
    ("row", "col", "cells", "message"),
    [
        (
            49,
            0,
            np.zeros((2, 1), np.int8),
            r"a block of shape \(2, 1\) at row 49 and column 0 must fit .* \(50, 50\)",
        ),
        (
            0,
            50,
            np.zeros((1, 1), np.int8),
            r"a block of shape \(1, 1\) at row 0 and column 50 must fit .* \(50, 50\)",
        ),
        (0, 0, np.full((2, 2), 101, np.int8), "cells must be in -1..100, got 101 at row 0, column 0"),
        (0, 0, np.zeros(3, np.int8), r"cells must have shape \(H, W\), got \(3,\)"),
        (0, 0, np.zeros((0, 3), np.int8), "the number of cells must be at least 1, got 0"),
        (-1, 0, np.zeros((1, 1), np.int8), "row must be at least 0, got -1"),
    ],
)
def test_invalid_rectangles_are_rejected(row: int, col: int, cells: np.ndarray, message: str) -> None:
    grid = mrs.OccupancyGrid(np.zeros((50, 50), np.int8), resolution=1.0)
    with pytest.raises(ValueError, match=message):
        grid.set_cells(row, col, cells)
    assert not grid.cells.any()
