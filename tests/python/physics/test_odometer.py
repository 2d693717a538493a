"""odometer: exact without noise; with noise, pose and velocity tell one story at every rate, as do their covariances."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mobile_robot_simulator import MotionNoise, Pose
from mobile_robot_simulator.physics.odometer import EXACT, PLANAR_COVARIANCE, UNMEASURED, Odometer

NOISE = MotionNoise(alpha1=0.1, alpha4=0.1)
SEED = 3
SECOND = 1_000_000_000
PLANE = np.ix_([0, 1, 5], [0, 1, 5])


def test_without_noise_the_estimate_is_the_pose_of_the_wheels() -> None:
    odometer = Odometer(Pose(), 0)
    reading = odometer.read(Pose(1.0, 2.0, 0.5), SECOND)
    assert reading.pose == Pose(1.0, 2.0, 0.5) and reading.twist is None and odometer.is_exact
    assert reading.covariance is PLANAR_COVARIANCE and not reading.covariance.flags.writeable
    assert np.diag(reading.covariance.reshape(6, 6)).tolist() == [EXACT, EXACT, UNMEASURED, UNMEASURED, UNMEASURED, EXACT]


def test_with_noise_the_estimate_drifts_and_its_covariance_grows() -> None:
    odometer = Odometer(Pose(), 0, noise=NOISE, seed=SEED)
    estimates, variances = [], []
    for second in range(1, 4):
        reading = odometer.read(Pose(float(second)), second * SECOND)
        estimates.append(reading.pose)
        variances.append(reading.covariance[0])
    assert not odometer.is_exact
    assert all(estimate != Pose(float(second)) for second, estimate in enumerate(estimates, start=1))
    assert EXACT < variances[0] < variances[1] < variances[2]
    assert odometer.read(Pose(3.0), 3 * SECOND).pose == estimates[-1]


def test_between_two_readings_the_estimate_moves_with_the_wheels() -> None:
    odometer, other = (Odometer(Pose(), 0, noise=NOISE, seed=SEED) for _ in range(2))
    reading = odometer.read(Pose(1.0), SECOND)
    other.read(Pose(1.0), SECOND)
    assert tuple(odometer.pose_at(Pose(1.5))) == pytest.approx(tuple(reading.pose * Pose(0.5)), abs=1e-12)
    # It takes nothing from the random stream.
    assert odometer.read(Pose(2.0), 2 * SECOND).pose == other.read(Pose(2.0), 2 * SECOND).pose
    assert Odometer(Pose(), 0).pose_at(Pose(1.5, 0.1, 0.2)) == Pose(1.5, 0.1, 0.2)


def test_without_noise_from_now_on_the_error_stays() -> None:
    odometer = Odometer(Pose(), 0, noise=NOISE, seed=SEED)
    error = odometer.read(Pose(1.0), SECOND).pose.x - 1.0
    odometer.set_noise(None, 0)
    reading = odometer.read(Pose(3.0), 2 * SECOND)
    assert error != 0.0 and reading.pose.x - 3.0 == pytest.approx(error, abs=1e-12)
    assert reading.twist == pytest.approx((2.0, 0.0, 0.0)) and reading.twist_covariance[0] == EXACT


@pytest.mark.parametrize("noise", [None, NOISE])
def test_readings_repeat_after_a_restore(noise: MotionNoise | None) -> None:
    odometer = Odometer(Pose(), 0, noise=noise, seed=SEED)
    odometer.read(Pose(1.0), SECOND)
    state, readings = odometer.save(), []
    for _ in range(2):
        reading = odometer.read(Pose(2.0), 2 * SECOND)
        readings.append((reading.pose, reading.twist, reading.covariance.tolist(), reading.twist_covariance.tolist()))
        odometer.restore(state)
    assert readings[0] == readings[1]


@pytest.mark.parametrize("rate", [10, 50, 100])
def test_the_drift_does_not_depend_on_the_rate_of_readings(rate: int) -> None:
    """At 0.5 m/s for 2 s, alpha1 = 0.1 for steps of 0.1 s gives x a variance of 20 * 0.1 * 0.5**2 * 0.1**2 m^2.

    With 400 drives, the standard deviation of the estimated one is 3.5 %; the test allows four of them.
    """
    noise = MotionNoise(alpha1=0.1, reference_step=0.1)
    ends = []
    for seed in range(400):
        odometer = Odometer(Pose(), 0, noise=noise, seed=seed)
        for nth in range(1, 2 * rate + 1):
            reading = odometer.read(Pose(0.5 * nth / rate), nth * SECOND // rate)
        ends.append(reading.pose.x)
    variance = 20 * 0.1 * 0.5**2 * 0.1**2
    assert np.std(ends) == pytest.approx(np.sqrt(variance), rel=0.14)
    assert reading.covariance[0] == pytest.approx(variance, rel=1e-6)


@pytest.mark.parametrize("seconds", [2, 8])
def test_errors_of_the_pose_and_of_the_fused_twist_agree_with_their_covariances(seconds: int) -> None:
    """The normalised squared errors of 300 drives have a mean of 3, within four standard deviations of 0.14.

    A filter that fuses only the twist, as robot_localization usually does, drifts as the pose of the message does.
    """
    alphas = {"alpha1": 0.02, "alpha2": 0.01, "alpha3": 0.01, "alpha4": 0.02, "alpha5": 0.005, "alpha6": 0.005}
    noise, twist, rate, runs = MotionNoise(**alphas, reference_step=0.1), (0.6, 0.0, 0.3), 20, 300
    from_pose, from_twist = [], []
    for seed in range(runs):
        odometer = Odometer(Pose(), 0, noise=noise, seed=seed)
        fused, covariance = Pose(), EXACT * np.eye(3)
        for nth in range(1, seconds * rate + 1):
            wheels = Pose().integrate(twist, nth / rate).wrapped()
            reading = odometer.read(wheels, nth * SECOND // rate)
            assert reading.twist is not None
            fused, covariance = predict(fused, covariance, reading.twist, reading.twist_covariance, 1 / rate)
        assert tuple(fused) == pytest.approx(tuple(reading.pose), abs=1e-9)
        from_pose.append(squared_error(reading.pose, wheels, reading.covariance.reshape(6, 6)[PLANE]))
        from_twist.append(squared_error(fused, wheels, covariance))
    assert np.mean(from_pose) == pytest.approx(3.0, abs=0.57)
    assert np.mean(from_twist) == pytest.approx(3.0, abs=0.57)


def predict(
    pose: Pose, covariance: NDArray[np.float64], twist: tuple[float, ...], noise: NDArray[np.float64], dt: float
) -> tuple[Pose, NDArray[np.float64]]:
    """Prediction of an extended Kalman filter over (x, y, yaw) from a measured velocity (vx, vy, wz)."""
    after = pose.integrate(twist, dt).wrapped()
    cos, sin = np.cos(pose.yaw), np.sin(pose.yaw)
    by_pose = np.array([[1.0, 0.0, -(after.y - pose.y)], [0.0, 1.0, after.x - pose.x], [0.0, 0.0, 1.0]])
    by_twist = dt * np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    measured = noise.reshape(6, 6)[PLANE]
    return after, by_pose @ covariance @ by_pose.T + by_twist @ measured @ by_twist.T


def squared_error(estimate: Pose, true: Pose, covariance: NDArray[np.float64]) -> float:
    """Normalised estimation error squared (NEES)."""
    yaw = Pose(yaw=estimate.yaw - true.yaw).wrapped().yaw
    error = np.array([estimate.x - true.x, estimate.y - true.y, yaw])
    return float(error @ np.linalg.solve(covariance, error))
