"""odometer: exact without noise; with noise, the drift is repeatable and the covariance grows."""

from __future__ import annotations

import numpy as np
import pytest

from mobile_robot_simulator import MotionNoise, Pose
from mobile_robot_simulator.physics.odometer import EXACT, PLANAR_COVARIANCE, UNMEASURED, Odometer

NOISE = MotionNoise(alpha1=0.1, alpha4=0.1)
SEED = 3
SECOND = 1_000_000_000


def test_without_noise_the_estimate_is_the_pose_of_the_wheels() -> None:
    odometer = Odometer(Pose(), 0)
    estimate, covariance = odometer.read(Pose(1.0, 2.0, 0.5), SECOND)
    assert estimate == Pose(1.0, 2.0, 0.5) and not odometer.is_noisy
    assert covariance is PLANAR_COVARIANCE and not covariance.flags.writeable
    assert np.diag(covariance.reshape(6, 6)).tolist() == [EXACT, EXACT, UNMEASURED, UNMEASURED, UNMEASURED, EXACT]


def test_with_noise_the_estimate_drifts_and_its_covariance_grows() -> None:
    odometer = Odometer(Pose(), 0, noise=NOISE, seed=SEED)
    estimates, variances = [], []
    for second in range(1, 4):
        estimate, covariance = odometer.read(Pose(float(second)), second * SECOND)
        estimates.append(estimate)
        variances.append(covariance[0])
    assert odometer.is_noisy
    assert all(estimate != Pose(float(second)) for second, estimate in enumerate(estimates, start=1))
    assert EXACT < variances[0] < variances[1] < variances[2]
    assert odometer.read(Pose(3.0), 3 * SECOND)[0] == estimates[-1]


def test_placing_makes_the_estimate_exact_again() -> None:
    odometer = Odometer(Pose(), 0, noise=NOISE, seed=SEED)
    odometer.read(Pose(1.0), SECOND)
    odometer.place(Pose(5.0), SECOND)
    estimate, covariance = odometer.read(Pose(5.0), SECOND)
    assert estimate == Pose(5.0) and covariance is PLANAR_COVARIANCE


@pytest.mark.parametrize("noise", [None, NOISE])
def test_readings_repeat_after_a_restore(noise: MotionNoise | None) -> None:
    odometer = Odometer(Pose(), 0, noise=noise, seed=SEED)
    odometer.read(Pose(1.0), SECOND)
    state, readings = odometer.save(), []
    for _ in range(2):
        estimate, covariance = odometer.read(Pose(2.0), 2 * SECOND)
        readings.append((estimate, covariance.tolist()))
        odometer.restore(state)
    assert readings[0] == readings[1]
