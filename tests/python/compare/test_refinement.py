"""refinement: logs in which each pose has an error of its own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import SEED, free_poses, log_of, office
from mobile_robot_simulator.compare import refinement
from mobile_robot_simulator.compare.refinement import refine_poses
from mobile_robot_simulator.compare.scoring import BASE_CAP, Scans

GRID = office()
POSES = free_poses(GRID, 80)
NOISE = mrs.BeamModel(sigma_hit=0.03, z_hit=0.9, z_short=0.05, z_max=0.02, z_rand=0.03)
ERRORS = np.random.default_rng(SEED).uniform([-0.2, -0.2, -0.06], [0.2, 0.2, 0.06], (80, 3))


def test_errors_of_each_pose_are_recovered() -> None:
    found = refine_poses(GRID, log_of(GRID, POSES, noise=NOISE), POSES - ERRORS)
    left = np.abs(found.poses - POSES)
    assert (np.median(left, axis=0) < [0.005, 0.005, 0.0015]).all()
    assert (np.percentile(left, 90, axis=0) < [0.02, 0.02, 0.006]).all()
    np.testing.assert_allclose(found.poses - (POSES - ERRORS), found.changes, atol=1e-12)
    assert (found.errors_after <= found.errors_before).all() and found.errors_after.mean() < 0.045
    np.testing.assert_allclose(found.distances, [math.hypot(x, y) for x, y, _ in found.changes])


@pytest.mark.parametrize("said", [POSES, POSES - ERRORS], ids=["right", "wrong"])
def test_the_errors_are_those_of_the_poses(said: np.ndarray) -> None:
    """Among many random readings, the coarse steps may lead away from a pose to a worse one. Then it stays."""
    rough = mrs.BeamModel(sigma_hit=0.1, lambda_short=0.5, z_hit=0.3, z_short=0.3, z_max=0.1, z_rand=0.3)
    log = log_of(GRID, POSES, noise=rough)
    found = refine_poses(GRID, log, said)
    scans = Scans.of_log(GRID, log, np.arange(len(said)), 180)
    errors = scans.score(np.stack([said, found.poses], axis=1), BASE_CAP)
    np.testing.assert_allclose(errors, np.column_stack([found.errors_before, found.errors_after]), atol=1e-9)
    assert (errors[:, 1] <= errors[:, 0]).all()


def test_right_poses_stay() -> None:
    found = refine_poses(GRID, log_of(GRID, POSES), POSES)
    np.testing.assert_array_equal(found.changes, 0.0)
    np.testing.assert_array_equal(found.errors_after, 0.0)


def test_scans_that_say_nothing_keep_their_poses() -> None:
    log = log_of(GRID, POSES)
    empty = mrs.OccupancyGrid(np.zeros((4, 4), np.int8), resolution=0.05)
    np.testing.assert_array_equal(refine_poses(empty, log, POSES).changes, 0.0)
    silent = replace(log, ranges=np.full_like(log.ranges, math.nan))
    np.testing.assert_array_equal(refine_poses(GRID, silent, POSES).changes, 0.0)


def test_what_lies_beyond_the_reach_is_said() -> None:
    found = refine_poses(GRID, log_of(GRID, POSES), POSES + np.array([0.36, 0.0, 0.0]))
    assert found.is_at_limit.mean() > 0.5 and np.abs(found.changes).max() <= 0.3
    assert not refine_poses(GRID, log_of(GRID, POSES), POSES + np.array([0.1, 0.0, 0.0])).is_at_limit.any()


def test_each_scan_is_refined_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    log = log_of(GRID, POSES, noise=NOISE)
    whole = refine_poses(GRID, log, POSES - ERRORS)
    monkeypatch.setattr(refinement, "_CHUNK", 7)
    shares: list[float] = []
    np.testing.assert_array_equal(refine_poses(GRID, log, POSES - ERRORS, progress=shares.append).poses, whole.poses)
    assert len(shares) == 12 and shares[-1] == 1.0
