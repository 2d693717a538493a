"""drive_profile: a command to wheels is followed exactly, whenever it is read, and steering outlives it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mobile_robot_simulator import Drive, Limits, Pose, WheelMotion
from mobile_robot_simulator.physics.drive_profile import DriveProfile, Steering
from mobile_robot_simulator.physics.velocity_profile import STANDING

SECOND = 1_000_000_000
CAR = Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.5)
LIMITS = Limits(acceleration=(0.5, 0.5, 0.5), deceleration=(1.0, 1.0, 1.0))


def profile(limits: Limits | None = LIMITS) -> DriveProfile:
    """Two seconds at 1 m/s, while the car steers from 0.1 rad at the time 0 to -0.4 rad at 1 s, from 0.5 s on."""
    steering = Steering(CAR, 0, angle=0.1, goal=-0.4)
    return DriveProfile(SECOND // 2, STANDING, (1.0, 0.0, 0.0), 5 * SECOND // 2, limits, steering=steering)


def test_steering_goes_on_from_any_time() -> None:
    steering = Steering(CAR, SECOND, angle=0.1, goal=-0.4, rate=0.25)
    assert [steering.at(time * SECOND) for time in (0, 1, 2, 3, 9)] == [0.1, 0.1, 0.1 - 0.25, -0.4, -0.4]
    assert [steering.rate_at(time * SECOND) for time in (1, 3)] == [-0.25, 0.0]
    assert Steering(CAR, 0, goal=9.0).at(9 * SECOND) == 0.6


def test_the_speed_follows_the_limits_and_the_turn_rate_the_steering() -> None:
    follows = profile()
    assert follows.velocity_at(SECOND // 2) == STANDING
    vx, vy, wz = follows.velocity_at(SECOND)
    assert (vx, vy, wz) == (0.25, 0.0, pytest.approx(0.25 * math.tan(-0.4) / 2.5))
    assert follows.ramp_velocity_at(SECOND) == (0.25, 0.0, 0.0)
    # 1 m/s after 2 s, then a stop in 1 s.
    assert follows.velocity_at(3 * SECOND)[0] == 0.5 and follows.velocity_at(9 * SECOND) == (0.0, 0.0, 0.0)
    assert follows.distance(9 * SECOND) == pytest.approx(1.5)
    assert not follows.is_constant and not profile(None).is_constant
    differential = Steering(Drive.differential(track=0.4, wheel_radius=0.1), 0)
    assert DriveProfile(0, STANDING, (1.0, 0.0, 0.0), SECOND, steering=differential).is_constant


def test_poses_are_those_of_the_wheels() -> None:
    follows, start = profile(), Pose(1.0, 2.0, 0.5)
    driving = WheelMotion(CAR, STANDING, (1.0, 0.0, 0.0), limits=LIMITS, steering_angle=-0.15, steering_goal=-0.4)
    released = WheelMotion(CAR, (1.0, 0.0, 0.0), STANDING, limits=LIMITS, steering_angle=-0.4)
    assert follows.move(start, SECOND) == driving.integrate(start, 0.5)
    end = released.integrate(driving.integrate(start, 2.0), 0.75)
    assert tuple(follows.move(start, 13 * SECOND // 4)) == pytest.approx(tuple(end), abs=1e-14)
    times = np.array([0, SECOND, 2 * SECOND, 3 * SECOND, 9 * SECOND])
    for grip in (1.0, 0.4):
        moved = [list(follows.move(start, int(time), grip)) for time in times]
        np.testing.assert_array_equal(follows.trace(start, times, grip), moved)


def test_wheels_have_rolled_as_far_as_the_car_has_driven() -> None:
    follows = profile()
    rolled = follows.rolled(9 * SECOND, CAR, 0.0)
    assert 0.3 * 0.5 * (rolled[2] + rolled[3]) == pytest.approx(1.5, abs=1e-12)
    turn = follows.move(Pose(), 9 * SECOND).yaw
    assert 0.3 * (rolled[3] - rolled[2]) / 1.5 == pytest.approx(turn, abs=1e-12)
