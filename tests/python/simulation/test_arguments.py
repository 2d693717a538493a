"""Arguments: numbers, durations and poses are checked and converted."""

from __future__ import annotations

import math

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.simulation.arguments import check_at_least_0, to_nanoseconds, to_pose


@pytest.mark.parametrize("value", [-1.0, math.inf, math.nan])
def test_numbers_must_be_finite_and_not_negative(value):
    check_at_least_0(speed=0.0, distance=1.5)
    with pytest.raises(ValueError, match="distance must be finite and at least 0, got"):
        check_at_least_0(speed=0.0, distance=value)
    with pytest.raises(ValueError, match="the duration must be finite and at least 0 s, got"):
        to_nanoseconds(value, "the duration")


def test_durations_are_rounded_to_nanoseconds():
    assert to_nanoseconds(0.1 + 0.2, "the duration") == 300_000_000


def test_poses_are_three_numbers():
    pose = mrs.Pose(1.0, 2.0, 3.0)
    assert to_pose(pose, "start") is pose
    assert to_pose((1, 2, 3), "start") == pose
    for short in ((1.0, 2.0), (1.0, 2.0, 3.0, 4.0), ()):
        with pytest.raises(ValueError, match="start must be three numbers"):
            to_pose(short, "start")
    for wrong in ("here", "123", None, 5.0, (1.0, 2.0, "x")):
        with pytest.raises(TypeError, match="start must be three numbers"):
            to_pose(wrong, "start")
