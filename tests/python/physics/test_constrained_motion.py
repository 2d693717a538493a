"""constrained_motion: walls, obstacles and limits act on a robot. Without them, it moves exactly as with `Motion`."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from simulations import SEED, drive, simulation


def test_a_robot_stops_at_a_wall_and_reports_the_contact():
    sim = simulation(robot_radius=0.3)
    drive(sim, -1.0)
    sim.run_for(5.0)
    assert sim.pose.x == pytest.approx(0.4, abs=2e-6) and sim.pose.x >= 0.4
    assert sim.truth.velocity == (0.0, 0.0, 0.0)
    (contact,) = sim.truth.contacts
    assert contact.time == pytest.approx(1.6, abs=2e-6) and contact.what == "a wall" and contact.speed == 1.0
    assert contact.point == pytest.approx((0.1, 2.0), abs=2e-6)
    assert tuple(contact.pose) == pytest.approx((0.4, 2.0, 0.0), abs=2e-6)
    assert sim.truth.distance == pytest.approx(1.6, abs=1e-5)
    assert sim.truth.clearance == pytest.approx(0.0, abs=2e-6)
    drive(sim, 1.0)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(1.4, abs=1e-4)


def test_modes_slide_and_report_at_a_wall():
    for contact, end in (("slide", (0.4, 3.0)), ("report", (-1.0, 3.0))):
        sim = simulation(robot_radius=0.3, contact=contact)
        drive(sim, -1.0, vy=1 / 3)
        sim.run_for(3.0)
        assert (sim.pose.x, sim.pose.y) == pytest.approx(end, abs=1e-5)
        assert [contact.what for contact in sim.truth.contacts] == ["a wall"]


def test_the_contact_time_agrees_with_a_check_of_poses_around_it():
    """The footprint is free 10 microseconds before the contact and touches something 10 microseconds after it."""
    shape = [[0.5, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.5, -0.2]]
    rng = np.random.default_rng(SEED)
    outline = mrs.Shape.polygon(shape)
    for _ in range(5):
        start = (*rng.uniform(1.5, 18.5, 2), rng.uniform(-3, 3))
        twist = (rng.uniform(0.5, 2.0), 0.0, rng.uniform(-0.05, 0.05))
        sim = simulation(start=start, footprint=str(shape))
        drive(sim, twist[0], twist[2])
        sim.run_until(lambda sim: sim.truth.contacts, 60.0)
        found = sim.truth.contacts[0].time
        before, after = (mrs.Pose(*start).integrate(twist, found + offset) for offset in (-1e-5, 1e-5))
        assert not mrs.touches(sim.grid, outline, before) and mrs.touches(sim.grid, outline, after)


def test_without_contact_a_footprint_changes_no_bit():
    plain, round_ = simulation(), simulation(robot_radius=0.3)
    for sim in (plain, round_):
        for index in range(20):
            drive(sim, 0.3 + 0.1 * (index % 3), 0.4 * (-1) ** (index // 2))
            sim.run_for(0.333)
    assert tuple(plain.pose) == tuple(round_.pose) and plain.latest("/scan") == round_.latest("/scan")
    assert plain.latest("/odom") == round_.latest("/odom") and plain.truth.distance == round_.truth.distance


def test_mode_report_changes_no_bit():
    ends = []
    for parameters in ({"robot_radius": 0.3, "contact": "report"}, {}):
        sim = simulation((0.7, 3.0, -2.0), **parameters)
        drive(sim, 0.6, wz=0.1)
        sim.run_for(2.01)
        ends.append((tuple(sim.truth.pose), sim.truth.velocity, sim.truth.distance))
    assert ends[0] == ends[1]


def test_a_timeout_ends_a_command_at_the_same_time_with_and_without_a_footprint():
    plain, round_ = simulation(velocity_timeout=0.333), simulation(velocity_timeout=0.333, robot_radius=0.3)
    for sim in (plain, round_):
        drive(sim, 1.0, 0.3)
        sim.run_for(1.0)
    assert tuple(plain.pose) == tuple(round_.pose)


def test_reading_between_steps_changes_nothing():
    def run(read: bool) -> mrs.Simulation:
        sim = simulation(robot_radius=0.3, contact="slide")
        sim.add_obstacle(mrs.Shape.disc(0.5), [(0, 8, 2.2, 0), (4, 3, 2.2, 0)])
        drive(sim, 1.0, 0.05)
        for _ in range(300):
            sim.run_for(0.0171)
            if read:
                sim.pose, sim.truth.velocity, sim.truth.clearance, sim.truth.distance  # noqa: B018
        return sim

    read, unread = run(True), run(False)
    assert tuple(read.pose) == tuple(unread.pose) and read.truth.contacts == unread.truth.contacts != []


def test_ground_truth_is_consistent_between_two_steps():
    """The robot starts 0.509 m from a disc, so that the contact falls between two steps."""
    sim = simulation((10.0, 10.0, 0.0), robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.disc(0.3), (11.109, 10.0, 0.0))
    drive(sim, 1.0)
    for moment in (0.009, 0.507, 0.515):
        sim.run_for(moment - sim.time)
        expected = (10.0 + min(moment, 0.509), 10.0, 0.0)
        assert tuple(sim.truth.pose) == pytest.approx(expected, abs=2e-6)
        assert sim.truth.path[-1] == pytest.approx([moment, *sim.truth.pose], abs=1e-12)
        assert tuple(sim.truth.pose_at(moment)) == pytest.approx(tuple(sim.truth.pose), abs=1e-12)
        assert sim.truth.pose_at(moment - 0.004).x == pytest.approx(10.0 + min(moment - 0.004, 0.509), abs=2e-6)
    (contact,) = sim.truth.contacts
    sim.run_for(0.1)
    assert sim.truth.contacts == [contact] and contact.time == pytest.approx(0.509, abs=1e-5)


def test_limits_bound_velocity_and_acceleration():
    sim = simulation(velocity_limits=(0.5, 0.0, 1.0), acceleration_limits=(1.0, 1.0, 1.0))
    drive(sim, 2.0)
    sim.run_for(0.2)
    assert sim.truth.velocity[0] == pytest.approx(0.2)
    sim.run_for(0.8)
    assert sim.truth.velocity == (0.5, 0.0, 0.0)
    drive(sim, 0.0)
    sim.run_for(0.3)
    assert sim.truth.velocity[0] == pytest.approx(0.2)
    assert sim.latest("/odom").twist.twist.linear.x == pytest.approx(sim.truth.velocity[0])


@pytest.mark.parametrize("limits", [{}, {"acceleration_limits": (2.0, 2.0, 2.0)}])
@pytest.mark.parametrize("map_transform", [True, False])
def test_the_velocity_of_a_sliding_robot_matches_its_motion(limits, map_transform):
    """The robot drives into the lower wall at 0.4 rad. Its speed along the wall is the commanded speed times cos 0.4."""
    start = (4.0, 0.6, -0.4)
    sim = simulation(start, robot_radius=0.3, contact="slide", publish_map_transform=map_transform, **limits)
    drive(sim, 0.5)
    sim.run_for(3.0)
    speeds = []
    for _ in range(7):
        before = sim.truth.pose
        sim.run_for(0.033)
        after, (vx, vy, wz) = sim.truth.pose, sim.truth.velocity
        speeds.append((after.x - before.x) / 0.033)
        assert math.hypot(vx, vy) == pytest.approx(speeds[-1], rel=0.02 if limits else 1e-6)
        assert wz == pytest.approx(0.0, abs=1e-9)
        assert sim.truth.path[-1, 1:] == pytest.approx(tuple(after), abs=1e-9)
    if not limits:
        assert speeds == pytest.approx([0.5 * math.cos(0.4)] * 7)
    steps = np.diff(sim.truth.path[:, 1:3], axis=0)
    assert sim.truth.distance == pytest.approx(np.hypot(*steps.T).sum())


def test_wheels_of_a_sliding_and_slipping_robot_turn_faster_than_it_moves():
    sim = simulation((4.0, 0.6, -0.4), robot_radius=0.3, contact="slide")
    sim.add_fault(faults.Slip(0.5))
    drive(sim, 0.5)
    sim.run_for(3.0)
    vx, vy, _ = sim.truth.velocity
    assert math.hypot(vx, vy) == pytest.approx(0.25 * math.cos(0.4))
    assert sim.robot.motion.wheel_velocity(3_000_000_000)[:2] == pytest.approx((2 * vx, 2 * vy))


def test_leaving_and_touching_a_wall_again_gives_two_contacts():
    sim = simulation((1.0, 10.0, math.pi), robot_radius=0.3)
    for speed in (1.0, -0.5, 1.0):
        drive(sim, speed)
        sim.run_for(1.0)
    first, second = sim.truth.contacts
    assert first.what == second.what == "a wall" and second.time > first.time + 1.0


def test_a_robot_can_drive_out_of_an_obstacle_that_moved_onto_it():
    sim = simulation(start=(10.0, 10.0, 0.0), robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.rectangle(1.0, 1.0), [(0.0, 8.0, 10.0, 0.0), (2.0, 9.3, 10.0, 0.0)], name="cart")
    sim.run_for(3.0)
    assert [contact.what for contact in sim.truth.contacts] == ["obstacle cart"] and sim.truth.clearance == 0.0
    drive(sim, 0.5)
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(11.0, abs=0.02) and sim.truth.velocity[0] == pytest.approx(0.5)


def test_the_footprint_can_change_while_the_robot_moves():
    sim = simulation(start=(10.0, 10.0, 0.0))
    drive(sim, 1.0)
    sim.run_for(1.0)
    sim.robot.set_parameters(robot_radius=0.5)
    sim.add_obstacle(mrs.Shape.disc(0.5), (14.0, 10.0, 0.0))
    drive(sim, 1.0)
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(13.0, abs=1e-5) and len(sim.truth.contacts) == 1
    assert sim.truth.distance == pytest.approx(3.0, abs=1e-5) and sim.truth.path[0, 1] == 10.0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"robot_radius": -1}, "robot_radius must be"),
        ({"footprint": "[[0, 0], [1, 1]]"}, "footprint must be"),
        ({"footprint": [[0, 0], [1, 0], [0, 1]], "robot_radius": 1.0}, "one of robot_radius and footprint"),
        ({"contact": "bounce"}, "contact must be"),
        ({"velocity_limits": (1.0, -1.0, 0.0)}, "velocity_limits"),
        ({"odometry_alphas": (0.1,) * 5}, "odometry_alphas"),
    ],
)
def test_invalid_parameters_are_rejected(values, message):
    with pytest.raises(ValueError, match=message):
        simulation(**values)
