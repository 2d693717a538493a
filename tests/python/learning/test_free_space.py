"""learning: the connected free space of a robot."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.learning import FreeSpace

SEED = 3


def scattered(origin: tuple[float, float, float]) -> mrs.OccupancyGrid:
    cells = np.zeros((40, 50), np.int8)
    cells[np.random.default_rng(SEED).random(cells.shape) < 0.008] = 100
    cells[20] = 100
    cells[30:33, 10:20] = -1
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=origin)


def parts_of(grid: mrs.OccupancyGrid, radius: float) -> np.ndarray:
    """Connected parts by the definition: a cell is free if no blocking cell is near any of its points."""
    blocking = np.argwhere(grid.cells >= grid.occupied_threshold)
    free = np.zeros(grid.shape, bool)
    for row, col in np.ndindex(*grid.shape):
        distances = np.hypot(*(blocking - (row, col)).T) * grid.resolution
        free[row, col] = grid.cells[row, col] >= 0 and distances.min() >= radius + math.sqrt(2.0) * grid.resolution
    parts = np.zeros(grid.shape, int)
    for number, start in enumerate(map(tuple, np.argwhere(free)), start=1):
        waiting = deque([start] if parts[start] == 0 else [])
        while waiting:
            row, col = waiting.popleft()
            if 0 <= row < grid.shape[0] and 0 <= col < grid.shape[1] and free[row, col] and not parts[row, col]:
                parts[row, col] = number
                waiting += [(row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)]
    return parts


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (-3.0, 2.0, 0.7)])
@pytest.mark.parametrize("radius", [0.0, 0.15, 0.25])
def test_points_are_connected_as_a_flood_fill_finds(origin, radius):
    grid = scattered(origin)
    space, parts = FreeSpace([scattered((0.0, 0.0, 0.0)), grid], radius), parts_of(grid, radius)
    generator = np.random.default_rng(SEED)
    answers = []
    for one, other in generator.integers(0, grid.shape, (400, 2, 2)):
        expected = parts[tuple(one)] == parts[tuple(other)] != 0
        points = [grid.center(int(row), int(col)) for row, col in (one, other)]
        assert space.are_connected(1, *points) is bool(expected)
        answers.append(expected)
    assert 0.05 < np.mean(answers) < 0.95
    assert not space.are_connected(1, grid.center(5, 5), (100.0, 100.0))


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (-3.0, 2.0, 0.7)])
def test_starts_and_goals_are_free_connected_and_as_far_apart_as_asked(origin):
    grid, radius, count = scattered(origin), 0.15, 3000
    space, parts = FreeSpace([grid], radius), parts_of(grid, radius)
    numbers = np.random.default_rng(SEED).random((count, FreeSpace.NUMBERS))
    starts, goals, found = space.draw(np.zeros(count, np.intp), (0.5, 2.0), numbers)
    assert found.mean() > 0.95
    for start, goal in zip(starts[found], goals[found], strict=True):
        assert space.are_connected(0, start, goal)
        assert grid.is_free_disc(start[0], start[1], radius - 1e-9) and grid.is_free_disc(*goal, radius - 1e-9)
    lengths = np.hypot(*(starts[found, :2] - goals[found]).T)
    assert lengths.min() >= 0.5 - 1e-9 and lengths.max() <= 2.0 + 1e-9
    # Each cell is drawn equally often, and each yaw: chi-square with many degrees of freedom is near normal.
    drawn = np.zeros(grid.shape)
    for x, y, _ in starts:
        drawn[grid.cell_at(x, y)] += 1
    free = parts > 0
    expected = count / free.sum()
    degrees = free.sum() - 1
    assert drawn[~free].sum() == 0
    assert abs(((drawn[free] - expected) ** 2 / expected).sum() - degrees) < 4.0 * math.sqrt(2.0 * degrees)
    turns, _ = np.histogram(starts[:, 2], 10, (-math.pi, math.pi))
    assert turns.sum() == count and ((turns - count / 10) ** 2 / (count / 10)).sum() < 27.9  # 0.1 % of chi-square(9)


def test_a_world_without_space_is_named():
    free, full = scattered((0.0, 0.0, 0.0)), mrs.OccupancyGrid(np.full((9, 9), 100, np.int8), resolution=0.1)
    with pytest.raises(ValueError, match=r"free space for a robot of radius 0.1 m, got none in world 1"):
        FreeSpace([free, full], 0.1)
    with pytest.raises(ValueError, match="radius must be at least 0, got -1"):
        FreeSpace([free], -1)
