"""footprint: beams that have a width, at edges between segments, against a ray caster of a few lines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import mobile_robot_simulator as mrs

SEED = 77

EXACT = mrs.BeamModel(sigma_hit=1e-9, z_hit=1.0, z_max=0.0)
"""Readings that are the true ranges."""

DIVERGENCE = 0.01

MAX_RANGE = 30.0

FREE = mrs.OccupancyGrid(np.zeros((4, 4), np.int8), resolution=0.5)

Array = NDArray[np.float64]
Segments = list[tuple[tuple[float, float], tuple[float, float]]]


def cast(segments: Segments, angles: Array) -> Array:
    """Distance from the origin to the nearest segment along each angle; infinite if there is none."""
    nearest = np.full(angles.shape, np.inf)
    dx, dy = np.cos(angles), np.sin(angles)
    for (ax, ay), (bx, by) in segments:
        across = dx * (by - ay) - dy * (bx - ax)
        distance = (ax * (by - ay) - ay * (bx - ax)) / across
        along = (ax * dy - ay * dx) / across
        nearest = np.where((along >= 0) & (along <= 1) & (distance > 0) & (distance < nearest), distance, nearest)
    return np.where(nearest < MAX_RANGE, nearest, np.inf)


def plates(segments: Segments, **material: Any) -> list[Any]:
    """Obstacles whose side towards the origin is a segment: triangles that narrow away from it."""
    shapes = []
    for (ax, ay), (bx, by) in segments:
        tip = (0.501 * (ax + bx), 0.501 * (ay + by))
        # Counterclockwise.
        turn = (bx - ax) * (tip[1] - ay) - (by - ay) * (tip[0] - ax)
        corners = [(ax, ay), (bx, by), tip] if turn > 0 else [(bx, by), (ax, ay), tip]
        shapes.append((mrs.Shape.polygon(corners), (0.0, 0.0, 0.0)))
    return shapes


def readings(segments: Segments, angle: float, count: int, noise: mrs.BeamModel = EXACT, **options: Any) -> Array:
    """Readings of one beam from the origin."""
    laser = mrs.LaserScanner(beam_count=1, max_range=MAX_RANGE)
    surfaces = mrs.SurfaceModel(**{"beam_divergence": DIVERGENCE, "mixing_length": 0.5, **options})
    poses = np.tile([0.0, 0.0, angle], (count, 1))
    found = laser.scan_batch(FREE, poses, obstacles=plates(segments), noise=noise, surfaces=surfaces, seed=SEED)
    return found[:, 0].astype(float)


def step(near: float, far: float) -> Segments:
    """A plate up to the x axis in front of one on both sides of it."""
    return [((near, -2.0), (near, 0.0)), ((far, -2.0), (far, 2.0))]


def within(found: float, share: float, count: int) -> bool:
    """Whether a share fits its probability, at 6 sigma."""
    return abs(found - share) < 6.0 * math.sqrt(max(share * (1.0 - share), 1.0 / count) / count)


@pytest.mark.parametrize("place", [-0.45, -0.3, -0.1, 0.1, 0.3, 0.45])
def test_a_beam_at_a_deep_step_reads_one_of_the_surfaces_by_its_share(place: float) -> None:
    count = 20_000
    found = readings(step(2.0, 5.0), place * DIVERGENCE, count)
    share = 0.5 - place
    assert within((found < 2.01).mean(), share, count) and within((found > 4.99).mean(), 1.0 - share, count)
    assert ((found < 2.01) | (found > 4.99)).all()
    # Without a surface behind, the rest has no return.
    found = readings(step(2.0, 5.0)[:1], place * DIVERGENCE, count)
    assert within((found < 2.01).mean(), share, count) and within((found == MAX_RANGE).mean(), 1.0 - share, count)


@pytest.mark.parametrize("place", [-0.45, -0.3, 0.0, 0.1, 0.45])
def test_a_beam_at_a_shallow_step_reads_mixed_ranges_too(place: float) -> None:
    count = 20_000
    found = readings(step(2.0, 2.4), place * DIVERGENCE, count)
    share = 0.5 - place
    is_mixed = (found > 2.001) & (found < 2.399)
    # Some mixed ranges are as near to a surface as its own.
    assert within(is_mixed.mean(), 2.0 * share * (1.0 - share) * 0.398 / 0.4, count)
    assert within((found <= 2.001).mean(), share**2 + 2.0 * share * (1.0 - share) * 0.001 / 0.4, count)
    mixed = np.sort((found[is_mixed] - 2.001) / 0.398)
    # Massart's inequality, at 1e-9.
    critical = math.sqrt(-math.log(0.5e-9) / (2.0 * len(mixed)))
    assert np.abs(mixed - np.arange(len(mixed)) / len(mixed)).max() < critical + 1.0 / len(mixed)
    assert not (
        (found > 2.001) & (found < 2.399) & (readings(step(2.0, 2.4), place * DIVERGENCE, count, mixing_length=0.3) == found)
    ).any()


@pytest.mark.parametrize("angle", np.linspace(-0.013, 0.012, 11).tolist())
def test_readings_of_many_surfaces_have_the_distribution_of_the_formula(angle: float) -> None:
    """A pole, a slanting plate, a far plate at a grazing angle and nothing: against own draws on the ray caster."""
    scene: Segments = [
        ((3.0, -0.009), (3.0, 0.003)),
        ((3.3, -0.1), (3.4, -0.012)),
        ((3.5, 0.01), (9.0, 0.05)),
    ]
    count = 20_000
    found = np.sort(readings(scene, angle, count))
    ends = cast(scene, angle + DIVERGENCE * np.array([-0.5, 0.0, 0.5]))
    draw = np.random.default_rng(SEED)
    first, second = (cast(scene, angle + DIVERGENCE * (draw.random(count) - 0.5)) for _ in range(2))
    with np.errstate(invalid="ignore"):
        mixed = np.where(np.abs(second - first) <= 0.5, first + draw.random(count) * (second - first), first)
        inverse = 1.0 / ends
        bend, slope = abs(2 * inverse[1] - inverse[0] - inverse[2]), abs(inverse[2] - inverse[0])
        is_edge = bool(np.ptp(ends) > 0.1) and bend > 0.5 * slope
    expected = np.sort(np.minimum(mixed if is_edge else np.full(count, ends[1]), MAX_RANGE))
    places = np.concatenate([found, expected]) + 1e-5
    distance = np.abs(np.searchsorted(found, places) - np.searchsorted(expected, places)).max() / count
    # The inequality for two samples of the same size, at 1e-9.
    assert distance < math.sqrt(-math.log(0.5e-9) / count), distance


def test_the_surface_that_is_read_has_its_own_incidence() -> None:
    """1 - cos(incidence) is added: 0 for the near plate, 1 - cos(0.6) for the far one."""
    far = [(5.0 - 2.0 * math.tan(0.6), -2.0), (5.0 + 2.0 * math.tan(0.6), 2.0)]
    scene: Segments = [((2.0, -2.0), (2.0, 0.0)), (far[0], far[1])]
    found = readings(scene, 0.0, 2000, incidence_bias=1.0)
    assert ((abs(found - 2.0) < 1e-3) | (abs(found - 6.0 + math.cos(0.6)) < 0.03)).all()
    assert within((found < 3.0).mean(), 0.5, 2000)


def test_the_noise_of_a_hit_is_added_to_the_range_that_is_read() -> None:
    count = 20_000
    noise = mrs.BeamModel(sigma_hit=0.02, z_hit=0.9, z_max=0.1)
    found = readings(step(2.0, 5.0), 0.2 * DIVERGENCE, count, noise=noise)
    near, far = found[found < 3.0] - 2.0, found[(found > 3.0) & (found < 10.0)] - 5.0
    assert within(len(near) / count, 0.9 * 0.3, count) and within(len(far) / count, 0.9 * 0.7, count)
    assert near.std() == pytest.approx(0.02, rel=0.05) and far.std() == pytest.approx(0.02, rel=0.05)


def office() -> tuple[mrs.OccupancyGrid, Array]:
    grid = mrs.floor_plan("office", seed=1)
    return grid, np.array(grid.draw_free_poses(60, radius=0.3, seed=1))


def test_beams_that_meet_no_edge_keep_their_bytes() -> None:
    grid, poses = office()
    laser = mrs.LaserScanner(fov=math.tau, beam_count=720, max_range=MAX_RANGE)
    noise = mrs.BeamModel(z_rand=0.1)
    surfaces = mrs.SurfaceModel(beam_divergence=DIVERGENCE, edge_depth=0.3)
    found = laser.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=1)
    plain = laser.scan_batch(grid, poses, noise=noise, seed=1)
    ends = [
        laser.scan_batch(grid, poses + np.array([0.0, 0.0, side * DIVERGENCE])).astype(float) for side in (-0.5, 0.0, 0.5)
    ]
    right, middle, left = (1.0 / np.where(end < MAX_RANGE, end, np.inf) for end in ends)
    is_deep = np.ptp(np.array(ends), axis=0) > 0.3
    bend, slope = np.abs(2 * middle - left - right), np.abs(left - right)
    # Ranges of float32 leave some beams in doubt.
    may_be_edge, is_edge = is_deep & (bend > 0.499 * slope), is_deep & (bend > 0.501 * slope)
    assert np.array_equal(found[~may_be_edge], plain[~may_be_edge])
    assert 0.01 < is_edge.mean() < 0.2
    assert (found != plain)[is_edge].mean() > 0.6


def test_threads_chunks_and_single_scans_give_the_same_bytes() -> None:
    grid, poses = office()
    laser = mrs.LaserScanner(fov=math.tau, beam_count=200)
    options: dict[str, Any] = {
        "noise": mrs.BeamModel(),
        "surfaces": mrs.SurfaceModel(beam_divergence=0.02, correlation=0.5),
        "obstacles": [(mrs.Shape.disc(0.2), (poses[0][0] + 1.0, poses[0][1], 0.0))],
        "seed": 9,
    }
    whole = laser.scan_batch(grid, poses, **options, threads=1)
    assert whole.tobytes() == laser.scan_batch(grid, poses, **options, threads=3).tobytes()
    parts = [laser.scan_batch(grid, poses[index : index + 1], **options, first_index=index) for index in range(60)]
    assert np.concatenate(parts).tobytes() == whole.tobytes()


def test_each_beam_of_a_scan_that_takes_time_has_its_own_footprint() -> None:
    grid, poses = office()
    laser = mrs.LaserScanner(fov=math.tau, beam_count=100)
    twists = np.tile([0.5, 0.1, 0.9], (len(poses), 1))
    options: dict[str, Any] = {"noise": EXACT, "surfaces": mrs.SurfaceModel(beam_divergence=0.05), "seed": 3}
    swept = laser.scan_batch(grid, poses, twists=twists, scan_duration=0.3, **options)
    places = laser.beam_poses(poses, twists, 0.3)
    for scan in range(5):
        for beam in range(100):
            still = laser.scan_batch(grid, places[scan, beam : beam + 1], **options, first_index=scan)
            # Directions of the beams are computed in another way, which can differ in the last bit.
            assert swept[scan, beam] == pytest.approx(still[0, beam], abs=1e-5), (scan, beam)


def test_edges_behind_clear_glass_are_those_without_it() -> None:
    pane = (mrs.Shape.rectangle(0.02, 4.0).with_material(mrs.Material("glass", return_chance=0.0)), (1.0, 0.0, 0.0))
    laser = mrs.LaserScanner(fov=0.02, beam_count=50, max_range=MAX_RANGE)
    surfaces = mrs.SurfaceModel(beam_divergence=DIVERGENCE)
    poses = np.zeros((50, 3))
    options: dict[str, Any] = {"noise": EXACT, "surfaces": surfaces, "seed": 3}
    open_view = laser.scan_batch(FREE, poses, obstacles=plates(step(2.0, 5.0)), **options)
    through = laser.scan_batch(FREE, poses, obstacles=[pane, *plates(step(2.0, 5.0))], **options)
    assert 0.05 < np.mean(open_view[:, 1:] - open_view[:, :-1] > 1.0) and open_view.tobytes() == through.tobytes()
