"""floor_plans: plans are closed, connected and wide enough to drive in, and a seed gives the same cells everywhere."""

from __future__ import annotations

import hashlib
import random
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mobile_robot_simulator.maps.floor_plans import KINDS, floor_plan
from mobile_robot_simulator.maps.floor_plans.connectivity import fill_unreachable, label

SEEDS = range(6)
ODD_SIZES = [((8.0, 8.0), 0.05), ((8.0, 40.0), 0.1), ((60.0, 9.0), 0.1), ((23.37, 17.91), 0.07), ((70.0, 60.0), 0.2)]

# First ten digits of the SHA-256 of the cells, for seed 1 and the default size. Tests of users depend on these cells.
SUMS = {
    "office": "f9f8bab77e",
    "corridor": "11337446c0",
    "maze": "4e88ce8b43",
    "cave": "0c720a4764",
    "warehouse": "9e0e53802d",
}


def components_of(free: NDArray[np.bool_]) -> list[int]:
    """Sizes of the connected components, largest first, from a flood fill."""
    left = {(int(row), int(col)) for row, col in np.argwhere(free)}
    sizes = []
    while left:
        front = [left.pop()]
        size = 0
        while front:
            row, col = front.pop()
            size += 1
            for cell in ((row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)):
                if cell in left:
                    left.remove(cell)
                    front.append(cell)
        sizes.append(size)
    return sorted(sizes, reverse=True)


def sizes_of(free: NDArray[np.bool_]) -> list[int]:
    """The same sizes from `label`, which is faster. A test below compares it with `components_of`."""
    return sorted(filter(None, np.bincount(label(free)[free]).tolist()), reverse=True)


def room_for(cells: NDArray[np.int8], radius: float) -> NDArray[np.bool_]:
    """Free cells whose distance to every cell that is not free is more than a radius [cells], centre to centre."""
    free = np.pad(cells == 0, int(radius) + 1)
    room = free.copy()
    reach = range(-int(radius), int(radius) + 1)
    for rows in reach:
        for cols in reach:
            if rows * rows + cols * cols <= radius * radius:
                room &= np.roll(free, (rows, cols), axis=(0, 1))
    return room


# --- Properties of every plan ---


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_plans_are_closed_and_connected(kind: str, seed: int) -> None:
    grid = floor_plan(kind, seed=seed, resolution=0.1)
    cells = grid.cells
    assert grid.shape == (250, 400) and grid.resolution == 0.1 and tuple(grid.origin) == (0.0, 0.0, 0.0)
    assert set(np.unique(cells)) <= {-1, 0, 100}
    assert len(sizes_of(cells == 0)) == 1
    assert_closed(cells)
    assert 0.15 < (cells == 0).mean() < 0.95


def assert_closed(cells: NDArray[np.int8]) -> None:
    """No free cell lies at the edge of the map or next to an unknown cell."""
    around = np.pad(cells, 1, constant_values=-1)
    neighbours = [np.roll(around, (rows, cols), axis=(0, 1)) for rows in (-1, 0, 1) for cols in (-1, 0, 1)]
    assert not ((np.min(neighbours, axis=0) < 0) & (around == 0)).any()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("size", "resolution"), ODD_SIZES)
def test_plans_of_unusual_sizes_are_closed_and_connected(kind: str, size: tuple[float, float], resolution: float) -> None:
    for seed in range(4):
        grid = floor_plan(kind, seed=seed, size=size, resolution=resolution)
        assert grid.shape == (round(size[1] / resolution), round(size[0] / resolution))
        assert len(sizes_of(grid.cells == 0)) == 1
        assert_closed(grid.cells)
        assert (grid.cells == 0).mean() > 0.1


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_robot_can_reach_almost_all_free_cells(kind: str, seed: int) -> None:
    room = room_for(floor_plan(kind, seed=seed).cells, 0.3 / 0.05)
    parts = sizes_of(room)
    assert parts[0] > 0.95 * sum(parts)


