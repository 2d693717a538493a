"""LikelihoodField: table 6.3 of the book, on distances that are compared with those to all blocking cells."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs

FIELD = mrs.LikelihoodField(sigma_hit=0.3, z_hit=0.8, z_rand=0.2, max_distance=1.0)
LASER = mrs.LaserScanner(beam_count=61, min_range=0.1, max_range=9.0, mount=(0.1, 0.0, 0.2))


def poses(seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform((-8.0, -6.0, -3.0), (8.0, 6.0, 3.0), (200, 3))


def distances(grid: mrs.OccupancyGrid, max_distance: float) -> np.ndarray:
    """Returns the distance of each cell to the nearest blocking one, found by comparing all pairs."""
    rows, cols = np.indices(grid.cells.shape)
    blocking = np.argwhere(grid.cells >= grid.occupied_threshold)
    squares = [(rows - row) ** 2 + (cols - col) ** 2 for row, col in blocking]
    result: np.ndarray = np.minimum(np.sqrt(np.min(squares, axis=0)) * grid.resolution, max_distance).astype(np.float32)
    return result


def test_distances_are_those_to_the_nearest_blocking_cell(room: mrs.OccupancyGrid) -> None:
    small = mrs.OccupancyGrid(room.cells[:60, :50], resolution=0.1)
    assert np.array_equal(small.distances(0.75), distances(small, 0.75))
    out = np.empty(small.cells.shape, np.float32)
    assert small.distances(2.0, out=out) is out
    assert np.array_equal(out, distances(small, 2.0))
    for wrong in (0.0, -1.0, math.nan, 26.0):
        with pytest.raises(ValueError, match="max_distance must be positive and at most 255 cells, got"):
            small.distances(wrong)


def test_scores_are_those_of_the_book(room: mrs.OccupancyGrid) -> None:
    field = room.distances(FIELD.max_distance).astype(np.float64)
    scan = LASER.mark_invalid(LASER.scan(room, (1.0, 2.0, 0.5)))
    found = LASER.log_likelihood(room, poses(), scan, noise=FIELD, temper=0.5)
    assert found.shape == (200,) and found.dtype == np.float64
    compared = 0
    for pose, score in zip(poses(), found, strict=True):
        cells = [room.cell_at(x, y) for x, y in LASER.end_points(pose, scan)]
        if None in cells:
            continue
        near = np.array([field[cell] for cell in cells if cell is not None])
        likelihood = 0.8 * np.exp(-(near**2) / (2 * 0.3**2)) / (0.3 * math.sqrt(2 * math.pi)) + 0.2 / LASER.max_range
        assert score == pytest.approx(0.5 * np.log(likelihood).sum(), rel=1e-6)
        compared += 1
    assert compared > 20


def test_the_right_pose_scores_best(room: mrs.OccupancyGrid) -> None:
    scans = LASER.scan_batch(room, poses(), noise=mrs.BeamModel(sigma_hit=0.02), seed=1)
    for index in range(0, 200, 20):
        assert LASER.log_likelihood(room, poses(), scans[index], noise=FIELD).argmax() == index
    each = LASER.log_likelihood(room, poses(), scans, noise=FIELD)
    assert each[20] == LASER.log_likelihood(room, poses()[20:21], scans[20], noise=FIELD)[0]


def test_weights_are_scaled_and_shown() -> None:
    field = mrs.LikelihoodField(z_hit=3.0, z_rand=1.0)
    assert (field.z_hit, field.z_rand) == (0.75, 0.25)
    assert repr(field) == "LikelihoodField(sigma_hit=0.2, z_hit=0.75, z_rand=0.25, max_distance=2.0)"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sigma_hit": 0.0}, "sigma_hit must be positive, got 0"),
        ({"z_hit": -1.0}, "z_hit must be at least 0, got -1"),
        ({"z_hit": 0.0, "z_rand": 0.0}, r"z_hit \+ z_rand must be positive, got 0"),
        ({"max_distance": math.inf}, "max_distance must be positive, got inf"),
    ],
)
def test_bad_parameters_are_named(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        mrs.LikelihoodField(**arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"obstacles": [(mrs.Shape.disc(0.5), (0.0, 0.0, 0.0))]}, "a LikelihoodField needs scans without obstacles"),
        ({"scan_duration": 0.1}, "a LikelihoodField needs scans without obstacles and without scan_duration"),
        ({"noise": mrs.LikelihoodField(max_distance=1000.0)}, "max_distance must be positive and at most 255 cells"),
        ({"temper": 0.0}, "temper must be positive, got 0"),
        ({"beams": [61]}, "beams must be less than beam_count, got 61"),
    ],
)
def test_bad_calls_are_refused(room: mrs.OccupancyGrid, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        LASER.log_likelihood(room, poses(), np.ones(61, np.float32), **{"noise": FIELD, **arguments})
    with pytest.raises(TypeError, match="noise must be a BeamModel or a LikelihoodField, got str"):
        LASER.log_likelihood(room, poses(), np.ones(61, np.float32), noise="field")  # type: ignore[arg-type]
