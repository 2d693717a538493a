"""motion_noise: samples of drifting odometry, and their covariance."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

import mobile_robot_simulator as mrs

NOISE = mrs.MotionNoise(alpha1=0.02, alpha2=0.01, alpha3=0.005, alpha4=0.01, alpha5=0.002, alpha6=0.003)
TWIST = (0.5, 0.0, 0.4)


def test_a_step_without_noise_is_exact() -> None:
    pose = mrs.Pose(1.0, 2.0, 3.0)
    assert mrs.MotionNoise().sample(pose, TWIST, 0.1, seed=1, index=0) == pose.integrate(TWIST, 0.1)
    assert not mrs.MotionNoise().propagate(np.zeros((3, 3)), pose, TWIST, 0.1).any()


def test_seed_and_index_determine_a_sample() -> None:
    draws = {tuple(NOISE.sample((0, 0, 0), TWIST, 0.1, seed=seed, index=index)) for seed in (1, 2) for index in (0, 1)}
    assert len(draws) == 4
    assert tuple(NOISE.sample((0, 0, 0), TWIST, 0.1, seed=1, index=0)) in draws


def test_the_spread_of_samples_agrees_with_the_covariance() -> None:
    draws = 4000
    end = mrs.Pose().integrate(TWIST, 0.5)
    covariance = NOISE.propagate(np.zeros((3, 3)), (0, 0, 0), TWIST, 0.5)
    samples = np.array([tuple(NOISE.sample((0, 0, 0), TWIST, 0.5, seed=3, index=index)) for index in range(draws)])
    errors = samples - np.array(tuple(end))
    squared = np.einsum("ni,ij,nj->n", errors, np.linalg.inv(covariance), errors)
    # The mean of a chi-squared variable with 3 degrees of freedom is 3; its standard error here is √(6 / draws).
    assert squared.mean() == pytest.approx(3.0, abs=4 * math.sqrt(6 / draws))
    assert np.array_equal(covariance, covariance.T)


def test_copies_are_equal() -> None:
    assert pickle.loads(pickle.dumps(NOISE)) == NOISE != mrs.MotionNoise()
    assert eval(repr(NOISE), {"MotionNoise": mrs.MotionNoise}) == NOISE
    assert NOISE.alpha == (0.02, 0.01, 0.005, 0.01, 0.002, 0.003)


def test_invalid_input_is_rejected() -> None:
    with pytest.raises(ValueError, match="alpha4 must be at least 0, got -1"):
        mrs.MotionNoise(alpha4=-1.0)
    with pytest.raises(ValueError, match=r"covariance must have shape \(3, 3\), got \(6, 6\)"):
        NOISE.propagate(np.zeros((6, 6)), (0, 0, 0), TWIST, 0.1)
    with pytest.raises(TypeError, match="covariance must have dtype float64"):
        NOISE.propagate(np.zeros((3, 3), complex), (0, 0, 0), TWIST, 0.1)
    with pytest.raises(ValueError, match="covariance must be finite, got NaN"):
        NOISE.propagate(np.full((3, 3), math.nan), (0, 0, 0), TWIST, 0.1)
    with pytest.raises(TypeError, match="index must be an integer, got float"):
        NOISE.sample((0, 0, 0), TWIST, 0.1, seed=1, index=0.5)  # type: ignore[arg-type]
