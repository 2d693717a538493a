"""push: a push displaces a robot by velocity times duration; its wheels do not notice it, and walls hold it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import Limits, Pose, Shape
from mobile_robot_simulator.physics.motion import Motion
from mobile_robot_simulator.physics.push import displaced, turned, with_push
from simulations import drive, simulation

SECOND = 1_000_000_000
PUSH = (0.3, -0.2)
LIMITS = Limits(velocity=(1.0, 0.5, 2.0), acceleration=(0.5, 0.5, 1.5), deceleration=(1.0, 1.0, 3.0))


def test_a_push_displaces_turns_with_its_frame_and_adds_to_the_velocity() -> None:
    assert displaced(Pose(1.0, 2.0, 3.0), PUSH, 2.0) == Pose(1.6, 1.6, 3.0)
    assert turned((1.0, 0.0), math.pi / 2) == pytest.approx((0.0, 1.0))
    assert with_push((0.5, 0.0, 0.1), (0.0, 0.2), math.pi / 2) == pytest.approx((0.7, 0.0, 0.1))


def integrated(motion: Motion, start: Pose, grip: float, push: tuple[float, float], last_ns: int) -> np.ndarray:
    """Pose in the map frame from Euler's method, in steps of 1 ms with the velocity of the wheels in their middle."""
    x, y, yaw = start
    dt = 1e-3
    for time_ns in range(0, last_ns, 1_000_000):
        vx, vy, wz = motion.wheel_velocity(time_ns + 500_000)
        middle = yaw + 0.5 * dt * wz * grip
        x += dt * (grip * (vx * math.cos(middle) - vy * math.sin(middle)) + push[0])
        y += dt * (grip * (vx * math.sin(middle) + vy * math.cos(middle)) + push[1])
        yaw += dt * wz * grip
    return np.array([x, y, yaw])


