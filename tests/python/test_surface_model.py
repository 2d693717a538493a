"""surface_model: readings by the incidence of a beam and with an error that stays at its place, against known walls."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
import reference

SEED = 77

EXACT = mrs.BeamModel(sigma_hit=1e-9, z_hit=1.0, z_max=0.0)
"""Readings that are the true ranges."""

COSINES = mrs.SurfaceModel(incidence_bias=1.0, incidence_limit=1.57)
"""Adds 1 - cos(incidence) to a range, so that the incidence can be read off."""

LASER = mrs.LaserScanner(fov=math.tau, beam_count=720, max_range=30.0)


def incidences(grid: mrs.OccupancyGrid, poses: Any, laser: mrs.LaserScanner = LASER, **options: Any) -> NDArray[np.float64]:
    """Cosine of the incidence of each beam as the model takes it, NaN without a return."""
    true = laser.scan_batch(grid, poses, **options).astype(float)
    found = laser.scan_batch(grid, poses, noise=EXACT, surfaces=COSINES, seed=1, **options).astype(float)
    cosines: NDArray[np.float64] = np.where(true < laser.max_range, 1.0 - (found - true), np.nan)
    return cosines


def half_plane(angle: float, size: int = 161, resolution: float = 0.05) -> mrs.OccupancyGrid:
    """A grid with a wall that starts at a line at an angle to the x axis, 1 m in front of the middle of the grid."""
    y, x = (np.mgrid[0:size, 0:size] + 0.5 - size / 2) * resolution
    cells = 100 * (y * math.cos(angle) - x * math.sin(angle) > 1.0)
    return mrs.OccupancyGrid(cells.astype(np.int8), resolution=resolution)


@pytest.mark.parametrize("angle", np.linspace(0.0, math.pi, 13)[:-1].tolist())
def test_incidences_on_slanted_walls_are_those_of_the_wall(angle: float) -> None:
    grid = half_plane(angle)
    middle = 161 * 0.05 / 2
    # No beam meets a corner exactly, where the normal is that of a side.
    cosines = incidences(grid, [(middle + 0.0123, middle - 0.0071, 0.0)])[0]
    expected = np.sin(LASER.angles - angle)
    # Far from the edge of the grid, where the wall ends.
    chosen = expected > 0.5
    assert chosen.sum() > 200
    off = np.abs(np.degrees(np.arccos(np.clip(cosines[chosen], -1, 1)) - np.arccos(expected[chosen])))
    assert np.median(off) < 1.5 and off.max() < 9.0, (np.median(off), off.max())


def test_incidences_on_walls_along_the_axes_are_exact() -> None:
    cells = np.zeros((80, 100), np.int8)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 100, 100, 100, 100
    grid = mrs.OccupancyGrid(cells, resolution=0.1, origin=(-2.0, 1.0, 0.4))
    poses = [(1.0, 5.0, 0.3), (0.5, 4.0, -2.0)]
    found = incidences(grid, poses)
    _, hits = LASER.hits(grid, poses)
    # In corners, both take the side through which the beam enters the cell.
    assert np.nanmax(np.abs(found - np.cos(hits.astype(float)))) < 1e-5


def shapes() -> list[Any]:
    return [
        (mrs.Shape.disc(0.4), (2.0, 0.5, 0.0)),
        (mrs.Shape.polygon([(-0.5, -0.3), (0.5, -0.3), (0.0, 0.6)]), (-1.0, 1.5, 0.7)),
        (mrs.Shape.polygon([(-0.2, -1.0), (0.2, -1.0), (0.2, 1.0), (-0.2, 1.0)]), (0.5, -2.0, 1.2)),
    ]


def test_incidences_on_obstacles_are_exact() -> None:
    free = mrs.OccupancyGrid(np.zeros((10, 10), np.int8), resolution=0.5, origin=(-3.0, -2.0, 0.2))
    poses = [(0.0, 0.0, 0.0), (0.3, -0.4, 2.0), (1.9, 0.4, 0.0)]
    found = incidences(free, poses, obstacles=shapes())
    surfaces, hits = LASER.hits(free, poses, obstacles=shapes())
    assert {0, 1, 2, 3} > set(np.unique(surfaces[surfaces > 0] - 1).tolist()) >= {0, 1, 2}
    expected = np.where(surfaces >= 0, np.where(np.isnan(hits), 1.0, np.cos(hits.astype(float))), np.nan)
    assert np.array_equal(np.isnan(found), np.isnan(expected))
    assert np.nanmax(np.abs(found - expected)) < 1e-5


def test_incidences_of_scans_that_take_time_are_those_of_each_beam() -> None:
    grid = mrs.floor_plan("office", seed=1)
    pose = np.array(grid.draw_free_poses(1, radius=0.5, seed=3))
    twist = [(0.4, 0.0, 1.0)]
    laser = mrs.LaserScanner(fov=math.tau, beam_count=100, max_range=30.0)
    x, y, _ = pose[0]
    moving = [(mrs.Shape.disc(0.2), (x + 0.9, y, 0.0), (0.3, 0.1, 0.0))]
    swept = incidences(grid, pose, laser, twists=twist, scan_duration=0.5, obstacles=moving)[0]
    places = laser.beam_poses(pose, twist, 0.5)[0]
    times = laser.time_increment(0.5) * np.arange(100)
    still = [
        incidences(
            grid,
            places[beam : beam + 1],
            laser,
            obstacles=[(mrs.Shape.disc(0.2), (x + 0.9 + 0.3 * time, y + 0.1 * time, 0.0))],
        )
        for beam, time in enumerate(times.tolist())
    ]
    expected = np.array([row[0, beam] for beam, row in enumerate(still)])
    assert np.nanmax(np.abs(swept - expected)) < 1e-5
    # In no time, a scan has the bytes of an instant.
    model = mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.03, correlation=0.4)
    options: dict[str, Any] = {"noise": mrs.BeamModel(), "surfaces": model, "seed": 5}
    instant = laser.scan_batch(grid, pose, obstacles=[moving[0][:2]], **options)
    assert (
        laser.scan_batch(grid, pose, scan_duration=0.0, obstacles=[moving[0][:2]], **options).tobytes() == instant.tobytes()
    )


def wall_readings(incidence: float, count: int, surfaces: mrs.SurfaceModel, noise: mrs.BeamModel) -> NDArray[np.float64]:
    """Readings of one beam that meets a wall at x = 4 m, from 2 m away, at an incidence."""
    cells = np.zeros((400, 100), np.int8)
    cells[:, 80] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.05)
    poses = np.tile([4.0 - 2.0 * math.cos(incidence), 10.0, incidence], (count, 1))
    laser = mrs.LaserScanner(beam_count=1, max_range=10.0)
    return laser.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=SEED)[:, 0].astype(float)


def distance_to_normal(readings: NDArray[np.float64], mean: float, sigma: float) -> float:
    """Distance of Kolmogorov and Smirnov to a normal distribution."""
    ordered = np.sort(readings)
    expected = reference.normal_cdf((ordered - mean) / sigma)
    steps = np.arange(len(ordered) + 1) / len(ordered)
    return float(max(np.abs(expected - steps[1:]).max(), np.abs(expected - steps[:-1]).max()))


@pytest.mark.parametrize("incidence", [0.0, 0.6, 1.1, 1.4])
@pytest.mark.parametrize("power", [0.5, 1.0])
def test_readings_by_incidence_fit_the_model(incidence: float, power: float) -> None:
    count = 50_000
    limit = 1.3
    noise = mrs.BeamModel(sigma_hit=0.02, z_hit=1.0, z_max=0.0, range_offset=0.01, range_sigma_per_metre=0.015)
    surfaces = mrs.SurfaceModel(incidence_sigma=power, incidence_bias=0.05, incidence_limit=limit)
    found = wall_readings(incidence, count, surfaces, noise)
    cos = math.cos(min(incidence, limit))
    mean, sigma = 2.0 + 0.01 + 0.05 * (1.0 - cos), 0.03 * cos**-power
    # Massart's inequality, at 1e-9; 1e-4 allows for the rounding to float32.
    critical = math.sqrt(-math.log(0.5e-9) / (2.0 * count)) + 1e-4
    assert distance_to_normal(found, mean, sigma) < critical
    assert distance_to_normal(found, mean, 1.06 * sigma) > critical
    assert distance_to_normal(found, mean + 0.06 * sigma, sigma) > critical


@pytest.mark.parametrize("correlation", [0.0, 0.3, 1.0])
def test_part_of_the_error_is_fixed_for_each_beam_and_cell(correlation: float) -> None:
    """A robot that stands: the variance between beams of their means, and that of each beam over the scans."""
    grid = half_plane(0.0)
    middle = 161 * 0.05 / 2
    laser = mrs.LaserScanner(angle_min=1.2, angle_max=1.9, beam_count=1000, max_range=10.0)
    pose = [(middle, middle, 0.0)]
    surfaces = mrs.SurfaceModel(correlation=correlation)
    noise = mrs.BeamModel(sigma_hit=0.02, z_hit=1.0, z_max=0.0)
    scans = 200
    found = laser.scan_batch(grid, pose * scans, noise=noise, surfaces=surfaces, seed=SEED).astype(float)
    errors = (found - laser.scan_batch(grid, pose).astype(float)) / 0.02
    fresh = errors.var(axis=0, ddof=1).mean()
    fixed = errors.mean(axis=0).var(ddof=1) - fresh / scans
    assert fresh == pytest.approx(1.0 - correlation, abs=0.02)
    assert fixed == pytest.approx(correlation, abs=0.07)
    # All together, readings have the variance and the shape of those without correlation.
    if correlation < 1.0:
        assert errors.var() == pytest.approx(1.0, abs=0.07)
    one_scan = errors[0]
    assert distance_to_normal(one_scan, 0.0, 1.0) < math.sqrt(-math.log(0.5e-9) / 2000.0)
    # Neighbours are independent, and so are other seeds and other cells.
    pairs = errors.mean(axis=0)
    assert abs(np.corrcoef(pairs[1:], pairs[:-1])[0, 1]) < 0.15
    other = laser.scan_batch(grid, pose, noise=noise, surfaces=surfaces, seed=SEED + 1).astype(float)[0] - found[0]
    moved = [(middle + 0.3, middle, 0.0)]
    options: dict[str, Any] = {"noise": noise, "surfaces": surfaces, "first_index": scans}
    elsewhere = laser.scan_batch(grid, moved, seed=SEED, **options).astype(float)
    elsewhere = (elsewhere - laser.scan_batch(grid, moved).astype(float)) / 0.02
    assert other.std() / 0.02 == pytest.approx(math.sqrt(2.0), abs=0.15)
    assert abs(np.corrcoef(elsewhere[0], one_scan)[0, 1]) < 0.15


def test_all_parts_together_fit_the_model() -> None:
    """Readings of all beams of an office, each with its own sigma, center and part of the mixture."""
    grid = mrs.floor_plan("office", seed=2)
    poses = grid.draw_free_poses(400, radius=0.3, seed=2)
    laser = mrs.LaserScanner(beam_count=200, max_range=12.0)
    weights = {"z_hit": 0.7, "z_short": 0.1, "z_max": 0.1, "z_rand": 0.1}
    numbers = {"sigma_hit": 0.01, "lambda_short": 0.7, "range_offset": 0.02, "range_sigma_per_metre": 0.004}
    noise = mrs.BeamModel(**numbers, **weights)
    surfaces = mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.03, correlation=0.5)
    true = laser.scan_batch(grid, poses).astype(float)
    cosines = np.maximum(incidences(grid, poses, laser), math.cos(1.5))
    found = laser.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=SEED).astype(float)
    chosen = (true < 12.0) & (true > 0.5) & (true < 11.0)
    true, cosines, found = true[chosen], cosines[chosen], found[chosen]
    sigma = np.maximum(0.01, 0.004 * true) * cosines**-0.5
    center = true + 0.02 + 0.03 * (1.0 - cosines)
    # The distribution function of each reading makes readings below the maximum uniform, up to the mass at the maximum.
    hit = reference.normal_cdf((found - center) / sigma)
    short = np.expm1(-0.7 * np.minimum(found, true)) / np.expm1(-0.7 * true)
    uniform = np.sort((0.7 * hit + 0.1 * short + 0.1 * found / 12.0)[found < np.float32(12.0)])
    count = len(true)
    assert abs(1.0 - len(uniform) / count - 0.1) < 0.01
    assert np.abs(np.searchsorted(uniform, np.linspace(0, 0.9, 200)) / count - np.linspace(0, 0.9, 200)).max() < 0.012


def test_the_curve_of_real_robots_is_reproduced() -> None:
    """Spread and bias in six bands of incidence, measured on public logs of robots; the parameters are those of the docs."""
    measured = [0.033, 0.032, 0.036, 0.044, 0.054, 0.082]
    grid = mrs.floor_plan("office", seed=1)
    poses = grid.draw_free_poses(300, radius=0.3, seed=1)
    laser = mrs.LaserScanner(fov=math.pi, beam_count=180, max_range=30.0)
    noise = mrs.BeamModel(sigma_hit=0.032, range_offset=0.03, z_hit=1.0, z_max=0.0)
    surfaces = mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.04)
    true = laser.scan_batch(grid, poses)
    residuals = laser.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=1) - true
    _, hits = laser.hits(grid, poses)
    inside = [residuals[np.degrees(hits) // 15 == band] for band in range(6)]
    biases = [float(np.median(band)) for band in inside]
    spreads = [1.4826 * float(np.median(np.abs(band - bias))) for band, bias in zip(inside, biases, strict=True)]
    assert spreads == pytest.approx(measured, rel=0.1)
    assert (biases[0], biases[-1]) == pytest.approx((0.030, 0.059), abs=0.002)
    assert biases == sorted(biases)


def test_what_is_off_leaves_the_bytes_as_they_are() -> None:
    grid = mrs.floor_plan("office", seed=1)
    poses = grid.draw_free_poses(20, radius=0.3, seed=1)
    noise = mrs.BeamModel(sigma_hit=0.05, z_hit=0.8, z_short=0.1, z_rand=0.1)
    plain = LASER.scan_batch(grid, poses, noise=noise, seed=1)
    off = LASER.scan_batch(grid, poses, noise=noise, surfaces=mrs.SurfaceModel(), seed=1)
    assert plain.tobytes() == off.tobytes()
    # Switched on, with numbers that change nothing: the same random numbers.
    tiny = LASER.scan_batch(grid, poses, noise=noise, surfaces=mrs.SurfaceModel(incidence_bias=1e-300), seed=1)
    assert plain.tobytes() == tiny.tobytes()


def test_threads_and_chunks_do_not_change_the_bytes() -> None:
    grid = mrs.floor_plan("office", seed=1)
    poses = np.array(grid.draw_free_poses(60, radius=0.3, seed=1))
    options: dict[str, Any] = {
        "noise": mrs.BeamModel(sigma_hit=0.05, z_rand=0.1, range_step=0.001),
        "surfaces": mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.02, correlation=0.5),
        "obstacles": [(mrs.Shape.disc(0.3), (poses[0][0] + 1.0, poses[0][1], 0.0))],
    }
    whole = LASER.scan_batch(grid, poses, **options, seed=9, threads=1)
    assert LASER.scan_batch(grid, poses, **options, seed=9, threads=3).tobytes() == whole.tobytes()
    parts = [
        LASER.scan_batch(grid, poses[start : start + 7], **options, seed=9, first_index=start) for start in range(0, 60, 7)
    ]
    assert np.concatenate(parts).tobytes() == whole.tobytes()


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"incidence_sigma": -0.5}, ValueError, "incidence_sigma must be in 0..4, got -0.5"),
        ({"incidence_sigma": math.nan}, ValueError, "incidence_sigma must be in 0..4, got NaN"),
        ({"incidence_limit": 1.6}, ValueError, "incidence_limit must be at least 0 and below π/2, got 1.6"),
        ({"incidence_bias": math.inf}, ValueError, "incidence_bias must be finite, got inf"),
        ({"correlation": 1.01}, ValueError, "correlation must be in 0..1, got 1.01"),
        ({"correlation": "much"}, TypeError, "correlation"),
        ({"sigma": 0.5}, TypeError, "sigma"),
    ],
)
def test_invalid_models_are_rejected(options: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        mrs.SurfaceModel(**options)
    assert message in reference.message_of(caught.value)


def test_invalid_uses_are_rejected() -> None:
    grid, poses = mrs.floor_plan("office", seed=1), np.zeros((1, 3))
    surfaces = mrs.SurfaceModel(correlation=0.5)
    with pytest.raises(ValueError, match="surfaces need noise, a BeamModel, got None"):
        LASER.scan_batch(grid, poses, surfaces=surfaces)
    with pytest.raises(TypeError, match="surfaces must be a SurfaceModel, got float"):
        LASER.scan_batch(grid, poses, noise=EXACT, surfaces=0.5, seed=1)  # type: ignore[arg-type]
    tilted = mrs.LaserScanner(mount=(0.0, 0.0, 1.0, 0.0, 0.3, 0.0))
    with pytest.raises(ValueError, match="tilted"):
        tilted.scan_batch(grid, poses, noise=EXACT, surfaces=surfaces, seed=1)


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda model: pickle.loads(pickle.dumps(model))])
def test_copies_equal_the_model(duplicate: Any) -> None:
    model = mrs.SurfaceModel(incidence_sigma=0.5, incidence_limit=1.4, incidence_bias=-0.01, correlation=0.25)
    assert repr(duplicate(model)) == repr(model) == repr(eval(repr(model), {"SurfaceModel": mrs.SurfaceModel}))
