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


def no_return_chance(distance: Any, cos: Any, share: Any, reference_range: float) -> Any:
    """Chance of no return, as the formula of the documentation says."""
    q = distance**2 / (reference_range**2 * share * cos)
    return q**4 / (1.0 + q**4)


def lost(distance: float, incidence: float, material: Any, count: int, as_obstacle: bool, **options: float) -> int:
    """How many of the beams that meet a wall of a material, at a distance and an incidence, have no return."""
    x, y = 40.0, 50.0
    pose = [x - distance * math.cos(incidence), y - distance * math.sin(incidence), incidence]
    cells = np.zeros((200, 100), np.int8)
    obstacles = []
    if as_obstacle:
        obstacles = [(mrs.Shape.rectangle(1.0, 90.0).with_material(material), (x + 0.5, y, 0.0))]
    else:
        cells[:, 80] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.5).with_materials(np.zeros(cells.shape, np.uint8), table=[material])
    # Some beams of each scan, and some scans: the beams are all but parallel.
    laser = mrs.LaserScanner(fov=1e-6, beam_count=50, max_range=60.0)
    found = laser.scan_batch(
        grid,
        np.tile(pose, (count // 50, 1)),
        obstacles=obstacles,
        noise=mrs.BeamModel(sigma_hit=0.01, z_hit=1.0, z_max=0.0),
        surfaces=mrs.SurfaceModel(**options),
        seed=SEED,
    )
    assert np.all((np.abs(found - distance) < 0.5) | (found == 60.0))
    return int(np.sum(found == 60.0))


@pytest.mark.parametrize("as_obstacle", [False, True])
def test_the_share_of_beams_without_a_return_fits_the_formula(as_obstacle: bool) -> None:
    count, reference_range, limit = 10_000, 30.0, 1.4
    cases = [
        (distance, incidence, reflectivity)
        for distance in (4.0, 12.0, 28.0, 38.0)
        for incidence in (0.0, 0.7, 1.2, 1.55)
        for reflectivity in (1.0, 0.3, 0.024)
        if distance * math.cos(incidence) < 39.0
    ]
    counts = [
        lost(
            distance,
            incidence,
            mrs.Material(reflectivity=reflectivity),
            count,
            as_obstacle,
            reference_range=reference_range,
            incidence_limit=limit,
        )
        for distance, incidence, reflectivity in cases
    ]
    distances, angles, shares = np.array(cases).T

    def chi_square(reference: float, limit: float) -> tuple[float, int]:
        chances = no_return_chance(distances, np.cos(np.minimum(angles, limit)), shares, reference)
        # Where a normal distribution is a good approximation of the binomial one.
        fits = (chances * count > 20) & ((1.0 - chances) * count > 20)
        deviations = (np.array(counts) - count * chances)[fits] ** 2 / (count * chances * (1.0 - chances))[fits]
        assert np.all(np.abs(np.array(counts) / count - chances)[~fits] < 0.01)
        return float(deviations.sum()), int(fits.sum())

    found, cells = chi_square(reference_range, limit)
    assert cells >= 15
    # Seven standard deviations of the chi-square distribution above its mean.
    critical = cells + 7.0 * math.sqrt(2.0 * cells)
    assert found < critical, (found, cells)
    assert chi_square(1.02 * reference_range, limit)[0] > critical
    assert chi_square(reference_range, 1.39)[0] > critical


def test_a_beam_without_a_return_reads_as_one_that_meets_nothing_and_others_keep_their_bytes() -> None:
    grid = mrs.floor_plan("office", seed=1)
    poses = grid.draw_free_poses(100, radius=0.3, seed=1)
    empty = mrs.OccupancyGrid(np.zeros((4, 4), np.int8), resolution=0.1)
    noise = mrs.BeamModel(sigma_hit=0.05, z_hit=0.8, z_short=0.1, z_max=0.02, z_rand=0.1, range_step=0.01)
    parts = {"incidence_sigma": 0.5, "incidence_bias": 0.02, "correlation": 0.5}
    for others in ({}, parts):
        options: dict[str, Any] = {"noise": noise, "seed": SEED}
        all_return = LASER.scan_batch(grid, poses, surfaces=mrs.SurfaceModel(**others), **options)
        nothing = LASER.scan_batch(empty, poses, surfaces=mrs.SurfaceModel(**others), **options)
        found = LASER.scan_batch(grid, poses, surfaces=mrs.SurfaceModel(**others, reference_range=6.0), **options)
        assert np.all((found == all_return) | (found == nothing))
        is_lost = found != all_return
        assert 0.05 < is_lost.mean() < 0.5
        # Whether a beam is lost has nothing to do with the number that the noise draws for it.
        true = LASER.scan_batch(grid, poses)
        errors = (all_return - true) / 0.05
        if not others:
            lost_errors, kept_errors = (errors[which & (np.abs(errors) < 4.0)] for which in (is_lost, ~is_lost))
            assert abs(lost_errors.mean()) < 0.1
            assert abs(lost_errors.std() / kept_errors.std() - 1.0) < 0.05


def mirror_room(kind: str, end: str) -> mrs.OccupancyGrid:
    """A room of 10 m by 10 m with walls of one material, and in it a column of clear glass or a mirror at x = 8 m."""
    cells = np.zeros((100, 100), np.int8)
    cells[0], cells[-1], cells[:, 0], cells[:, -1], cells[:, 80] = 100, 100, 100, 100, 100
    numbers = np.zeros(cells.shape, np.uint8)
    numbers[1:-1, 80] = 1
    table = [
        end,
        mrs.Material("glass", reflectivity=0.08, return_chance=0.0) if kind == "glass" else mrs.Material.named("mirror"),
    ]
    return mrs.OccupancyGrid(cells, resolution=0.1).with_materials(numbers, table=table)


@pytest.mark.parametrize(("kind", "light"), [("glass", 0.92**2), ("mirror", 0.9**2)])
@pytest.mark.parametrize("duration", [None, 0.0])
def test_beyond_glass_and_mirrors_the_surface_at_the_end_counts(kind: str, light: float, duration: float | None) -> None:
    """The beam meets x = 8 m at an incidence of 1 rad, and ends at y = 9.9 m, from there or beyond, at π/2 - 1."""
    laser = mrs.LaserScanner(fov=1e-6, beam_count=50, max_range=30.0)
    pose = [(7.0, 7.0, 1.0)]
    length, cos = 2.9 / math.sin(1.0), math.sin(1.0)
    timed: dict[str, Any] = {} if duration is None else {"scan_duration": duration}
    found = incidences(mirror_room(kind, "wall"), pose, laser, **timed)
    np.testing.assert_allclose(laser.scan_batch(mirror_room(kind, "wall"), pose, **timed), length, rtol=1e-5)
    np.testing.assert_allclose(found, cos, atol=1e-5)
    # An obstacle on the way, in the mirror image or behind the glass: its exact normal, which is turned by 0.4 rad.
    side = 1.0 if kind == "glass" else -1.0
    x = 8.0 + side * (2.0 / math.tan(1.0) - 1.0)
    plate = (mrs.Shape.rectangle(1.0, 0.1).with_material("dark"), (x, 9.0, 0.4 * side))
    found = incidences(mirror_room(kind, "wall"), pose, laser, obstacles=[plate], **timed)
    np.testing.assert_allclose(found, math.sin(1.0 - 0.4), atol=1e-5)
    for end, obstacles, reflectivity, distance, cosine in (
        ("wall", [], 1.0, length, cos),
        ("dark", [], 0.024, length, cos),
        ("wall", [plate], 0.024, None, math.sin(0.6)),
    ):
        grid = mirror_room(kind, end)
        true = float(laser.scan_batch(grid, pose, obstacles=obstacles)[0, 25]) if distance is None else distance
        # The light at which three of four beams return.
        reference_range = true / math.sqrt(light * reflectivity * cosine) * 3.0**0.125
        count = 400
        found = laser.scan_batch(
            grid,
            pose * count,
            obstacles=obstacles,
            noise=EXACT,
            surfaces=mrs.SurfaceModel(reference_range=reference_range),
            seed=SEED,
            **timed,
        )
        assert abs(np.mean(found == 30.0) - 0.25) < 6.0 * math.sqrt(0.25 * 0.75 / found.size), end


def test_the_fixed_error_beyond_a_mirror_is_that_of_the_cell_at_the_end() -> None:
    laser = mrs.LaserScanner(fov=1e-6, beam_count=200, max_range=30.0)
    grid, surfaces = mirror_room("mirror", "wall"), mrs.SurfaceModel(correlation=1.0)
    options: dict[str, Any] = {"noise": mrs.BeamModel(sigma_hit=0.02, z_hit=1.0, z_max=0.0), "surfaces": surfaces}

    def errors(x: float, y: float) -> NDArray[np.float64]:
        pose = [(x, y, 1.0)]
        found = laser.scan_batch(grid, pose * 2, seed=SEED, **options).astype(float)
        assert np.array_equal(found[0], found[1])
        result: NDArray[np.float64] = (found[0] - laser.scan_batch(grid, pose)[0]) / 0.02
        return result

    here = errors(7.0, 7.0)
    assert here.std() == pytest.approx(1.0, abs=0.25)
    # From 10 cm farther along the beam to the same cell; and to a cell 20 cm away.
    np.testing.assert_allclose(errors(7.0 - 0.1 * math.cos(1.0), 7.0 - 0.1 * math.sin(1.0)), here, atol=1e-3)
    assert abs(np.corrcoef(errors(7.2, 7.0), here)[0, 1]) < 0.35


def test_all_parts_together_fit_the_model() -> None:
    """Readings of all beams of an office, each with its own sigma, center, chance of no return and part of the mixture."""
    grid = mrs.floor_plan("office", seed=2)
    poses = grid.draw_free_poses(400, radius=0.3, seed=2)
    laser = mrs.LaserScanner(beam_count=200, max_range=12.0)
    weights = {"z_hit": 0.7, "z_short": 0.1, "z_max": 0.1, "z_rand": 0.1}
    numbers = {"sigma_hit": 0.01, "lambda_short": 0.7, "range_offset": 0.02, "range_sigma_per_metre": 0.004}
    step = 0.04
    noise = mrs.BeamModel(**numbers, **weights, range_step=step)
    surfaces = mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.03, correlation=0.5, reference_range=8.0)
    materials = np.random.default_rng(SEED).integers(0, 2, grid.shape).astype(np.uint8)
    grid = grid.with_materials(materials, table=[mrs.Material(reflectivity=0.9), mrs.Material(reflectivity=0.9)])
    true = laser.scan_batch(grid, poses).astype(float)
    cosines = np.maximum(incidences(grid, poses, laser), math.cos(1.5))
    found = laser.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=SEED).astype(float)
    chosen = (true < 12.0) & (true > 0.5) & (true < 11.0)
    true, cosines, found = true[chosen], cosines[chosen], found[chosen]
    sigma = np.maximum(0.01, 0.004 * true) * cosines**-0.5
    center = true + 0.02 + 0.03 * (1.0 - cosines)
    chance = no_return_chance(true, cosines, 0.9, 8.0)
    assert 0.05 < chance.mean() < 0.95

    def distribution(reading: NDArray[np.float64]) -> NDArray[np.float64]:
        """Probability of readings up to this one, below the maximum range."""
        hit = reference.normal_cdf((reading - center) / sigma)
        short = np.expm1(-0.7 * np.minimum(reading, true)) / np.expm1(-0.7 * true)
        short_of_nothing = np.expm1(-0.7 * reading) / np.expm1(-0.7 * 12.0)
        returns = (1.0 - chance) * (0.7 * hit + 0.1 * short) + chance * 0.1 * short_of_nothing
        result: NDArray[np.float64] = returns + 0.1 * reading / 12.0
        return result

    # Each reading is a multiple of the step. It gets a random place among the numbers that are rounded to it. Then the
    # shares of the distribution up to these places are uniform, for readings below the maximum.
    is_below = found < np.float32(12.0)
    assert np.abs(found[is_below] / step - np.round(found[is_below] / step)).max() < 1e-4
    last = (found > 12.0 - 1.5 * step) & is_below
    low, high = distribution(np.maximum(found - step / 2, 0.0)), distribution(np.where(last, 12.0, found + step / 2))
    draws = np.random.default_rng(SEED).random(len(found))
    mass = 0.9 - 0.7 * chance
    uniform = np.sort(((low + draws * (high - low)) / mass)[is_below])
    count, places = len(uniform), np.linspace(0, 1, 200)
    assert abs(is_below.mean() - mass.mean()) < 6.0 * math.sqrt(float(np.mean(mass * (1.0 - mass))) / len(true))
    # Massart's inequality, at 1e-9.
    critical = math.sqrt(-math.log(0.5e-9) / (2.0 * count))
    assert np.abs(np.searchsorted(uniform, places) / count - places).max() < critical


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
    for tiny in (mrs.SurfaceModel(incidence_bias=1e-300), mrs.SurfaceModel(reference_range=1e30)):
        assert plain.tobytes() == LASER.scan_batch(grid, poses, noise=noise, surfaces=tiny, seed=1).tobytes()


