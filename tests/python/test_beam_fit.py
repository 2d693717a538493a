"""Fits of the beam model from Python. `tests/beam_fit.rs` checks the numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs

NOISE = mrs.BeamModel(sigma_hit=0.05, lambda_short=1.0, z_hit=0.6, z_short=0.2, z_max=0.1, z_rand=0.1)


def scans(noise: mrs.BeamModel = NOISE) -> tuple[Any, Any]:
    grid = mrs.floor_plan("office", seed=1)
    poses, laser = grid.draw_free_poses(100, radius=0.3, seed=1), mrs.LaserScanner(max_range=8.0)
    return laser.scan_batch(grid, poses), laser.mark_invalid(laser.scan_batch(grid, poses, noise=noise, seed=2))


def test_a_model_is_found_again() -> None:
    true_ranges, readings = scans()
    fit = mrs.BeamModel.fit(true_ranges, readings, max_range=8.0, min_range=0.05)
    assert fit.has_converged and fit.unidentified == () and fit.iterations > 1
    assert np.isneginf(readings).any() and fit.count == readings.size
    for name, error in fit.standard_errors.items():
        found, expected = getattr(fit.model, name), getattr(NOISE, name)
        assert error is not None and abs(found - expected) < 4.0 * error, name
    scores = [np.log(model.likelihood(readings, true_ranges, 8.0, min_range=0.05)).sum() for model in (fit.model, NOISE)]
    assert fit.log_likelihood == pytest.approx(scores[0], rel=1e-6) and scores[0] > scores[1]
    without_marks = mrs.BeamModel.fit(true_ranges, readings, max_range=8.0)
    assert without_marks.count == np.count_nonzero(~np.isneginf(readings))
    assert repr(fit).startswith(f"BeamFit({fit.model!r}, count={fit.count}, log_likelihood=")


def test_what_is_not_determined_has_no_standard_error() -> None:
    fit = mrs.BeamModel.fit(*scans(mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1, z_max=0.0)), max_range=8.0)
    assert fit.unidentified == ("lambda_short",) and fit.standard_errors["lambda_short"] is None
    assert "unidentified=('lambda_short',)" in repr(fit)


def test_an_offset_is_fitted_if_asked_for() -> None:
    true_ranges, readings = scans()
    near = np.where(true_ranges < 8.0, true_ranges - np.float32(0.1), true_ranges).clip(0.0)
    fit = mrs.BeamModel.fit(near, readings, max_range=8.0, min_range=0.05, fit_offset=True)
    error = fit.standard_errors["offset"]
    assert fit.offset is not None and error is not None and abs(fit.offset - 0.1) < 4.0 * error < 0.01
    assert fit.model.sigma_hit == pytest.approx(0.05, rel=0.03)
    assert f"offset={fit.offset:.4f})" in repr(fit)
    without = mrs.BeamModel.fit(near, readings, max_range=8.0, min_range=0.05)
    assert without.offset is None and "offset" not in without.standard_errors
    assert without.log_likelihood < fit.log_likelihood


def test_sigma_is_found_for_each_band_of_incidence() -> None:
    true = np.full((2, 5000), 5.0, np.float32)
    spread = np.float32([[0.05], [0.15]])
    readings = true + spread * np.random.default_rng(1).standard_normal(true.shape).astype(np.float32)
    model = mrs.BeamModel.fit(true, readings, 30.0).model
    sigmas = model.sigma_by_incidence(true, readings, np.float32([[0.1], [1.5]]), max_range=30.0)
    assert sigmas.shape == (6,) and np.isnan(sigmas[1:5]).all()
    assert sigmas[[0, 5]] == pytest.approx([0.05, 0.15], rel=0.05)
    with pytest.raises(ValueError, match="readings and true_ranges and incidences must have shapes that broadcast, got"):
        model.sigma_by_incidence(true, readings, np.zeros(7, np.float32), 30.0)


def test_arrays_of_any_shape_are_broadcast() -> None:
    readings = np.float32([[4.9, 5.0, 5.1], [5.2, 4.8, math.inf]])
    one = mrs.BeamModel.fit(np.float32(5.0), readings, 8.0)
    each = mrs.BeamModel.fit(np.full_like(readings, 5.0).T, readings.T, 8.0)
    assert one.count == 6 and one.model.sigma_hit == pytest.approx(each.model.sigma_hit)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((np.zeros(3, np.float32), np.zeros(4, np.float32), 8.0), ValueError, "shapes that broadcast"),
        ((np.zeros(3), np.zeros(3, np.float32), 8.0), TypeError, "true_ranges must have dtype float32, got float64"),
        ((np.ones(3, np.float32), np.full(3, np.nan, np.float32), 8.0), ValueError, "readings to fit must be at least 1"),
        ((np.full(3, -1.0, np.float32), np.ones(3, np.float32), 8.0), ValueError, "true_ranges must be at least 0, got -1"),
        ((np.ones(3, np.float32), np.ones(3, np.float32), 0.0), ValueError, "max_range must be positive, got 0"),
    ],
)
def test_what_cannot_be_fitted_is_refused(arguments: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        mrs.BeamModel.fit(*arguments)


def test_a_fit_names_only_parameters() -> None:
    fit = mrs.BeamModel.fit(*scans(), max_range=8.0)
    arguments = {name: getattr(fit, name) for name in ("model", "log_likelihood", "count", "iterations", "has_converged")}
    arguments |= {"standard_errors": fit.standard_errors}
    assert repr(mrs.BeamFit(**arguments, unidentified=())) == repr(fit)
    for names in (["sigma"], ["sigma_hit", "sigma_hit"]):
        with pytest.raises(ValueError, match="unidentified must be different names of parameters, got 'sigma"):
            mrs.BeamFit(**arguments, unidentified=names)
