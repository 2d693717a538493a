"""pose: poses compose, invert, convert and unpack like three numbers."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mobile_robot_simulator as mrs
import reference

PI = math.pi
coordinates = st.floats(-1e3, 1e3)
poses = st.builds(mrs.Pose, coordinates, coordinates, st.floats(-10.0, 10.0))


def close(left: mrs.Pose, right: mrs.Pose, tolerance: float = 1e-9) -> bool:
    turn = math.remainder(left.yaw - right.yaw, 2.0 * PI)
    return math.hypot(left.x - right.x, left.y - right.y) < tolerance and abs(turn) < tolerance


def test_a_pose_is_three_numbers() -> None:
    pose = mrs.Pose(1.0, -2.0, 0.5)
    assert (pose.x, pose.y, pose.yaw) == tuple(pose) == (1.0, -2.0, 0.5)
    assert len(pose) == 3
    assert [pose[i] for i in range(3)] == [1.0, -2.0, 0.5]
    assert tuple(mrs.Pose()) == (0.0, 0.0, 0.0)
    assert mrs.Pose(x=1.0, y=2.0, yaw=3.0) == mrs.Pose(1.0, 2.0, 3.0)


@pytest.mark.parametrize("index", [3, -4])
def test_an_index_out_of_range_is_an_error(index: int) -> None:
    with pytest.raises(IndexError):
        mrs.Pose()[index]


def test_negative_indices_count_from_the_end() -> None:
    assert mrs.Pose(1.0, 2.0, 3.0)[-1] == 3.0


def test_composition_moves_along_the_heading() -> None:
    assert close(mrs.Pose(1.0, 2.0, PI / 2) * mrs.Pose(3.0, 1.0, 0.5), mrs.Pose(0.0, 5.0, PI / 2 + 0.5))
    assert close(mrs.Pose(1.0, 2.0, PI / 2) * (3.0, 1.0, 0.5), mrs.Pose(0.0, 5.0, PI / 2 + 0.5))


@given(poses, poses, poses)
def test_poses_form_a_group(a: mrs.Pose, b: mrs.Pose, c: mrs.Pose) -> None:
    assert close((a * b) * c, a * (b * c))
    assert close(a * a.inverse(), mrs.Pose())
    assert close(a.inverse() * (a * b), b)
    assert a * mrs.Pose() == a


@pytest.mark.parametrize(
    ("yaw", "wrapped"),
    [(0.0, 0.0), (PI, PI), (-PI, PI), (3 * PI, PI), (2 * PI, 0.0), (7.0, 7.0 - 2 * PI), (-7.0, 2 * PI - 7.0), (1e300, None)],
)
def test_wrapped_yaw_is_above_minus_pi_and_at_most_pi(yaw: float, wrapped: float | None) -> None:
    found = mrs.Pose(1.0, 2.0, yaw).wrapped()
    assert (found.x, found.y) == (1.0, 2.0)
    assert -PI < found.yaw <= PI
    if wrapped is not None:
        assert found.yaw == pytest.approx(wrapped, abs=1e-15)


@pytest.mark.parametrize("yaw", [-3.1, -PI / 2, 0.0, 0.3, PI / 2, PI])
def test_quaternions_convert_there_and_back(yaw: float) -> None:
    z, w = mrs.Pose(0.0, 0.0, yaw).quaternion
    assert (z, w) == pytest.approx((math.sin(yaw / 2), math.cos(yaw / 2)), abs=1e-15)
    for length in (1.0, 1e-3, 7.0):
        back = mrs.Pose.from_quaternion(1.0, 2.0, qx=0.0, qy=0.0, qz=length * z, qw=length * w)
        assert close(back, mrs.Pose(1.0, 2.0, yaw), 1e-14)


def test_roll_and_pitch_are_ignored() -> None:
    # A yaw of 0.4, followed by a roll of 0.2 about the x axis of the body.
    yaw, roll = 0.4, 0.2
    cz, sz, cx, sx = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(roll / 2), math.sin(roll / 2)
    pose = mrs.Pose.from_quaternion(0.0, 0.0, qx=cz * sx, qy=sz * sx, qz=sz * cx, qw=cz * cx)
    assert pose.yaw == pytest.approx(0.4, abs=1e-14)


def test_integration_follows_the_twist() -> None:
    assert close(mrs.Pose().integrate((1.0, 0.0, 1.0), PI / 2), mrs.Pose(1.0, 1.0, PI / 2), 1e-15)
    assert mrs.Pose(1.0, 2.0, 0.0).integrate((2.0, -1.0, 0.0), 0.5) == mrs.Pose(2.0, 1.5, 0.0)


def test_a_trace_has_the_poses_of_integrate() -> None:
    start, times = mrs.Pose(1.0, -2.0, 3.0), np.linspace(-2.0, 5.0, 50)
    for twist in ((1.0, 0.0, 0.0), (0.4, -0.2, 1.3), (0.0, 0.0, 0.0), (1.0, 1.0, 1e-9)):
        trace = start.trace(twist, times)
        assert trace.dtype == np.float64
        assert np.array_equal(trace, [tuple(start.integrate(twist, time)) for time in times])
    assert start.trace((1.0, 0.0, 0.0), []).shape == (0, 3)
    with pytest.raises(ValueError, match=r"^times must have shape \(N,\), got \(1, 2\)"):
        start.trace((1.0, 0.0, 0.0), [[0.0, 1.0]])
    with pytest.raises(ValueError, match=r"^times must be finite, got NaN"):
        start.trace((1.0, 0.0, 0.0), [0.0, math.nan])
    with pytest.raises(ValueError, match=r"^vx must be finite, got inf"):
        start.trace((math.inf, 0.0, 0.0), [0.0])


@pytest.mark.parametrize("fraction", [-1.0, 0.0, 0.25, 0.5, 1.0, 3.0])
def test_interpolation_stays_on_the_arc(fraction: float) -> None:
    start, twist = mrs.Pose(1.0, -2.0, 3.0), (0.8, 0.1, 0.9)
    found = start.interpolate(start.integrate(twist, 1.0), fraction)
    assert close(found, start.integrate(twist, fraction), 1e-12)


def test_interpolation_turns_by_the_smaller_angle() -> None:
    assert close(mrs.Pose(0.0, 0.0, 3.0).interpolate((0.0, 0.0, -3.0), 0.5), mrs.Pose(0.0, 0.0, PI), 1e-12)


def test_poses_with_equal_numbers_are_equal_and_have_equal_hashes() -> None:
    assert mrs.Pose(1.0, 2.0, 3.0) == mrs.Pose(1.0, 2.0, 3.0) != mrs.Pose(1.0, 2.0, 3.5)
    assert len({mrs.Pose(1.0, 2.0, 3.0), mrs.Pose(1.0, 2.0, 3.0)}) == 1
    assert mrs.Pose(0.0, 0.0, 0.0) == mrs.Pose(-0.0, 0.0, 0.0)
    assert hash(mrs.Pose(0.0, 0.0, 0.0)) == hash(mrs.Pose(-0.0, 0.0, 0.0))


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda pose: pickle.loads(pickle.dumps(pose))])
def test_copies_are_equal(duplicate: Any) -> None:
    pose = mrs.Pose(0.1, -2.5e-300, 1e17)
    assert tuple(duplicate(pose)) == tuple(pose)


def test_repr_evaluates_to_the_pose() -> None:
    pose = mrs.Pose(0.1, -2.0, 1e-7)
    assert eval(repr(pose), {"Pose": mrs.Pose}) == pose
    assert repr(mrs.Pose(1.0, 2.0, 0.5)) == "Pose(1.0, 2.0, 0.5)"


def test_a_pose_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        mrs.Pose().x = 1.0  # type: ignore[misc]


@pytest.mark.parametrize("pose", [(1.0, 2.0, 3.0), [1, 2, 3], np.array([1.0, 2.0, 3.0]), mrs.Pose(1.0, 2.0, 3.0)])
def test_three_numbers_are_a_pose(pose: Any) -> None:
    assert mrs.LaserScanner(mount=pose).mount == mrs.Pose(1.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: mrs.Pose(math.nan), ValueError, "x must be finite, got NaN"),
        (lambda: mrs.Pose(0.0, math.inf), ValueError, "y must be finite, got inf"),
        (lambda: mrs.Pose(0.0, 0.0, -math.inf), ValueError, "yaw must be finite, got -inf"),
        (lambda: mrs.Pose("1"), TypeError, "x"),
        (lambda: mrs.Pose(None), TypeError, "x"),
        (lambda: mrs.Pose() * 3.0, TypeError, "unsupported operand"),
        (lambda: mrs.Pose() * (1.0, 2.0), TypeError, "multiply"),
        (lambda: mrs.Pose() * (1.0, 2.0, math.nan), (ValueError, TypeError), ""),
        (lambda: mrs.Pose().integrate((math.nan, 0.0, 0.0), 1.0), ValueError, "finite"),
        (lambda: mrs.Pose().integrate((1.0, 0.0, 0.0), math.nan), ValueError, "finite"),
        (lambda: mrs.Pose().integrate((1.0, 0.0), 1.0), (ValueError, TypeError), ""),
        (lambda: mrs.Pose().interpolate((1.0, 0.0, 0.0), math.inf), ValueError, "finite"),
        (lambda: mrs.Pose.from_quaternion(0.0, 0.0, qx=0.0, qy=0.0, qz=0.0, qw=0.0), ValueError, "quaternion"),
        (lambda: mrs.Pose.from_quaternion(0.0, 0.0, qx=0.0, qy=0.0, qz=math.nan, qw=1.0), ValueError, "quaternion"),
    ],
)
def test_invalid_input_is_rejected(make: Any, error: Any, message: str) -> None:
    with pytest.raises(error) as caught:
        make()
    assert message in reference.message_of(caught.value)


def test_composition_and_inverse_never_return_a_pose_that_is_not_finite() -> None:
    """Operations that overflow must raise an error instead."""
    huge = mrs.Pose(1e308, 1e308, 1.7e308)
    for make in (lambda: huge * huge, lambda: mrs.Pose(1.7e308, 1.7e308, 0.8).inverse()):
        try:
            pose = make()
        except ValueError:
            continue
        assert all(map(math.isfinite, pose))


def test_numpy_reads_poses_as_rows_of_numbers():
    pose = mrs.Pose(1.0, 2.0, 0.5)
    assert np.array(pose).dtype == np.float64 and np.array_equal(np.array(pose), [1.0, 2.0, 0.5])
    assert np.array_equal(np.array([pose, pose.inverse()]), [tuple(pose), tuple(pose.inverse())])
    assert pose[-1] == 0.5 and pose[np.int64(1)] == 2.0 and len(pose) == 3
    with pytest.raises(IndexError):
        pose[3]