def test_threads_and_chunks_do_not_change_the_bytes() -> None:
    grid = mrs.floor_plan("office", seed=1)
    poses = np.array(grid.draw_free_poses(60, radius=0.3, seed=1))
    options: dict[str, Any] = {
        "noise": mrs.BeamModel(sigma_hit=0.05, z_rand=0.1, range_step=0.001),
        "surfaces": mrs.SurfaceModel(incidence_sigma=0.5, incidence_bias=0.02, correlation=0.5, reference_range=9.0),
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
        ({"reference_range": -1.0}, ValueError, "reference_range must be at least 0, got -1"),
        ({"reference_range": math.inf}, ValueError, "reference_range must be at least 0, got inf"),
        ({"beam_divergence": 0.25}, ValueError, "beam_divergence must be in 0..0.2 rad, got 0.25"),
        ({"edge_depth": -0.1}, ValueError, "edge_depth must be at least 0, got -0.1"),
        ({"mixing_length": math.nan}, ValueError, "mixing_length must be at least 0, got NaN"),
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
    model = mrs.SurfaceModel(
        incidence_sigma=0.5,
        incidence_limit=1.4,
        incidence_bias=-0.01,
        correlation=0.25,
        reference_range=20.0,
        beam_divergence=0.01,
    )
    assert repr(duplicate(model)) == repr(model) == repr(eval(repr(model), {"SurfaceModel": mrs.SurfaceModel}))
