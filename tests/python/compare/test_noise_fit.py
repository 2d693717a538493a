"""noise_fit: logs of the simulator whose noise is known."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import LASER, free_poses, log_of, office
from mobile_robot_simulator.compare.noise_fit import AMCL, NoiseFit, Score, fit_noise, score_of
from mobile_robot_simulator.logs import ScanLog

GRID = office()
POSES = free_poses(GRID, 200)
TRUE = LASER.scan_batch(GRID, POSES)
NOISE = mrs.BeamModel(sigma_hit=0.05, lambda_short=1.0, z_hit=0.8, z_short=0.1, z_max=0.04, z_rand=0.06)
LOG = log_of(GRID, POSES, noise=NOISE)


def fitted(log: ScanLog) -> NoiseFit:
    found = fit_noise(log, TRUE)
    assert found is not None
    return found


def test_the_noise_is_recovered_and_explains_the_other_scans() -> None:
    found = fitted(LOG)
    model = found.fit.model
    assert model.sigma_hit == pytest.approx(0.05, rel=0.03) and model.lambda_short == pytest.approx(1.0, rel=0.15)
    assert (model.z_hit, model.z_short) == pytest.approx((0.8, 0.1), abs=0.01)
    assert (model.z_max, model.z_rand) == pytest.approx((0.04, 0.06), abs=0.01)
    assert abs(found.offset) < 0.001 and found.fit.count + found.test_count == LOG.ranges.size
    odd = np.log(NOISE.likelihood(LOG.ranges[1::2], TRUE[1::2], 12.0, min_range=0.05)).mean()
    assert found.scores["fit"].log_likelihood == pytest.approx(odd, abs=0.003)
    assert all(found.scores["fit"].log_likelihood > found.scores[name].log_likelihood + 0.3 for name in AMCL)
    assert all(score.impossible == 0 for score in found.scores.values())


def test_only_even_scans_are_fitted_and_only_odd_ones_tested() -> None:
    rough = log_of(GRID, POSES, noise=mrs.BeamModel(sigma_hit=0.4, z_hit=1.0, z_max=0.0)).ranges
    ranges = LOG.ranges.copy()
    ranges[1::2] = rough[1::2]
    found, before = fitted(replace(LOG, ranges=ranges)), fitted(LOG)
    assert repr(found.fit.model) == repr(before.fit.model)
    likelihood = before.fit.model.likelihood(rough[1::2], TRUE[1::2], 12.0, min_range=0.05)
    assert found.scores["fit"].log_likelihood == pytest.approx(np.log(likelihood).mean(), rel=1e-9)


@pytest.mark.parametrize("offset", [0.03, -0.02])
def test_walls_behind_their_faces_are_recovered(offset: float) -> None:
    is_return = np.isfinite(LOG.ranges)
    moved = replace(LOG, ranges=np.where(is_return, LOG.ranges + np.float32(offset), LOG.ranges))
    found = fitted(moved)
    assert found.offset == pytest.approx(offset, abs=0.001)
    assert found.offset_fit.model.sigma_hit == pytest.approx(0.05, rel=0.03)
    assert found.fit.model.sigma_hit > 1.03 * found.offset_fit.model.sigma_hit
    assert found.scores["fit with offset"].log_likelihood > found.scores["fit"].log_likelihood + 0.02


def test_readings_that_cannot_be_used_are_left_out() -> None:
    ranges, true = LOG.ranges.copy(), TRUE.copy()
    ranges[0, :7], ranges[1, :5], true[2, :11], true[3, :3] = np.nan, np.nan, 0.0, 0.0
    found = fit_noise(replace(LOG, ranges=ranges), true)
    assert found is not None
    assert (found.fit.count, found.test_count) == (LOG.ranges[::2].size - 18, LOG.ranges[1::2].size - 8)
    ranges[1, 50:] = -np.inf
    without = fit_noise(replace(LOG, ranges=ranges, min_range=0.0), true)
    assert without is not None and without.test_count <= found.test_count - 51


def test_impossible_readings_are_counted() -> None:
    """A model without random readings cannot explain one that is a hundred sigma off."""
    simulated = np.full(5, 5.0, np.float32)
    measured = np.array([5.0, 5.01, 4.0, 6.0, math.inf], np.float32)
    limits = {"max_range": 12.0, "min_range": 0.05}
    score = score_of(mrs.BeamModel(sigma_hit=0.01, z_hit=1.0, z_max=0.0), (simulated, measured), limits)
    assert score == Score(-math.inf, 3)
    possible = score_of(mrs.BeamModel(sigma_hit=0.01, z_hit=1.0, z_max=0.0), (simulated[:2], measured[:2]), limits)
    assert possible == Score(pytest.approx(math.log(100 / math.sqrt(2 * math.pi)) - 0.25, abs=1e-4), 0)
    report = replace(fitted(LOG), scores={"fit": score}).report()
    assert report["log_likelihood_per_reading"] == {"fit": None} and report["impossible_readings"] == {"fit": 3}
    json.dumps(report, allow_nan=False)


def test_without_readings_there_is_no_fit() -> None:
    assert fit_noise(log_of(GRID, POSES[:1]), TRUE[:1]) is None
    silent = replace(LOG, ranges=np.full_like(LOG.ranges, np.nan))
    assert fit_noise(silent, TRUE) is None


def test_a_long_log_is_fitted_to_some_of_its_scans(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, shares = fitted(LOG), list[float]()
    monkeypatch.setattr("mobile_robot_simulator.compare.noise_fit.MOST_READINGS", 50 * 101 + 7)
    found = fit_noise(LOG, TRUE, progress=shares.append)
    assert found is not None and (found.fit.count, found.test_count) == (50 * 101, whole.test_count)
    assert found.fit.model.sigma_hit == pytest.approx(0.05, rel=0.05)
    assert shares == sorted(shares) and shares[-1] == 1.0
