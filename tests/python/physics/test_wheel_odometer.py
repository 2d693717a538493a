"""wheel_odometer: exact where encoders and calibration are, and off by what closed forms say where they are not."""

from __future__ import annotations

import math

import pytest

from mobile_robot_simulator import Drive, Limits, Pose
from mobile_robot_simulator.physics.motion import Motion
from mobile_robot_simulator.physics.wheel_odometer import WheelOdometer

SECOND = 1_000_000_000
TENTH = SECOND // 10
DRIVE = Drive.differential(track=0.4, wheel_radius=0.1)
CAR = Drive.ackermann(wheelbase=0.5, track=0.4, wheel_radius=0.1, steering_limit=0.6, steering_rate=0.5)


def driven(drive: Drive, believed: Drive, ticks: float = 0.0, readings: int = 50) -> tuple[Motion, Pose]:
    """Motion of 5 s at 0.6 m/s and 0.3 rad/s, and the pose that an odometer has computed in so many readings."""
    motion = Motion(0, 0.0, Pose(), Pose(), None, drive)
    odometer = WheelOdometer(believed, ticks, motion, Pose(), 0)
    motion.command((0.6, 0.0, 0.3), 0)
    pose = [odometer.read(motion, time * 5 * SECOND // readings).pose for time in range(readings + 1)][-1]
    return motion, pose


def test_exact_encoders_give_the_pose_of_the_wheels() -> None:
    motion, pose = driven(DRIVE, DRIVE)
    assert tuple(pose) == pytest.approx(tuple(motion.wheel_pose(5 * SECOND)), abs=1e-13)


def test_steering_between_two_readings_is_taken_for_its_mean() -> None:
    """The error is of second order in the time between two readings, because the steering stops between two of them."""
    motion, pose = driven(CAR, CAR)
    true = motion.wheel_pose(5 * SECOND)
    rough = math.hypot(pose.x - true.x, pose.y - true.y)
    _, pose = driven(CAR, CAR, readings=800)
    assert 0.0 < 50.0 * math.hypot(pose.x - true.x, pose.y - true.y) < rough < 1e-3


def test_a_wrong_calibration_has_its_closed_form() -> None:
    _, pose = driven(DRIVE, DRIVE.with_multipliers(track=1.25))
    assert tuple(pose) == pytest.approx(tuple(Pose().integrate((0.6, 0.0, 0.24), 5.0)), abs=1e-13)
    _, pose = driven(DRIVE, DRIVE.with_multipliers(left_radius=1.1, right_radius=1.1))
    assert tuple(pose) == pytest.approx(tuple(Pose().integrate((0.66, 0.0, 0.33), 5.0)), abs=1e-13)


def test_counts_are_never_lost() -> None:
    motion, pose = driven(DRIVE, DRIVE, ticks=64.0)
    counts = [math.floor(angle * 64.0 / (2.0 * math.pi)) for angle in motion.rolled(5 * SECOND)]
    assert pose.yaw == pytest.approx(0.1 * 2.0 * math.pi / 64.0 * (counts[1] - counts[0]) / 0.4, abs=1e-12)


def test_the_velocity_is_the_mean_since_the_last_reading() -> None:
    motion = Motion(0, 0.0, Pose(), Pose(), Limits(acceleration=(1.0, 1.0, 1.0)), DRIVE)
    odometer = WheelOdometer(DRIVE, 0.0, motion, Pose(), 0)
    motion.command((0.6, 0.0, 0.0), 0)
    assert odometer.read(motion, 2 * TENTH).velocity == (pytest.approx(0.1), 0.0, 0.0)
    assert odometer.read(motion, 2 * TENTH).velocity == (pytest.approx(0.1), 0.0, 0.0)
    assert odometer.read(motion, 4 * TENTH).velocity == (pytest.approx(0.3), 0.0, 0.0)


def test_a_pose_between_two_readings_changes_none_of_them() -> None:
    motion = Motion(0, 0.0, Pose(), Pose(), None, DRIVE)
    odometer = WheelOdometer(DRIVE.with_multipliers(left_radius=2.0, right_radius=2.0), 0.0, motion, Pose(), 0)
    motion.command((0.5, 0.0, 0.0), 0)
    assert odometer.read(motion, SECOND).pose.x == pytest.approx(1.0)
    assert odometer.pose_at(motion.wheel_pose(2 * SECOND)).x == pytest.approx(1.5)
    saved = odometer.save()
    assert odometer.read(motion, 2 * SECOND).pose.x == pytest.approx(2.0)
    odometer.restore(saved)
    assert odometer.read(motion, 3 * SECOND).pose.x == pytest.approx(3.0)
