"""best_everywhere: scores like log_likelihood, with the rays of all headings cast once."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.localization.everywhere import HEADINGS, SHARE, TURN, best_everywhere

MODEL = mrs.BeamModel(sigma_hit=0.3, z_hit=0.75, z_short=0.0, z_max=0.05, z_rand=0.2)
GRID = mrs.floor_plan("office", seed=1, size=(12.0, 9.0))


@pytest.mark.parametrize("turned", [1.0, -1.0], ids=["counterclockwise", "clockwise"])
def test_scores_are_those_of_log_likelihood(turned: float) -> None:
    # Each beam points along a ray, so that only the rounding of true ranges to 512 values is between the two.
    laser = mrs.LaserScanner(
        fov=None,
        angle_min=-20.0 * turned * TURN,
        angle_increment=turned * TURN,
        beam_count=50,
        mount=(0.3, -0.2, 4.0 * TURN),
    )
    ranges = laser.mark_invalid(laser.scan_batch(GRID, GRID.draw_free_poses(1, radius=0.3, seed=1), noise=MODEL, seed=1))[0]
    shares: list[float] = []
    poses, scores = best_everywhere(GRID, laser, ranges, MODEL, progress=shares.append, threads=1)
    expected = laser.log_likelihood(GRID, poses, ranges, noise=MODEL)
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert np.median(np.abs(scores - expected)) < 0.5
    assert np.quantile(np.abs(scores - expected), 0.99) < 2.0
    assert np.ptp(expected) > 10.0


def test_the_best_are_returned() -> None:
    laser = mrs.LaserScanner(fov=None, angle_min=-20.0 * TURN, angle_increment=TURN, beam_count=50)
    ranges = laser.scan(GRID, GRID.draw_free_poses(1, radius=0.3, seed=1)[0])
    poses, scores = best_everywhere(GRID, laser, ranges, MODEL, progress=lambda share: None, threads=None)
    every = round(0.25 / GRID.resolution)
    cells = GRID.cells[every // 2 :: every, every // 2 :: every]
    rows, columns = np.nonzero((cells >= 0) & (cells < GRID.occupied_threshold))
    positions = (np.stack((columns, rows), axis=1) * every + every // 2 + 0.5) * GRID.resolution
    everywhere = np.column_stack(
        (np.repeat(positions, HEADINGS, axis=0), np.tile(np.arange(HEADINGS) * TURN, len(positions)))
    )
    expected = laser.log_likelihood(GRID, everywhere, ranges, noise=MODEL)
    assert len(everywhere) / SHARE <= len(poses) < len(everywhere) / SHARE + 100
    best = {tuple(pose) for pose in everywhere[np.argsort(-expected)[: len(poses) // 2]].round(6)}
    assert len(best - {tuple(pose) for pose in poses.round(6)}) < 0.01 * len(best)
    assert math.isclose(scores.max(), expected.max(), abs_tol=0.5)
