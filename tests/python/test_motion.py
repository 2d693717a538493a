"""motion: a constant twist is integrated exactly."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
import reference

PI = math.pi
MOTION_SEED = 3


def move(pose: tuple[float, ...], twist: tuple[float, ...], dt: float) -> list[float]:
    return mrs.integrate_twist(np.array([pose], float), np.array([twist], float), dt)[0].tolist()


@pytest.mark.parametrize(
    ("pose", "twist", "dt", "expected"),
    [
        # Straight ahead.
        ((0, 0, 0), (1, 0, 0), 2.0, (2, 0, 0)),
        ((1, 2, 0), (0.5, -0.25, 0), 4.0, (3, 1, 0)),
        ((1, 2, PI / 2), (2, 1, 0), 1.5, (-0.5, 5, PI / 2)),
        ((0, 0, PI), (1, 0, 0), 1.0, (-1, 0, PI)),
        # On the spot.
        ((3, 4, 0.5), (0, 0, 2), 0.25, (3, 4, 1.0)),
        # Quarter, half and full turns on a circle of radius v/ω.
        ((0, 0, 0), (1, 0, 1), PI / 2, (1, 1, PI / 2)),
        ((0, 0, 0), (1, 0, -1), PI / 2, (1, -1, -PI / 2)),
        ((0, 0, PI / 2), (1, 0, 1), PI / 2, (-1, 1, PI)),
        ((0, 0, 0), (2, 0, 0.5), PI, (4, 4, PI / 2)),
        ((0, 0, 0), (1, 0, 1), PI, (0, 2, PI)),
        ((5, -5, 1), (1, 0, 1), 2 * PI, (5, -5, 1 + 2 * PI)),
        ((5, -5, 1), (0.3, 0.4, -2), 3 * PI, (5, -5, 1 - 6 * PI)),
        # Sideways on a circle whose centre is behind the robot.
        ((0, 0, 0), (0, 1, 1), PI / 2, (-1, 1, PI / 2)),
        # Backwards in space and backwards in time.
        ((0, 0, 0), (-1, 0, 1), PI / 2, (-1, -1, PI / 2)),
        ((1, 1, PI / 2), (1, 0, 1), -PI / 2, (0, 0, 0)),
        ((1, 2, 3), (1, 1, 1), 0.0, (1, 2, 3)),
    ],
)
def test_closed_forms(pose: tuple[float, ...], twist: tuple[float, ...], dt: float, expected: tuple[float, ...]) -> None:
    assert move(pose, twist, dt) == pytest.approx(expected, abs=3e-15 * (1.0 + max(map(abs, expected)) * max(1.0, abs(dt))))


def test_the_yaw_is_not_wrapped() -> None:
    assert move((0, 0, 3.0), (0, 0, 1), 1.0)[2] == 4.0


@pytest.mark.parametrize("steps", [1, 4, 63, 1000])
def test_a_full_circle_closes_in_any_number_of_steps(steps: int) -> None:
    """With v = ω = 1 and steps of 0.1 s, exact steps miss by 7e-15 m, Euler steps by 8e-4 m, midpoint steps by 7e-6 m."""
    pose = np.array([[0.0, 0.0, 0.0]])
    for _ in range(steps):
        pose = mrs.integrate_twist(pose, np.array([[1.0, 0.0, 1.0]]), 2 * PI / steps)
    assert np.hypot(*pose[0, :2]) < (5e-14 if steps < 1000 else 1e-12)


def test_a_quarter_circle_in_steps_of_a_tenth_of_a_second() -> None:
    """The error of the Euler method is visible after a quarter circle, but not after a full one."""
    pose, twist = np.zeros((1, 3)), np.array([[1.0, 0.0, 1.0]])
    for _ in range(15):
        pose = mrs.integrate_twist(pose, twist, 0.1)
    pose = mrs.integrate_twist(pose, twist, PI / 2 - 1.5)
    assert pose[0] == pytest.approx([1.0, 1.0, PI / 2], abs=5e-15)


@pytest.mark.parametrize("omega", [sign * 10.0**exponent for exponent in range(-320, 3, 7) for sign in (-1, 1)])
def test_any_turn_rate_agrees_with_the_chord(omega: float) -> None:
    """The chord of the arc has length 2·v/ω·sin(φ/2) and direction φ/2. The formula here is also accurate for small φ."""
    dt, speed = 1.7, 0.8
    half = 0.5 * omega * dt
    chord = speed * dt * (math.sin(half) / half if abs(half) > 1e-150 else 1.0)
    expected = (3.0 + chord * math.cos(0.7 + half), -1.0 + chord * math.sin(0.7 + half), 0.7 + omega * dt)
    assert move((3.0, -1.0, 0.7), (speed, 0.0, omega), dt) == pytest.approx(expected, abs=2e-15 * 8)


def integrate_in_small_steps(pose: NDArray[np.float64], twist: NDArray[np.float64], dt: float) -> NDArray[np.float64]:
    """Integrates with 2000 steps of the classic Runge-Kutta method, without a closed form."""

    def rate(state: NDArray[np.float64]) -> NDArray[np.float64]:
        cos, sin = np.cos(state[:, 2]), np.sin(state[:, 2])
        return np.column_stack([cos * twist[:, 0] - sin * twist[:, 1], sin * twist[:, 0] + cos * twist[:, 1], twist[:, 2]])

    h = dt / 2000
    for _ in range(2000):
        k1 = rate(pose)
        k2 = rate(pose + 0.5 * h * k1)
        k3 = rate(pose + 0.5 * h * k2)
        k4 = rate(pose + h * k3)
        pose = pose + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return pose


def test_random_twists_agree_with_small_steps() -> None:
    rng = np.random.default_rng(MOTION_SEED)
    poses, twists = rng.uniform(-5.0, 5.0, (200, 3)), rng.uniform(-2.0, 2.0, (200, 3))
    assert np.allclose(
        mrs.integrate_twist(poses, twists, 1.3), integrate_in_small_steps(poses, twists, 1.3), rtol=0.0, atol=1e-11
    )


numbers = st.floats(-100.0, 100.0)


@given(
    st.tuples(numbers, numbers, numbers),
    st.tuples(numbers, numbers, st.floats(-10.0, 10.0)),
    st.floats(0.0, 5.0),
    st.floats(0.0, 5.0),
)
def test_two_steps_equal_one(pose: tuple[float, ...], twist: tuple[float, ...], one: float, two: float) -> None:
    assert move(tuple(move(pose, twist, one)), twist, two) == pytest.approx(move(pose, twist, one + two), abs=1e-9)


@given(st.tuples(numbers, numbers, numbers), st.tuples(numbers, numbers, numbers), st.floats(-5.0, 5.0))
def test_a_pose_moves_as_in_a_batch(pose: tuple[float, ...], twist: tuple[float, ...], dt: float) -> None:
    assert list(mrs.Pose(*pose).integrate(twist, dt)) == move(pose, twist, dt)


def test_a_batch_equals_a_loop() -> None:
    rng = np.random.default_rng(MOTION_SEED)
    poses, twists = rng.normal(size=(50, 3)), rng.normal(size=(50, 3))
    before = poses.copy(), twists.copy()
    moved = mrs.integrate_twist(poses, twists, 0.3)
    assert (moved.shape, moved.dtype) == ((50, 3), np.float64)
    assert moved.tolist() == [move(tuple(pose), tuple(twist), 0.3) for pose, twist in zip(poses, twists, strict=True)]
    assert np.array_equal(poses, before[0]) and np.array_equal(twists, before[1])
    assert mrs.integrate_twist(np.zeros((0, 3)), np.zeros((0, 3)), 1.0).shape == (0, 3)


@pytest.mark.parametrize(
    "view", [np.asfortranarray, lambda rows: rows[::-1][::-1], lambda rows: np.repeat(rows, 3, axis=0)[::3]]
)
def test_every_memory_layout_is_accepted(view: Any) -> None:
    rng = np.random.default_rng(MOTION_SEED)
    poses, twists = rng.normal(size=(50, 3)), rng.normal(size=(50, 3))
    assert np.array_equal(mrs.integrate_twist(view(poses), view(twists), 0.3), mrs.integrate_twist(poses, twists, 0.3))


def test_packed_records_are_read_correctly() -> None:
    records = np.zeros(4, [("label", "i1"), ("pose", "f8", (3,)), ("twist", "f8", (3,))])
    records["pose"], records["twist"] = np.arange(12).reshape(4, 3), np.arange(12, 24).reshape(4, 3)
    expected = mrs.integrate_twist(records["pose"].copy(), records["twist"].copy(), 0.5)
    assert np.array_equal(mrs.integrate_twist(records["pose"], records["twist"], 0.5), expected)


@pytest.mark.parametrize("dt", [1e6, 1e12, 1e15])
def test_a_long_time_on_a_circle_stays_on_it(dt: float) -> None:
    x, y, _ = move((0, 0, 0), (1, 0, 1), dt)
    assert math.hypot(x, y - 1.0) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(
    ("pose", "twist", "dt"),
    [((0, 0, 0), (1, 0, 1e308), 1e308), ((1e308, 0, 0), (1e308, 0, 0), 1.0), ((0, 0, 1.7e308), (0, 0, 1.7e308), 1.0)],
)
def test_an_overflow_is_an_error(pose: tuple[float, ...], twist: tuple[float, ...], dt: float) -> None:
    """An overflow raises an error and never returns an infinite or NaN pose."""
    with pytest.raises(ValueError, match="finite"):
        move(pose, twist, dt)
    with pytest.raises(ValueError, match="finite"):
        mrs.Pose(*pose).integrate(twist, dt)


ONE = np.zeros((1, 3))


@pytest.mark.parametrize(
    ("poses", "twists", "dt", "error", "message"),
    [
        (np.zeros((2, 3)), ONE, 0.1, ValueError, "twists must have 2 elements, got 1"),
        (np.zeros(3), ONE, 0.1, ValueError, "poses must have shape (N, 3), got (3,)"),
        (ONE, np.zeros((1, 2)), 0.1, ValueError, "twists must have shape (N, 3), got (1, 2)"),
        (ONE.astype(complex), ONE, 0.1, TypeError, "poses must have dtype float64, got complex128"),
        (ONE, ONE.astype(bool), 0.1, TypeError, "twists must have dtype float64, got bool"),
        (ONE, "abc", 0.1, TypeError, "twists must have dtype float64, got <U3"),
        (ONE + math.nan, ONE, 0.1, ValueError, "poses must be finite"),
        (ONE, ONE + math.inf, 0.1, ValueError, "twists must be finite, got [inf, inf, inf] in row 0"),
        (ONE, ONE, math.nan, ValueError, "dt must be finite, got NaN"),
        (ONE, ONE, math.inf, ValueError, "dt must be finite, got inf"),
        (ONE, ONE, "0.1", TypeError, "dt"),
        (ONE, ONE, None, TypeError, "dt"),
    ],
)
def test_invalid_input_is_rejected(poses: Any, twists: Any, dt: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        mrs.integrate_twist(poses, twists, dt)
    assert message in reference.message_of(caught.value)