@pytest.mark.parametrize("seed", SEEDS)
def test_doors_of_an_office_are_wide(seed: int) -> None:
    cells = floor_plan("office", seed=seed).cells
    parts = sizes_of(room_for(cells, 0.44 / 0.05))
    assert parts[0] > 0.95 * sum(parts)


@pytest.mark.parametrize("kind", ["maze", "corridor", "office"])
def test_walls_are_two_cells_thick(kind: str) -> None:
    for resolution in (0.05, 0.1, 0.2):
        cells = floor_plan(kind, seed=3, resolution=resolution).cells
        for lines in (cells, cells.T):
            thin = (lines[:, 1:-1] != 0) & (lines[:, :-2] == 0) & (lines[:, 2:] == 0)
            # The only exceptions are the tips of two round pillars.
            assert thin.sum() <= (4 if kind == "office" else 0)


def test_an_office_has_rooms_furniture_and_missing_corners() -> None:
    offices = [floor_plan("office", seed=seed).cells for seed in range(12)]
    assert any((cells == -1).any() for cells in offices)
    assert any((cells == -1).sum() == 0 for cells in offices)
    # Doors are too narrow for this radius, so each room is a component of its own.
    assert all(len([part for part in sizes_of(room_for(cells, 13)) if part > 100]) >= 10 for cells in offices[:4])


# --- Reproducibility ---


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_seed_gives_the_same_cells(kind: str) -> None:
    cells = floor_plan(kind, seed=1).cells
    random.seed(5)
    assert np.array_equal(floor_plan(kind, seed=1).cells, cells)
    assert not np.array_equal(floor_plan(kind, seed=2).cells, cells)
    assert hashlib.sha256(cells.tobytes()).hexdigest()[:10] == SUMS[kind]


def test_defaults() -> None:
    grid = floor_plan()
    assert grid.shape == (500, 800)
    assert np.array_equal(grid.cells, floor_plan("office", seed=0, size=(40.0, 25.0), resolution=0.05).cells)


# --- Connected components ---


@pytest.mark.parametrize("share", [0.0, 0.3, 0.55, 0.62, 0.8, 1.0])
def test_components_equal_those_of_a_flood_fill(share: float) -> None:
    for seed in range(10):
        free = np.random.RandomState(seed).random_sample((17, 23)) < share
        numbers = label(free)
        assert np.array_equal(numbers > 0, free)
        assert sizes_of(free) == components_of(free)
        cells = np.where(free, 0, -1).astype(np.int8)
        fill_unreachable(cells)
        assert components_of(cells == 0) == components_of(free)[:1]
        assert np.array_equal(cells == -1, ~free)


# --- Errors ---


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"kind": "ofice"}, "kind must be one of office, .*, got 'ofice'; did you mean 'office'"),
        ({"kind": "xyz"}, "got 'xyz'$"),
        ({"kind": None}, "got None$"),
        ({"seed": -1}, "seed must be at least 0, got -1"),
        ({"size": (7.9, 20.0)}, "size must be at least 8.0 x 8.0 m, got 7.9 x 20.0"),
        ({"size": (float("nan"), 20.0)}, "size must be at least"),
        ({"size": (float("inf"), 20.0)}, "size must be at least"),
        ({"size": 20.0}, "size must be two numbers"),
        ({"size": (1.0, 2.0, 3.0)}, "size must be two numbers"),
        ({"size": "ab"}, "size must be two numbers"),
        ({"resolution": 0.0}, "resolution must be above 0 and at most 0.2 m, got 0.0"),
        ({"resolution": -0.1}, "resolution must be"),
        ({"resolution": float("nan")}, "resolution must be"),
        ({"resolution": 0.5}, "resolution must be"),
        ({"size": (1000.0, 1000.0), "resolution": 0.01}, "a plan must have at most 100000000 cells"),
        ({"size": (1e300, 1e300)}, "a plan must have at most 100000000 cells"),
    ],
)
def test_invalid_arguments_are_rejected(arguments: dict[str, Any], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        floor_plan(**arguments)


def test_a_seed_must_be_an_integer() -> None:
    with pytest.raises(TypeError):
        floor_plan(seed=0.5)  # type: ignore[arg-type]