@pytest.mark.parametrize("limits", [None, LIMITS], ids=["without limits", "with limits"])
@pytest.mark.parametrize("grip", [1.0, 0.6])
def test_the_path_is_that_of_small_steps(limits: Limits | None, grip: float) -> None:
    motion = Motion(0, 0.0, Pose(10.0, 1.0, -2.0), Pose(1.0, 2.0, 0.5), limits)
    motion.slip(1.0 - grip, 0)
    motion.push(PUSH, 0)
    motion.command((0.8, 0.1, 0.9), 0)
    expected = integrated(motion, motion.map_pose(0), grip, PUSH, SECOND)
    assert np.array(tuple(motion.map_pose(SECOND))) == pytest.approx(expected, abs=1e-6)
    times = np.arange(0, SECOND + 1, SECOND // 4)
    assert motion.map_poses_at(times)[-1] == pytest.approx(expected, abs=1e-6)
    rows = [tuple(motion.map_pose_at(int(time))) for time in times]
    assert motion.map_poses_at(times) == pytest.approx(np.array(rows), abs=1e-12)
    # The velocity is the derivative of the pose.
    before, after = motion.map_pose(SECOND - 100_000), motion.map_pose(SECOND + 100_000)
    middle = Pose(before.x, before.y, motion.map_pose(SECOND).yaw)
    moved = middle.inverse() * after
    assert motion.velocity(SECOND)[:2] == pytest.approx((moved.x / 2e-4, moved.y / 2e-4), abs=1e-4)
    assert motion.velocities_at(np.array([SECOND])) == pytest.approx(np.array([motion.velocity(SECOND)]), abs=1e-12)


def test_wheels_and_driven_distance_do_not_notice_a_push() -> None:
    pushed, free = (Motion(0, 0.0, Pose(10.0), Pose(1.0, 2.0), LIMITS) for _ in range(2))
    for motion in (pushed, free):
        motion.command((1.0, 0.0, 0.5), 0)
    pushed.push(PUSH, SECOND)
    pushed.push(None, 2 * SECOND)
    assert tuple(pushed.wheel_pose(3 * SECOND)) == pytest.approx(tuple(free.pose(3 * SECOND)))
    assert pushed.distance(3 * SECOND) == pytest.approx(free.distance(3 * SECOND))
    x, y, yaw = free.pose(3 * SECOND)
    assert tuple(pushed.pose(3 * SECOND)) == pytest.approx((x + 0.3, y - 0.2, yaw))


def test_a_push_keeps_its_direction_in_the_map_when_the_frame_turns() -> None:
    motion = Motion(0, 0.0, Pose(), Pose(1.0, 2.0, 0.0))
    motion.push((1.0, 0.0), 0)
    motion.move_frame(Pose(0.0, 0.0, math.pi / 2), SECOND)
    assert tuple(motion.map_pose(SECOND)) == pytest.approx((-2.0, 2.0, math.pi / 2))
    assert tuple(motion.map_pose(2 * SECOND)) == pytest.approx((-1.0, 2.0, math.pi / 2))


def test_a_restored_motion_goes_on_with_its_push() -> None:
    motion = Motion(0, 0.0, Pose(3.0, 0.0, 1.0), Pose())
    motion.push(PUSH, 0)
    state = motion.save()
    pose = motion.map_pose(SECOND)
    motion.push(None, SECOND // 2)
    motion.restore(state)
    assert motion.map_pose(SECOND) == pose


def pushed(contact: str = "stop", **parameters: object) -> mrs.Simulation:
    return simulation((10.0, 10.0, 0.0), contact=contact, robot_radius=0.3, **parameters)


@pytest.mark.parametrize("limits", [{}, {"acceleration_limits": (0.5, 0.5, 1.0)}], ids=["without limits", "with limits"])
def test_a_footprint_without_contact_changes_nothing(limits: dict[str, object]) -> None:
    poses = []
    for parameters in ({}, {"robot_radius": 0.3}):
        sim = simulation((10.0, 10.0, 0.0), **limits, **parameters)
        drive(sim, 0.5, 0.3)
        sim.run_for(0.51)
        sim.robot.push(PUSH)
        sim.run_for(2.013)
        sim.robot.push(None)
        sim.run_for(1.0)
        poses.append(sim.truth.path)
    assert np.array_equal(*poses)


def test_a_push_that_begins_after_a_look_for_contact_is_stopped_by_a_wall() -> None:
    """Without a push, a robot that stands still is not looked at for a second."""
    sim = pushed()
    sim.run_for(0.5)
    sim.robot.push((20.0, 0.0))
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(19.6, abs=1e-6) and sim.pose.x <= 19.6
    (contact,) = sim.truth.contacts
    assert contact.what == "a wall" and contact.time == pytest.approx(0.98) and contact.speed == pytest.approx(20.0)
    assert tuple(sim.robot.believed_pose) == (0.0, 0.0, 0.0) and sim.truth.velocity == (0.0, 0.0, 0.0)
    sim.robot.push((-1.0, 0.0))
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(18.6)


@pytest.mark.parametrize("contact", ["stop", "slide"])
def test_a_robot_that_stands_is_pushed_against_a_wall_and_its_wheels_do_not_turn(contact: str) -> None:
    sim = pushed(contact)
    sim.add_obstacle(Shape.rectangle(0.2, 20.0), (11.0, 10.0, 0.0))
    sim.robot.push((0.5, 0.25))
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(10.6, abs=1e-6)
    assert sim.pose.y == pytest.approx(11.0 if contact == "slide" else 10.3, abs=1e-6)
    assert tuple(sim.robot.believed_pose) == (0.0, 0.0, 0.0)
    assert sim.truth.velocity == pytest.approx((0.0, 0.25 if contact == "slide" else 0.0, 0.0), abs=1e-6)


def test_a_robot_that_drives_along_a_wall_is_pushed_against_it_and_its_wheels_count_the_way() -> None:
    sim = pushed("slide")
    sim.add_obstacle(Shape.rectangle(20.0, 0.2), (10.0, 11.0, 0.0))
    drive(sim, 0.5)
    sim.robot.push((0.1, 0.5))
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(10.0 + 0.6 * 4.0, abs=1e-3) and sim.pose.y == pytest.approx(10.6, abs=1e-6)
    assert sim.robot.believed_pose.x == pytest.approx(0.5 * 4.0, abs=0.06) and sim.robot.believed_pose.y == 0.0
    sim.robot.push(None)
    sim.run_for(1.0)
    assert sim.truth.velocity == pytest.approx((0.5, 0.0, 0.0))


def test_reading_between_steps_does_not_change_a_pushed_robot() -> None:
    ends = []
    for period in (2.0, 0.0137):
        sim = pushed("slide", acceleration_limits=(0.5, 0.5, 1.0))
        sim.add_obstacle(Shape.rectangle(0.2, 20.0), (11.0, 10.0, 0.2))
        drive(sim, 0.5, 0.2)
        sim.robot.push((0.5, 0.25))
        while sim.time < 2.0 - 1e-9:
            sim.run_for(min(period, 2.0 - sim.time))
            assert math.isfinite(sim.pose.x) and sim.truth.clearance >= 0.0
        ends.append((sim.pose, sim.truth.velocity, sim.robot.believed_pose))
    assert ends[0] == ends[1]


def test_a_reset_keeps_the_push_and_bad_ones_are_refused() -> None:
    sim = pushed()
    sim.robot.push((0.5, 0.0))
    sim.run_for(1.0)
    sim.robot.reset()
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(10.5)
    for bad in ((math.nan, 0.0), (0.0, math.inf), (1.0, 2.0, 3.0)):
        with pytest.raises(ValueError, match="a push must be two finite speeds of at most"):
            sim.robot.push(bad)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(11.0)


def test_a_restored_simulation_is_pushed_as_before() -> None:
    sim = pushed()
    drive(sim, 0.5, 0.3)
    sim.robot.push(PUSH)
    sim.run_for(1.0)
    state = sim.save()
    ends = []
    for _ in range(2):
        sim.restore(state)
        sim.robot.reset()
        sim.run_for(1.03)
        ends.append(sim.pose)
        sim.robot.push(None)
        sim.run_for(1.0)
    assert ends[0] == ends[1] and ends[0].x == pytest.approx(10.0 + 0.3 * 1.03)
