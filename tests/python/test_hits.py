"""hits: what each beam meets and at which angle, against an oracle that looks at every side of every cell."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs

SEED = 4


def oracle(
    grid: mrs.OccupancyGrid, discs: list[tuple[float, float, float]], x: float, y: float, angle: float, limit: float
) -> tuple[int, float, float]:
    """Surface, incidence and distance of a beam, in a grid of cells of 1 m at the origin, by looking at everything."""
    dx, dy = math.cos(angle), math.sin(angle)
    nearest = (limit, -1, math.nan)
    for row, col in np.argwhere(grid.cells >= 60).tolist():
        if col <= x < col + 1 and row <= y < row + 1:
            nearest = min(nearest, (0.0, 0, math.nan))
        for line, start, along, other, across, low in (
            (col if dx > 0 else col + 1, x, dx, y, dy, row),
            (row if dy > 0 else row + 1, y, dy, x, dx, col),
        ):
            distance = (line - start) / along
            if distance >= 0.0 and low <= other + distance * across <= low + 1:
                nearest = min(nearest, (distance, 0, math.acos(abs(along))))
    for index, (cx, cy, radius) in enumerate(discs, start=1):
        towards, off = dx * (cx - x) + dy * (cy - y), dx * (cy - y) - dy * (cx - x)
        if math.hypot(cx - x, cy - y) < radius:
            nearest = min(nearest, (0.0, index, math.nan))
        elif abs(off) < radius and towards > 0.0:
            distance = towards - math.sqrt(radius**2 - off**2)
            nearest = min(nearest, (distance, index, math.asin(abs(off) / radius)))
    return nearest[1], nearest[2], nearest[0]


def test_hits_are_those_of_an_oracle() -> None:
    generator = np.random.default_rng(SEED)
    grid = mrs.OccupancyGrid((generator.random((12, 15)) < 0.1).astype(np.int8) * 100, resolution=1.0)
    discs = [(float(x), float(y), 0.3 + 0.1 * n) for n, (x, y) in enumerate(generator.uniform(1.0, 11.0, (4, 2)))]
    obstacles = [(mrs.Shape.disc(radius), (x, y, 0.0)) for x, y, radius in discs]
    laser = mrs.LaserScanner(fov=6.0, beam_count=61, max_range=6.0)
    poses = generator.uniform((-2.0, -2.0, -3.0), (17.0, 14.0, 3.0), (150, 3))
    surfaces, incidences = laser.hits(grid, poses, obstacles=obstacles)
    ranges = laser.scan_batch(grid, poses, obstacles=obstacles)
    assert (
        surfaces.shape == incidences.shape == ranges.shape and surfaces.dtype == np.int32 and incidences.dtype == np.float32
    )
    seen = set()
    for scan, (x, y, yaw) in enumerate(poses.tolist()):
        for beam, angle in enumerate(laser.angles.tolist()):
            surface, incidence, distance = oracle(grid, discs, x, y, yaw + angle, 6.0)
            assert distance == pytest.approx(ranges[scan, beam], abs=1e-5)
            assert (surfaces[scan, beam], incidences[scan, beam]) == (
                surface,
                pytest.approx(incidence, abs=1e-4, nan_ok=True),
            )
            seen.add((surface, math.isnan(incidence)))
    assert seen >= {(-1, True), (0, True), (0, False), *((index, False) for index in range(1, 5))}
    for threads in (1, 3):
        again = laser.hits(grid, poses, obstacles=obstacles, threads=threads)
        assert np.array_equal(again[0], surfaces) and np.array_equal(again[1], incidences, equal_nan=True)


def test_the_sides_of_a_polygon() -> None:
    """A square of 2 m around (5, 5), turned by 45°: from the left, beams meet its two left sides at 45°."""
    grid = mrs.OccupancyGrid(np.zeros((10, 10), np.int8), resolution=1.0)
    square = [(mrs.Shape.rectangle(2.0, 2.0), (5.0, 5.0, math.pi / 4))]
    ahead = mrs.LaserScanner(beam_count=1, max_range=20.0)
    for y in (4.2, 5.7):
        surfaces, incidences = ahead.hits(grid, [(1.0, y, 0.0)], obstacles=square)
        assert surfaces.tolist() == [[1]] and incidences[0, 0] == pytest.approx(math.pi / 4)
    surfaces, incidences = ahead.hits(grid, [(5.0, 5.0, 0.0), (1.0, 1.0, 0.0)], obstacles=square)
    assert surfaces.tolist() == [[1], [-1]] and np.isnan(incidences).all()


def test_a_mount_a_turned_grid_and_poses_of_each_beam() -> None:
    cells = np.zeros((1, 4), np.int8)
    cells[0, 3] = 100
    grid = mrs.OccupancyGrid(cells, resolution=1.0, origin=(10.0, 0.0, math.pi / 2))
    laser = mrs.LaserScanner(fov=0.2, beam_count=3, max_range=9.0, mount=(0.25, 0.0, math.pi / 2))
    # The wall is 3 m up the turned grid. The laser looks up from between its sides.
    surfaces, incidences = laser.hits(grid, [(9.25, 0.5, 0.0)])
    assert surfaces.tolist() == [[0, 0, 0]] and incidences[0] == pytest.approx([0.1, 0.0, 0.1], abs=1e-6)
    each = np.array([[(9.25, 0.5, 0.0), (9.25, 0.5, 0.1), (9.25, 0.5, 1.5)]])
    surfaces, incidences = laser.hits(grid, each)
    assert surfaces.tolist() == [[0, 0, -1]] and incidences[0, :2] == pytest.approx([0.1, 0.1], abs=1e-6)


def test_what_is_not_possible(post: mrs.OccupancyGrid) -> None:
    tilted = mrs.LaserScanner(mount=(0.0, 0.0, 0.3, 0.0, 0.1, 0.0))
    with pytest.raises(ValueError, match="the scanner must not be tilted"):
        tilted.hits(post, [(0.0, 0.0, 0.0)])
    with pytest.raises(ValueError, match=r"poses must have shape \(N, 3\)"):
        mrs.LaserScanner().hits(post, np.zeros((2, 2)))
    with pytest.raises(ValueError, match="poses"):
        mrs.LaserScanner().hits(post, [(math.nan, 0.0, 0.0)])
