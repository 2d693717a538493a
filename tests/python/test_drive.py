"""drive: wheels and velocities invert each other, commands keep to what wheels can do, and batches are exact.

The reference values are those of the tests of ros2_controllers (commit 94e74de, 2026-08-18):

- `diff_drive_controller/test/test_odometry.cpp`
- `steering_controllers_library/test/test_steering_odometry.cpp`
- `mecanum_drive_controller/test/test_mecanum_drive_controller.cpp`, whose `sum_of_robot_center_projection_on_X_Y_axis` is
  half of the sum of wheel base and track
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
from mobile_robot_simulator import Drive, Limits, Pose, WheelMotion

SEED = 7
CAR = Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.5)
DIFFERENTIAL = Drive.differential(track=0.31, wheel_radius=0.083)
OMNI = Drive.omni(wheelbase=0.37, track=0.29, wheel_radius=0.07)


def wheels(drive: Drive, *twist: float) -> list[float]:
    return drive.wheels_of_twist([twist])[0].tolist()


def twist(drive: Drive, *wheels: float, steering: float | None = None) -> list[float]:
    return drive.twist_of_wheels([wheels], None if steering is None else [steering])[0].tolist()


# --- reference values ---


@pytest.mark.parametrize(
    ("left", "right", "velocity", "pose"),
    [
        (1.0, 1.0, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        (-1.0, 1.0, (0.0, 0.0, 2.0), (0.0, 0.0, 2.0)),
        (1.0, 2.0, (1.5, 0.0, 1.0), (1.5 * math.sin(1.0), -1.5 * (math.cos(1.0) - 1.0), 1.0)),
    ],
)
def test_a_differential_drive_is_that_of_ros2_controllers(
    left: float, right: float, velocity: tuple[float, ...], pose: tuple[float, ...]
) -> None:
    drive = Drive.differential(track=1.0, wheel_radius=1.0)
    assert tuple(twist(drive, left, right)) == velocity
    assert tuple(Pose().integrate(drive.odometry((0.0, 0.0), (left, right)), 1.0)) == pytest.approx(pose, abs=1e-15)


def test_a_steered_drive_is_that_of_ros2_controllers() -> None:
    drive = Drive.ackermann(wheelbase=1.0, track=1.0, wheel_radius=1.0, steering_limit=1.5)
    # Tricycle and Ackermann: both rear wheels at 1 rad/s, all front wheels at 0.1 rad, for 0.1 s.
    speed, _, turn = twist(drive, 1.0, 1.0, 1.0, 1.0, steering=0.1)
    assert (speed, turn) == (pytest.approx(1.002, abs=1e-3), pytest.approx(0.1, abs=1e-3))
    x, _, yaw = Pose().integrate((speed, 0.0, turn), 0.1)
    assert (x, yaw) == (pytest.approx(0.1, abs=1e-3), pytest.approx(0.01, abs=1e-3))
    # Bicycle: the speed is that of the axle.
    motion = WheelMotion(drive, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), steering_angle=0.1)
    assert motion.velocity(0.0) == (pytest.approx(1.0, abs=1e-3), 0.0, pytest.approx(0.1, abs=1e-3))
    x, _, yaw = motion.integrate(Pose(), 0.1)
    assert (x, yaw) == (pytest.approx(0.1, abs=1e-3), pytest.approx(0.01, abs=1e-3))


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_steered_drive_takes_commands_as_ros2_controllers_do(side: float) -> None:
    drive = Drive.ackermann(wheelbase=2.0, track=1.0, wheel_radius=1.0, steering_limit=1.5)
    front_left, front_right, rear_left, rear_right = wheels(drive, 1.0, 0.0, 0.1 * side)
    (left, right), (velocity, steering) = (
        drive.steering_angles([math.atan(0.2 * side)])[0],
        drive.command((1.0, 0.0, 0.1 * side)),
    )
    assert (rear_right - rear_left) * side > 0.0 and (front_right - front_left) * side > 0.0 and rear_left > 0.0
    assert (left - right) > 0.0 and left * side > 0.0
    assert velocity == (1.0, 0.0, 0.0) and steering == math.atan(0.2 * side)
    # Straight ahead, all wheels are the same.
    assert wheels(drive, 1.0, 0.0, 0.0) == [1.0] * 4 and drive.steering_angles([0.0]).tolist() == [[0.0, 0.0]]


def test_a_mecanum_drive_is_that_of_ros2_controllers() -> None:
    drive = Drive.omni(wheelbase=1.0, track=1.0, wheel_radius=0.5)
    assert wheels(drive, 1.5, 0.0, 0.0) == [3.0] * 4 and wheels(drive, 3.0, 0.0, 0.0) == [6.0] * 4
    assert twist(drive, 0.1, 0.1, 0.1, 0.1) == pytest.approx([0.05, 0.0, 0.0], abs=1e-16)


# --- wheels and velocities ---


def test_wheels_to_velocity_and_back_is_exact_to_the_last_digits() -> None:
    twists = np.random.default_rng(SEED).normal(size=(1000, 3))
    twists[:, 1] = 0.0
    np.testing.assert_allclose(
        DIFFERENTIAL.twist_of_wheels(DIFFERENTIAL.wheels_of_twist(twists)), twists, rtol=0, atol=2e-15
    )
    within = twists * (1.0, 0.0, 0.2)
    within = within[np.abs(2.5 * within[:, 2]) < 0.68 * np.abs(within[:, 0])]
    steering = CAR.steering_of_twist(within)
    rates = CAR.wheels_of_twist(within)
    assert len(within) > 300
    np.testing.assert_allclose(CAR.twist_of_wheels(rates), within, rtol=0, atol=2e-15)
    np.testing.assert_allclose(CAR.twist_of_wheels(rates, steering), within, rtol=0, atol=2e-15)
    np.testing.assert_array_equal(CAR.wheels_of_twist(within, steering), rates)
    twists[:, 1] = np.random.default_rng(SEED + 1).normal(size=1000)
    np.testing.assert_allclose(OMNI.twist_of_wheels(OMNI.wheels_of_twist(twists)), twists, rtol=0, atol=4e-15)


def test_batches_have_the_right_shapes() -> None:
    assert DIFFERENTIAL.wheels_of_twist(np.zeros((0, 3))).shape == (0, 2)
    assert CAR.twist_of_wheels(np.zeros((5, 4))).shape == (5, 3) and CAR.steering_angles([0.0, 0.1]).shape == (2, 2)
    assert CAR.wheel_count == OMNI.wheel_count == 4 and DIFFERENTIAL.wheel_count == 2


def test_a_wheel_near_the_centre_of_the_turn_is_left_out() -> None:
    car = Drive.ackermann(wheelbase=1.0, track=1.0, wheel_radius=0.1, steering_limit=1.5)
    # The centre of a turn to the left at atan(2) is the left rear wheel.
    steering = math.atan(2.0)
    rates = car.wheels_of_twist([(1.0, 0.0, 2.0)])
    assert rates[0, 2] == pytest.approx(0.0, abs=1e-14)
    np.testing.assert_allclose(car.twist_of_wheels(rates, [steering]), [(1.0, 0.0, 2.0)], atol=1e-15)


# --- odometry ---


def odometry(drive: Drive, angles: NDArray[np.float64], ticks: float) -> Pose:
    """Pose after the wheels have had these angles one after the other."""
    pose = Pose()
    for before, after in pairwise(angles):
        pose = pose.integrate(drive.odometry(before, after, ticks=ticks), 1.0)
    return pose


def test_odometry_from_counts_is_exact_to_a_count() -> None:
    rates = DIFFERENTIAL.wheels_of_twist([(0.7, 0.0, 0.4)])[0]
    angles = np.outer(np.linspace(0.0, 5.0, 400), rates)
    exact = Pose().integrate((0.7, 0.0, 0.4), 5.0)
    assert tuple(odometry(DIFFERENTIAL, angles, 0.0)) == pytest.approx(tuple(exact), abs=1e-12)
    count = 0.083 * 2.0 * math.pi / 4096
    found = odometry(DIFFERENTIAL, angles, 4096)
    # The heading is off by at most one count of each wheel, over the track, however many steps there were.
    assert 0.0 < abs(found.yaw - exact.yaw) < count / 0.31
    assert math.hypot(found.x - exact.x, found.y - exact.y) < 3.5 * count / 0.31
    coarse = odometry(DIFFERENTIAL, angles, 16)
    whole = np.floor(angles[-1] * 16 / (2.0 * math.pi)) * (2.0 * math.pi / 16)
    assert coarse.yaw == pytest.approx(0.083 * (whole[1] - whole[0]) / 0.31, abs=1e-12)


def test_a_wrong_radius_and_a_wrong_track_have_their_closed_forms() -> None:
    believed = DIFFERENTIAL.with_multipliers(left_radius=1.01, right_radius=1.01)
    forward = DIFFERENTIAL.wheels_of_twist([(1.0, 0.0, 0.5)])[0]
    assert believed.odometry((0.0, 0.0), forward) == pytest.approx((1.01, 0.0, 0.505), abs=1e-15)
    assert DIFFERENTIAL.with_multipliers(track=1.25).odometry((0.0, 0.0), forward) == pytest.approx((1.0, 0.0, 0.4))
    # The right wheel is believed 2 % too large: the robot believes that it turns left.
    believed = DIFFERENTIAL.with_multipliers(right_radius=1.02)
    x, _, turn = believed.odometry((0.0, 0.0), DIFFERENTIAL.wheels_of_twist([(1.0, 0.0, 0.0)])[0])
    assert (x, turn) == (pytest.approx(1.01), pytest.approx(0.02 / 0.31))


# --- steps ---


def test_a_step_at_constant_steering_is_an_arc() -> None:
    steering = np.linspace(-0.6, 0.6, 9)
    speeds = np.linspace(-2.0, 2.0, 9)
    states = np.column_stack([np.zeros((9, 3)), steering])
    poses, after = CAR.step(np.zeros((9, 3)), states, np.column_stack([speeds, steering]), dt=3.0)
    turn = speeds * np.tan(steering) / 2.5 * 3.0
    arcs = mrs.integrate_twist(np.zeros((9, 3)), np.column_stack([speeds, np.zeros(9), turn / 3.0]), dt=3.0)
    np.testing.assert_allclose(poses, arcs, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(after[:, 3], steering)


def test_a_step_of_a_differential_drive_is_that_of_a_twist() -> None:
    twists = np.random.default_rng(SEED).normal(size=(50, 3))
    poses, states = DIFFERENTIAL.step(np.zeros((50, 3)), np.zeros((50, 4)), twists, dt=0.7)
    forward = twists * (1.0, 0.0, 1.0)
    np.testing.assert_array_equal(poses, mrs.integrate_twist(np.zeros((50, 3)), forward, dt=0.7))
    np.testing.assert_array_equal(states, np.column_stack([forward, np.zeros(50)]))


def test_steering_at_a_constant_rate_is_exact_to_a_nanometre() -> None:
    """Compared with midpoint sums in extended precision, extrapolated (Richardson)."""
    motion = WheelMotion(CAR, (1.5, 0.0, 0.0), (1.5, 0.0, 0.0), steering_angle=-0.4, steering_goal=0.6)

    def summed(steps: int) -> NDArray[np.longdouble]:
        time = (np.arange(steps, dtype=np.longdouble) + 0.5) * (np.longdouble(2.0) / steps)
        # The heading is an integral in closed form: v / (L·r) · ln(cos a / cos(a + r·t)).
        yaw = np.longdouble(1.5) / (2.5 * 0.5) * np.log(np.cos(np.longdouble(-0.4)) / np.cos(-0.4 + 0.5 * time))
        return np.array([np.cos(yaw).sum(), np.sin(yaw).sum()]) * (np.longdouble(3.0) / steps)

    x, y = (4.0 * summed(200_000) - summed(100_000)) / 3.0
    end = motion.integrate(Pose(), 2.0)
    assert (end.x, end.y) == (pytest.approx(float(x), abs=1e-13), pytest.approx(float(y), abs=1e-13))
    trace = motion.trace(Pose(), [0.5, 2.0])
    assert trace[1].tolist() == [end.x, end.y, end.yaw]


def test_limits_of_wheels_and_steering_have_their_closed_forms() -> None:
    drive = Drive.differential(track=0.4, wheel_radius=0.1, wheel_speed_limit=10.0)
    motion = WheelMotion(drive, (0.0, 0.0, 0.0), (1.2, 0.0, 1.5))
    assert motion.velocity(0.0) == pytest.approx((0.8, 0.0, 1.0), abs=1e-15)
    assert motion.wheels(0.0).tolist() == pytest.approx([6.0, 10.0], abs=1e-14)
    assert motion.ramp_velocity(0.0) == (1.2, 0.0, 1.5)
    # From 0 at 0.5 m/s²: the wheels are at 10 rad/s after 2 s, and have driven 1 m; then 1 m/s.
    motion = WheelMotion(drive, (0.0, 0.0, 0.0), (3.0, 0.0, 0.0), limits=Limits(acceleration=(0.5, 0.5, 0.5)))
    assert motion.integrate(Pose(), 5.0).x == pytest.approx(4.0, abs=1e-14)
    assert motion.rolled(5.0).tolist() == pytest.approx([40.0, 40.0], abs=1e-12)
    assert motion.distance(5.0) == pytest.approx(4.0, abs=1e-12)
    steering = WheelMotion(CAR, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), steering_goal=9.0)
    assert [steering.steering(time) for time in (0.0, 0.5, 1.2, 9.0)] == [0.0, 0.25, 0.6, 0.6]


def test_the_errors_name_what_is_wrong() -> None:
    with pytest.raises(ValueError, match=r"wheels must have shape \(N, 2\), got \(1, 4\)"):
        DIFFERENTIAL.twist_of_wheels(np.zeros((1, 4)))
    with pytest.raises(ValueError, match="steering must have 1 elements, got 2"):
        CAR.wheels_of_twist(np.zeros((1, 3)), [0.1, 0.2])
    with pytest.raises(ValueError, match=r"commands must have shape \(N, 3\) for a drive that does not steer, got \(1, 2\)"):
        OMNI.step(np.zeros((1, 3)), np.zeros((1, 4)), np.zeros((1, 2)), dt=0.1)
    with pytest.raises(ValueError, match="states must have 2 elements, got 1"):
        OMNI.step(np.zeros((2, 3)), np.zeros((1, 4)), np.zeros((2, 3)), dt=0.1)
    with pytest.raises(ValueError, match="wheel_radius must be positive, got -1"):
        Drive.differential(track=0.4, wheel_radius=(0.1, -1.0))
    with pytest.raises(TypeError, match=r"wheel_radius must be a number or two numbers \(left, right\), got 'a'"):
        Drive.differential(track=0.4, wheel_radius="a")  # type: ignore[arg-type]
    with pytest.raises(
        ValueError, match=r"wheel_radius must be a number or two numbers \(left, right\), got \(0.1, 0.2, 0.3"
    ):
        Drive.differential(track=0.4, wheel_radius=(0.1, 0.2, 0.3))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="drive must be a Drive, got int; make one with"):
        WheelMotion(3, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="time must be at least 0, got -1"):
        WheelMotion(CAR, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)).velocity(-1.0)
    assert eval(repr(CAR), {"Drive": Drive, "inf": math.inf}) == CAR != DIFFERENTIAL


NAN, INF = math.nan, math.inf
STILL, AHEAD, HERE = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), [(0.0, 0.0, 0.0)]
STANDS = [(0.0, 0.0, 0.0, 0.0)]
SMALL_CAR = Drive.ackermann(wheelbase=0.1, track=0.1, wheel_radius=1.0, steering_limit=0.6)
MOTION = WheelMotion(CAR, STILL, AHEAD)
FAST = WheelMotion(CAR, (1e300, 0.0, 0.0), (1e300, 0.0, 0.0))
NO_STEERING = "must be 0 for a drive that does not steer, got"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: DIFFERENTIAL.with_multipliers(left_radius=1e-323), "the left radius must be positive, got 0"),
        (lambda: DIFFERENTIAL.with_multipliers(track=NAN), "track must be positive, got NaN"),
        (
            lambda: CAR.wheels_of_twist([AHEAD, (0.0, NAN, 0.0)]),
            "twists must be finite, got [0.0, NaN, 0.0] in row 1",
        ),
        (lambda: CAR.wheels_of_twist([(1e308, 0.0, 0.0)]), "the resulting rates must be finite, got inf in row 0"),
        (lambda: CAR.wheels_of_twist([AHEAD], [NAN]), "steering must be in -1.5..1.5 rad, got NaN in row 0"),
        (lambda: CAR.wheels_of_twist([AHEAD] * 2, [0.1, 20.0]), "steering must be in -1.5..1.5 rad, got 20 in row 1"),
        (lambda: OMNI.wheels_of_twist([AHEAD], [0.1]), f"steering {NO_STEERING} 0.1 in row 0"),
        (lambda: DIFFERENTIAL.twist_of_wheels([(1.0, 1.0), (1.0, INF)]), "wheels must be finite, got inf in row 1"),
        (lambda: DIFFERENTIAL.twist_of_wheels([(1.0, 1.0)], [0.1]), f"steering {NO_STEERING} 0.1 in row 0"),
        (lambda: CAR.twist_of_wheels(np.ones((1, 4)), [1.57]), "steering must be in -1.5..1.5 rad, got 1.57 in row 0"),
        (
            lambda: SMALL_CAR.twist_of_wheels([(0.0, 0.0, -1.7e308, 1.7e308)]),
            "the resulting velocities must be finite, got [0.0, 0.0, inf] in row 0",
        ),
        (lambda: CAR.steering_of_twist([(INF, 0.0, 0.0)]), "twists must be finite, got [inf, 0.0, 0.0] in row 0"),
        (lambda: CAR.steering_angles([0.0, 3.0]), "steering must be in -1.5..1.5 rad, got 3 in row 1"),
        (lambda: OMNI.steering_angles([0.1]), f"steering {NO_STEERING} 0.1 in row 0"),
        (lambda: CAR.steering_angle_rates([NAN], [0.1]), "steering must be in -1.5..1.5 rad, got NaN in row 0"),
        (lambda: CAR.steering_angle_rates([0.1], [NAN]), "rates must be finite, got NaN in row 0"),
        (lambda: CAR.command((NAN, 0.0, 0.0)), "twist must be finite, got NaN"),
        (lambda: CAR.command(AHEAD, INF), "steering_angle must be finite, got inf"),
        (lambda: DIFFERENTIAL.command(AHEAD, 0.3), f"steering_angle {NO_STEERING} 0.3"),
        (lambda: CAR.step([(NAN, 0.0, 0.0)], STANDS, [AHEAD], dt=0.1), "poses must be finite, got NaN in row 0"),
        (lambda: CAR.step(HERE, [(0.0, NAN, 0.0, 0.0)], [AHEAD], dt=0.1), "states must be finite, got NaN in row 0"),
        (
            lambda: CAR.step(HERE, [(0.0, 0.0, 0.0, 2.0)], [AHEAD], dt=0.1),
            "the steering angle of states must be in -1.5..1.5 rad, got 2 in row 0",
        ),
        (
            lambda: OMNI.step(HERE, [(0.0, 0.0, 0.0, 0.3)], [AHEAD], dt=0.1),
            f"the steering angle of states {NO_STEERING} 0.3 in row 0",
        ),
        (lambda: CAR.step(HERE, STANDS, [(1.0, NAN)], dt=0.1), "commands must be finite, got NaN in row 0"),
        (
            lambda: CAR.step(HERE, STANDS, [(1.0, 0.0, INF)], dt=0.1),
            "commands must be finite, got [1.0, 0.0, inf] in row 0",
        ),
        (lambda: CAR.step(HERE, STANDS, [(1.0,)], dt=0.1), "commands must have shape (N, 3) or (N, 2), got (1, 1)"),
        (lambda: CAR.step(HERE, STANDS, [AHEAD], dt=-1.0), "dt must be at least 0, got -1"),
        (lambda: CAR.step(HERE, STANDS, [(1e300, 0.0, 0.0)], dt=1e10), "the resulting poses must be finite, got"),
        (lambda: SMALL_CAR.step(HERE, STANDS, [(1e308, 0.6)], dt=0.0), "the resulting states must be finite, got"),
        (lambda: DIFFERENTIAL.odometry((0.0, 0.0), (NAN, 0.0)), "after must be finite, got NaN"),
        (lambda: DIFFERENTIAL.odometry((INF, 0.0), (0.0, 0.0)), "before must be finite, got inf"),
        (lambda: DIFFERENTIAL.odometry((0.0, 0.0), (0.0, 0.0), ticks=INF), "ticks must be at least 0, got inf"),
        (lambda: DIFFERENTIAL.odometry((0.0, 0.0), (1.0, 1.0), steering_angle=0.1), f"steering_angle {NO_STEERING} 0.1"),
        (
            lambda: CAR.odometry(np.zeros(4), np.ones(4), steering_angle=20.0),
            "steering_angle must be in -1.5..1.5 rad, got 20; 20° is 0.3491 rad",
        ),
        (
            lambda: DIFFERENTIAL.odometry((0.0, 0.0), (1e308, 1e308), ticks=1e300),
            "the resulting motion must be finite, got inf",
        ),
        (lambda: WheelMotion(OMNI, STILL, AHEAD, steering_angle=0.3), f"steering_angle {NO_STEERING} 0.3"),
        (lambda: WheelMotion(OMNI, STILL, AHEAD, steering_goal=0.3), f"steering_goal {NO_STEERING} 0.3"),
        (
            lambda: WheelMotion(OMNI, STILL, AHEAD, steering_rate=0.3),
            "steering_rate must be inf for a drive that does not steer, got 0.3",
        ),
        (
            lambda: WheelMotion(CAR, STILL, AHEAD, steering_angle=30.0),
            "steering_angle must be in -1.5..1.5 rad, got 30; 30° is 0.5236 rad",
        ),
        (lambda: WheelMotion(CAR, STILL, AHEAD, steering_goal=NAN), "steering_goal must be finite, got NaN"),
        (lambda: MOTION.integrate(Pose(), NAN), "time must be at least 0, got NaN"),
        (lambda: MOTION.integrate(Pose(), 1.0, grip=2.0), "grip must be in 0..1, got 2"),
        (lambda: MOTION.trace(Pose(), [1.0], grip=NAN), "grip must be in 0..1, got NaN"),
        (lambda: MOTION.trace(Pose(), [0.0, -1.0]), "times must be at least 0, got -1"),
        (lambda: MOTION.distance(-1.0), "time must be at least 0, got -1"),
        (lambda: MOTION.rolled(INF), "time must be at least 0, got inf"),
        (lambda: FAST.distance(1e300), "the resulting distance must be finite, got inf"),
        (lambda: FAST.rolled(1e300), "the resulting angles must be finite, got inf"),
    ],
)
def test_what_would_be_silently_wrong_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError) as caught:
        call()
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Drive.differential(track=True, wheel_radius=0.1), "track must be a number, got True"),
        (lambda: Drive.differential(track=0.4, wheel_radius=True), "wheel_radius must be a number or two numbers"),
        (lambda: MOTION.integrate(Pose(), 1.0, grip=True), "grip must be a number, got True"),
        (lambda: CAR.step(HERE, STANDS, [AHEAD], 0.1, limits=3), "limits must be a Limits, got int"),  # type: ignore[arg-type]
        (lambda: WheelMotion(CAR, STILL, AHEAD, limits="no"), "limits must be a Limits, got str"),  # type: ignore[arg-type]
    ],
)
def test_what_is_of_another_type_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(TypeError) as caught:
        call()
    assert str(caught.value).startswith(message)


def test_a_steering_angle_of_0_is_good_for_every_drive() -> None:
    for drive in (DIFFERENTIAL, OMNI, CAR):
        assert drive.steering_angles([0.0]).tolist() == [[0.0, 0.0]]
        assert drive.wheels_of_twist([AHEAD], [0.0]).tolist() == drive.wheels_of_twist([AHEAD]).tolist()
        assert drive.command(AHEAD, 0.0)[0] == AHEAD
    # Commands beyond the limit are limited.
    assert WheelMotion(CAR, STILL, STILL, steering_goal=9.0).steering(9.0) == 0.6
