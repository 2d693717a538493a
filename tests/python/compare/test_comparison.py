"""comparison: logs of the simulator with known errors."""

from __future__ import annotations

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import LASER, free_poses, log_of, office
from logs.test_carmen import REAL_LOG
from map_folders import SHARED_MAPS
from mobile_robot_simulator.compare import compare_log
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
    comparison = compare_log(room(110), log_of(room(112), poses, laser=forward))
    np.testing.assert_allclose(comparison.residuals.values, [[0.0, 0.1, 0.0]], atol=1e-6)


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


@pytest.mark.skipif(not REAL_LOG.is_file() or not SHARED_MAPS.is_dir(), reason="needs ../shared/logs and ../shared/maps")
def test_a_real_log() -> None:
    comparison = compare_log(mrs.load_map(SHARED_MAPS / "radish_intel" / "map_logframe.yaml"), read_log(REAL_LOG))
    spread, counts = comparison.residuals.spread, comparison.residuals.counts
    assert counts["both"] / sum(counts.values()) > 0.99
    assert abs(spread.median) < 0.05 and 0.04 < spread.mad < 0.1 and spread.within[0.2] > 0.75
