"""world: several robots see and touch each other, and everything repeats after a restore."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from hall import SEED, drive, hall


def pair(**parameters) -> mrs.Simulation:
    quiet = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 60, "laser_fov": 2 * math.pi}
    robots = {"robot1": (5.0, 10.0, 0.0), "robot2": (9.0, 10.0, math.pi)}
    return mrs.Simulation(hall(), parameters={**quiet, **parameters}, seed=SEED, robots=robots)


def test_each_robot_has_its_own_topics_frames_and_services():
    sim = pair()
    sim.run_for(0.2)
    scan, odometry = sim.latest("/robot2/scan"), sim.latest("/robot2/odom")
    assert scan.header.frame_id == "robot2/base_link"
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("robot2/odom", "robot2/base_link")
    links = {(transform.header.frame_id, transform.child_frame_id) for transform in sim.latest("/tf").transforms}
    assert links == {("map", "robot2/odom"), ("robot2/odom", "robot2/base_link")}
    with pytest.raises(ValueError, match="unknown topic '/scan'"):
        sim.latest("/scan")
    clocks = []
    sim.subscribe("/clock", mrs.messages.Clock, clocks.append)
    sim.run_for(1.0)
    assert len(clocks) == 10
    sim.publish(
        "/robot2/initialpose",
        mrs.messages.PoseWithCovarianceStamped(
            pose=mrs.messages.PoseWithCovariance(mrs.messages.Pose.from_planar(mrs.Pose(3, 3, 1)))
        ),
    )
    sim.run_for(0.1)
    assert tuple(sim.robots["robot2"].pose) == pytest.approx((3, 3, 1))
    assert sim.named("robot1").pose.x == 5.0


def test_robots_see_and_touch_each_other():
    sim = pair(robot_radius=0.25)
    sim.run_for(0.1)
    assert sim.latest("/robot1/scan").ranges[30] == pytest.approx(3.75, abs=1e-6)
    assert sim.latest("/robot2/scan").ranges[30] == pytest.approx(3.75, abs=1e-6)
    for name in sim.robots:
        drive(sim, 1.0, topic=f"/{name}/cmd_vel")
    sim.run_for(5.0)
    gap = sim.robots["robot2"].pose.x - sim.robots["robot1"].pose.x
    assert 0.5 <= gap < 0.5 + 0.02
    assert sim.robots["robot1"].truth.contacts[0].what == "robot robot2"
    assert sim.robots["robot1"].truth.clearance == pytest.approx(gap - 0.5, abs=1e-6)


def test_the_noise_of_a_robot_does_not_depend_on_the_others():
    both = pair(apply_noise=True)
    alone = mrs.Simulation(
        hall(),
        parameters={"laser_beam_count": 60, "laser_fov": 2 * math.pi, "robot_radius": 0},
        seed=SEED,
        robots={"robot2": (9.0, 10.0, math.pi)},
    )
    for sim in (both, alone):
        sim.run_for(0.3)
    seen, free = both.latest("/robot2/scan").ranges, alone.latest("/robot2/scan").ranges
    assert np.sum(seen != free) < 6
    assert not np.array_equal(both.latest("/robot1/scan").ranges, seen)


def test_names_of_robots_are_checked():
    sim = pair()
    for name in ("robot1", "", "1st", "a b"):
        with pytest.raises(ValueError, match="name"):
            sim.add_robot(name, start=(2, 2, 0))
    with pytest.raises(ValueError, match="room beside walls"):
        sim.add_robot("robot3", start=(0.2, 2.0, 0.0))
    assert sim.add_robot("robot3", start=(3, 3, 0), parameters={"robot_radius": 0.4}).robot.parameters.robot_radius == 0.4


def test_everything_repeats_after_a_restore():
    sim = pair(robot_radius=0.25, contact="slide", odometry_alphas=(0.1, 0.01, 0.01, 0.1, 0.01, 0.01))
    sim.add_obstacle(mrs.Shape.disc(0.3), [(0, 7, 13, 0), (5, 7, 8, 0)])
    for name in sim.robots:
        drive(sim, 0.8, 0.1, topic=f"/{name}/cmd_vel")
    sim.run_for(1.237)
    state, ends = sim.save(), []
    for _ in range(2):
        sim.run_for(6.0)
        messages = [sim.latest(f"/{name}/{topic}") for name in sim.robots for topic in ("odom", "scan")]
        contacts = [robot.truth.contacts for robot in sim.robots.values()]
        ends.append((messages, contacts, [tuple(robot.pose) for robot in sim.robots.values()]))
        sim.add_obstacle(mrs.Shape.disc(0.1), (15, 15, 0))
        sim.restore(state)
    assert ends[0] == ends[1] and ends[0][1][0]


def test_each_robot_has_its_own_seed_and_reset_moves_all_of_them():
    sim = pair(apply_noise=True)
    seeds = {robot.laser.parameters.seed for robot in sim.robots.values()}
    seeds |= {robot.robot.parameters.odometry_seed for robot in sim.robots.values()}
    assert len(seeds) >= 2 and SEED not in seeds
    assert len({robot.laser.parameters.seed for robot in sim.robots.values()}) == 2
    for name in sim.robots:
        drive(sim, 0.5, topic=f"/{name}/cmd_vel")
    sim.run_for(1.0)
    sim.reset()
    assert [tuple(robot.pose) for robot in sim.robots.values()] == [(5.0, 10.0, 0.0), (9.0, 10.0, math.pi)]


def test_clearance_is_measured_up_to_ten_metres():
    sim = mrs.Simulation(hall(30.0), start=(9.6, 15.0, 0.0))
    assert sim.truth.clearance == pytest.approx(9.5, abs=1e-5)
    sim.set_pose((15.0, 15.0, 0.0))
    assert sim.truth.clearance == 10.0
