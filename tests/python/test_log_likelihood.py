"""LaserScanner.log_likelihood: the sum of the logarithms of BeamModel.likelihood, without an array of true ranges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs

NOISE = mrs.BeamModel(sigma_hit=0.2, lambda_short=0.7, z_hit=0.7, z_short=0.1, z_max=0.1, z_rand=0.1)
LASER = mrs.LaserScanner(beam_count=61, min_range=0.1, max_range=9.0, mount=(0.1, 0.0, 0.2))
DISC = mrs.Shape.disc(0.6)


def poses(seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform((-8.0, -6.0, -3.0), (8.0, 6.0, 3.0), (200, 3))


def summed(room: mrs.OccupancyGrid, readings: np.ndarray, beams: Any = slice(None), **options: Any) -> np.ndarray:
    """Returns the sums of the logarithms of the likelihoods."""
    true_ranges = LASER.scan_batch(room, poses(), **options)
    readings = np.broadcast_to(readings, true_ranges.shape)
    likelihood = NOISE.likelihood(readings, true_ranges, LASER.max_range, min_range=LASER.min_range)
    result: np.ndarray = np.log(likelihood)[:, beams].sum(axis=1)
    return result


def test_it_is_the_sum_of_the_logarithms_of_likelihoods(room: mrs.OccupancyGrid) -> None:
    scans = LASER.mark_invalid(LASER.scan_batch(room, poses(2), noise=NOISE, seed=1))
    scans[:, 5] = np.nan
    one = scans[0]
    found = LASER.log_likelihood(room, poses(), one, noise=NOISE)
    assert found.dtype == np.float64 and found.shape == (200,)
    assert np.allclose(found, summed(room, one), rtol=1e-9, atol=1e-9)
    each = LASER.log_likelihood(room, poses(), scans, noise=NOISE, beams=3, temper=0.25)
    assert np.allclose(each, 0.25 * summed(room, scans, slice(None, None, 3)), rtol=1e-9, atol=1e-9)
    some = LASER.log_likelihood(room, poses(), one, noise=NOISE, beams=[60, 0, 7])
    assert np.allclose(some, summed(room, one, [60, 0, 7]), rtol=1e-9, atol=1e-9)
    obstacles = [(DISC, (1.0, 2.0, 0.0)), (mrs.Shape.rectangle(1.0, 2.0), (-3.0, 0.0, 0.5))]
    blocked = LASER.log_likelihood(room, poses(), one, noise=NOISE, obstacles=obstacles)
    assert np.allclose(blocked, summed(room, one, obstacles=obstacles), rtol=1e-9, atol=1e-9)
    assert not np.array_equal(blocked, found)


def test_a_scan_that_takes_time_is_scored_beam_by_beam(room: mrs.OccupancyGrid) -> None:
    motion = {"twists": np.tile([1.0, 0.2, 2.0], (200, 1)), "scan_duration": 0.2}
    motion["obstacles"] = [(DISC, (1.0, 2.0, 0.0), (1.0, 0.0, 0.0))]
    scan = LASER.scan_batch(room, poses(), noise=NOISE, seed=1, **motion)[3]
    found = LASER.log_likelihood(room, poses(), scan, noise=NOISE, beams=2, **motion)
    assert np.allclose(found, summed(room, scan, slice(None, None, 2), **motion), rtol=1e-9, atol=1e-9)
    assert found.argmax() == 3
    beam_poses = LASER.beam_poses(poses(), motion["twists"], 0.2)
    alike = LASER.log_likelihood(room, beam_poses, scan, noise=NOISE)
    still = LASER.log_likelihood(room, poses(), scan, noise=NOISE, scan_duration=0.2)
    assert np.allclose(still, LASER.log_likelihood(room, poses(), scan, noise=NOISE), rtol=1e-12)
    assert not np.allclose(alike, still)


def test_the_result_does_not_depend_on_threads_and_can_be_given(room: mrs.OccupancyGrid) -> None:
    scan, out = LASER.scan_batch(room, poses()[:1])[0], np.empty(200)
    whole = LASER.log_likelihood(room, poses(), scan, noise=NOISE, threads=1)
    assert LASER.log_likelihood(room, poses(), scan, noise=NOISE, threads=2, out=out) is out
    assert out.tobytes() == whole.tobytes()


def test_an_impossible_reading_gives_minus_infinity(room: mrs.OccupancyGrid) -> None:
    exact = mrs.BeamModel(sigma_hit=0.01, z_hit=1.0, z_max=0.0)
    scan = LASER.scan_batch(room, poses()[:1])[0]
    scores = LASER.log_likelihood(room, poses(), scan, noise=exact)
    assert np.isfinite(scores[0]) and np.isneginf(scores[1:]).all()
    nothing = LASER.log_likelihood(room, poses(), np.full(61, np.nan, np.float32), noise=exact)
    assert not nothing.any()
    assert LASER.log_likelihood(room, np.zeros((0, 3)), scan, noise=exact).shape == (0,)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"ranges": np.zeros(60, np.float32)}, ValueError, r"ranges must have shape \(61,\), or \(200, 61\) with a scan"),
        ({"ranges": np.zeros((2, 61), np.float32)}, ValueError, r"ranges must have shape .*, got \(2, 61\)"),
        ({"ranges": np.zeros(61)}, TypeError, "ranges must have dtype float32, got float64"),
        ({"beams": 0}, ValueError, "beams must be a positive number k for every k-th beam, got 0"),
        ({"beams": -1}, ValueError, "beams must be a positive number k for every k-th beam"),
        ({"beams": [61]}, ValueError, "beams must be less than beam_count, got 61"),
        ({"beams": 1.5}, TypeError, "beams must be an integer, got float"),
        ({"beams": ["x"]}, TypeError, "a number of beams must be an integer, got str"),
        ({"temper": 0.0}, ValueError, "temper must be positive, got 0"),
        ({"noise": 0.1}, TypeError, "noise must be a BeamModel or a LikelihoodField, got float"),
        ({"poses": np.full((200, 3), np.nan)}, ValueError, "poses must be finite"),
        ({"out": np.empty(199)}, ValueError, r"out must have shape \(200,\), got \(199,\)"),
        ({"twists": np.zeros((200, 3))}, ValueError, "twists need scan_duration"),
    ],
)
def test_bad_values_are_named(
    room: mrs.OccupancyGrid, options: dict[str, Any], error: type[Exception], message: str
) -> None:
    given = {"poses": poses(), "ranges": np.zeros(61, np.float32), "noise": NOISE, **options}
    with pytest.raises(error, match=message):
        LASER.log_likelihood(room, **given)
