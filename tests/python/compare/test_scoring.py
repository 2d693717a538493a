"""scoring: the error of each beam, added up one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from compare.simulated_logs import LASER, free_poses, log_of, office
from mobile_robot_simulator.compare import scoring
from mobile_robot_simulator.compare.beams import Beams
from mobile_robot_simulator.compare.scoring import Scans, offsets

GRID = office()
POSES = free_poses(GRID, 5)
READINGS = log_of(GRID, POSES).ranges
CANDIDATES = POSES[:, None] + offsets(0.1, 0.05, 1, 1)


def one_by_one(readings: np.ndarray, candidates: np.ndarray, cap: float) -> list[list[float]]:
    means = []
    for scan, poses in zip(readings, candidates, strict=True):
        means.append([])
        for pose in poses:
            errors = []
            for measured, simulated in zip(scan.tolist(), LASER.scan(GRID, pose).tolist(), strict=True):
                if measured == -math.inf or math.isnan(measured):
                    continue
                errors.append(min(cap, abs(min(measured, LASER.max_range) - simulated)))
            means[-1].append(sum(errors) / len(errors) if errors else 0.0)
    return means


def test_a_score_is_the_mean_error_up_to_a_cap(monkeypatch: pytest.MonkeyPatch) -> None:
    readings = READINGS.copy()
    readings[0, :50], readings[1, ::3], readings[2, 4], readings[3] = math.nan, math.inf, -math.inf, math.nan
    scans = Scans(GRID, Beams(LASER.angles, LASER.max_range), readings)
    scores = scans.score(CANDIDATES, 0.3)
    np.testing.assert_allclose(scores, one_by_one(readings, CANDIDATES, 0.3), atol=1e-6)
    assert scans.counts.tolist() == [51, 101, 100, 0, 101]
    monkeypatch.setattr(scoring, "_CHUNK", 1)
    np.testing.assert_array_equal(scans.score(CANDIDATES, 0.3), scores)


def test_the_right_pose_has_no_error() -> None:
    scores = Scans(GRID, Beams(LASER.angles, LASER.max_range), READINGS).score(CANDIDATES, 0.3)
    assert scores[:, 0].tolist() == [0.0] * 5 and (scores[:, 1:] > 0.0).all()


def test_a_lattice_starts_with_its_smallest_offsets() -> None:
    lattice = offsets(0.5, 0.25, 2, 1)
    assert lattice.shape == (5 * 5 * 3, 3) and lattice[0].tolist() == [0, 0, 0]
    assert len(np.unique(lattice, axis=0)) == 75
    assert {tuple(each) for each in np.abs(lattice[1:7]).tolist()} == {(0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.25)}
    assert np.abs(lattice).max(axis=0).tolist() == [1.0, 1.0, 0.25]
