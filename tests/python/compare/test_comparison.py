"""comparison: logs of the simulator with known errors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import LASER, free_poses, log_of, office
from logs.test_carmen import REAL_LOG
from map_folders import SHARED_MAPS
from mobile_robot_simulator.compare import compare_log
from mobile_robot_simulator.compare.noise_fit import AMCL
from mobile_robot_simulator.logs import read_log

GRID = office()
POSES = free_poses(GRID, 60)


def room(wall: int) -> mrs.OccupancyGrid:
    """A room of 6 m x 4 m whose right wall is in one column."""
    cells = np.zeros((80, 120), np.int8)
    cells[[0, -1], :] = cells[:, [0, wall]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.05)


def test_a_log_without_errors_has_no_residuals() -> None:
    comparison = compare_log(GRID, log_of(GRID, POSES))
    assert comparison.residuals.counts["both"] > 5000
    assert np.nanmax(np.abs(comparison.residuals.values)) == 0.0


def test_noise_is_recovered() -> None:
    noise = mrs.BeamModel(sigma_hit=0.04, z_hit=1.0, z_max=0.0)
    spread = compare_log(GRID, log_of(GRID, POSES, noise=noise)).residuals.spread
    assert spread.median == pytest.approx(0.0, abs=0.002)
    assert 1.4826 * spread.mad == pytest.approx(0.04, rel=0.03)
    assert spread.within[0.05] == pytest.approx(0.789, abs=0.015)  # a normal number is within 1.25 sigma with this chance


def test_a_moved_wall_is_recovered() -> None:
    poses = np.array([[1.0, 2.0, 0.0]])
    forward = mrs.LaserScanner(beam_count=3, fov=np.pi, max_range=30.0)
    comparison = compare_log(room(110), log_of(room(112), poses, laser=forward), align="none")
    np.testing.assert_allclose(comparison.residuals.values, [[0.0, 0.1, 0.0]], atol=1e-6)


def test_a_wall_that_moved_is_the_worst_place() -> None:
    """The right wall is 0.4 m farther than on the map. The others are where they were."""
    poses = np.array([[2.0 + 0.1 * k, 2.0, 0.0] for k in range(20)])
    comparison = compare_log(room(100), log_of(room(108), poses), align="none")
    places = comparison.breakdown.places
    assert places and all(place.x == 5.25 or place.y in (0.25, 3.75) for place in places)  # its ends hide the other walls
    assert places[0].x == 5.25 and places[0].wrong == places[0].count and places[0].median == pytest.approx(0.42, abs=0.03)
    assert comparison.breakdown.by_incidence[-1].spread.count > 0
    # Beams 0 and 100 look back, at the walls that did not move. The middle one looks at the right wall.
    by_beam = comparison.breakdown.by_beam
    assert (by_beam[0].median, by_beam[100].median) == (0.0, 0.0) and by_beam[50].median == pytest.approx(0.4, abs=1e-5)


def test_ends_are_where_the_real_beams_ended() -> None:
    log = log_of(GRID, POSES)
    comparison = compare_log(GRID, log, align="none")
    expected = [LASER.end_points(pose, ranges) for pose, ranges in zip(POSES, log.ranges, strict=True)]
    np.testing.assert_allclose(comparison.ends(), np.vstack(expected), atol=1e-5)


def test_noise_that_grows_with_the_range_is_seen_by_range() -> None:
    log = log_of(GRID, POSES)
    errors = np.random.default_rng(3).standard_normal(log.ranges.shape).astype(np.float32)
    comparison = compare_log(GRID, replace(log, ranges=log.ranges * (1 + np.float32(0.02) * errors)), align="none")
    for band in comparison.breakdown.by_range:
        simulated = comparison.simulated[(comparison.simulated >= band.low) & (comparison.simulated < band.high)]
        assert 1.4826 * band.spread.mad == pytest.approx(0.02 * np.median(simulated), rel=0.2)


def test_a_shift_of_the_log_is_taken_out_unless_it_shall_stay() -> None:
    log = log_of(GRID, POSES, said=POSES + np.array([0.1, -0.05, 0.0]))
    stays, aligned = compare_log(GRID, log, align="none"), compare_log(GRID, log)
    assert stays.residuals.spread.mad > 0.02 and stays.alignment is None
    assert aligned.residuals.spread.mad < 0.001 and aligned.alignment is not None
    assert aligned.alignment.shift == pytest.approx((-0.1, 0.05), abs=0.002)
    np.testing.assert_array_equal(stays.poses, log.poses)
    np.testing.assert_allclose(aligned.poses, POSES, atol=0.003)


def test_poses_are_refined_after_the_alignment() -> None:
    errors = np.random.default_rng(3).uniform(-0.1, 0.1, POSES.shape) * [1.0, 1.0, 0.3]
    log = log_of(GRID, POSES, said=POSES - errors - np.array([0.5, 0.0, 0.0]))
    comparison = compare_log(GRID, log, refine=True)
    assert comparison.refinement is not None
    np.testing.assert_array_equal(comparison.poses, comparison.refinement.poses)
    assert np.median(np.abs(comparison.poses - POSES)) < 0.003 and comparison.residuals.spread.mad < 0.005
    assert comparison.report()["refinement"]["distance"]["median"] == pytest.approx(0.08, abs=0.02)


def test_an_offset_is_subtracted_from_returns_only() -> None:
    log = log_of(GRID, POSES)
    ranges = log.ranges.copy()
    ranges[0, :3] = np.inf, -np.inf, np.nan
    farther = replace(log, ranges=ranges + np.float32(0.04))
    comparison = compare_log(GRID, farther, offset=0.04, align="none")
    assert np.nanmax(np.abs(comparison.residuals.values)) < 1e-5 and comparison.residuals.values.dtype == np.float32
    np.testing.assert_array_equal(comparison.log.ranges[0, :3], [np.inf, -np.inf, np.nan])
    near = compare_log(GRID, log, offset=5.0, align="none")
    assert np.nanmin(near.log.ranges[np.isfinite(near.log.ranges)]) == 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"align": "affine"}, "align must be 'none' or 'rigid', got 'affine'"),
        ({"reach": (1.0, 2.0, 3.0)}, "reach must be two numbers"),
        ({"offset": np.nan}, "offset must be finite, got nan"),
    ],
)
def test_wrong_arguments(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        compare_log(GRID, log_of(GRID, POSES), **arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"grid": log_of(GRID, POSES)}, "grid must be an OccupancyGrid, got ScanLog"),
        ({"log": GRID}, "log must be a logs.ScanLog, as read_log returns it, got OccupancyGrid"),
        ({"log": "file.log"}, "log must be a logs.ScanLog, as read_log returns it, got 'file.log'"),
        ({"reach": 1.0}, r"reach must be two numbers, the largest shift \[m\] and yaw \[rad\], got 1.0"),
        ({"reach": ("a", 1.0)}, "reach must be two numbers"),
        ({"offset": "a"}, "offset must be a number, got 'a'"),
    ],
)
def test_arguments_of_wrong_types(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        compare_log(**{"grid": GRID, "log": log_of(GRID, POSES), **arguments})


def test_poses_in_another_frame_are_an_error() -> None:
    away = POSES + np.array([500.0, 0.0, 0.0])
    with pytest.raises(ValueError, match=r"the poses must be in the frame of the map, got x 50.* in the frame 'map'"):
        compare_log(GRID, log_of(GRID, POSES, said=away))


def test_the_report_has_the_results() -> None:
    comparison = compare_log(GRID, log_of(GRID, POSES, noise=mrs.BeamModel()))
    report = comparison.report()
    assert report["scans"] == 60 and report["beams_per_scan"] == LASER.beam_count
    assert sum(report["beams"].values()) == 60 * LASER.beam_count
    assert report["residuals"]["median"] == comparison.residuals.spread.median
    assert sum(report["residuals"]["histogram"]["counts"]) == report["beams"]["both"]


@pytest.mark.slow
@pytest.mark.skipif(not REAL_LOG.is_file() or not SHARED_MAPS.is_dir(), reason="needs ../shared/logs and ../shared/maps")
def test_a_real_log() -> None:
    """160 scans of a public log, whose poses somebody else corrected."""
    grid, log = mrs.load_map(SHARED_MAPS / "radish_intel" / "map_logframe.yaml"), read_log(REAL_LOG)
    comparison = compare_log(grid, log, refine=True)
    spread, counts, alignment = comparison.residuals.spread, comparison.residuals.counts, comparison.alignment
    assert counts["both"] / sum(counts.values()) > 0.99
    assert abs(spread.median) < 0.02 and 0.01 < spread.mad < 0.03 and spread.within[0.05] > 0.7
    assert alignment is not None and alignment.error_after < alignment.error_before < 0.11
    bands = comparison.breakdown.by_incidence
    assert bands[-1].spread.mad > 2 * bands[0].spread.mad
    noise = comparison.noise
    assert noise is not None and 0.03 < noise.fit.model.sigma_hit < 0.06 and noise.fit.model.z_hit > 0.8
    assert all(noise.scores["fit"].log_likelihood > noise.scores[name].log_likelihood + 0.5 for name in AMCL)
    assert noise.scores["fit with offset"].log_likelihood > noise.scores["fit"].log_likelihood
