"""velocity_profile: ramps under limits are exact at any time, and do not depend on when they are read."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mobile_robot_simulator import Limits, Pose
from mobile_robot_simulator.physics.velocity_profile import FOREVER, STANDING, VelocityProfile
from simulations import drive, simulation

SECOND = 1_000_000_000
LIMITS = Limits(velocity=(1.0, 0.5, 2.0), acceleration=(0.5, 0.5, 1.5), deceleration=(1.0, 1.0, 3.0))


def test_a_command_is_approached_and_after_its_end_the_robot_slows_down() -> None:
    profile = VelocityProfile(SECOND, STANDING, (2.0, 0.0, 0.0), 3 * SECOND, LIMITS)
    assert profile.velocity_at(2 * SECOND) == (0.5, 0.0, 0.0) and profile.velocity_at(3 * SECOND) == (1.0, 0.0, 0.0)
    assert profile.velocity_at(3.5 * SECOND) == (0.5, 0.0, 0.0) and profile.velocity_at(4 * SECOND) == STANDING
    # One metre to speed up, half a metre to slow down.
    assert profile.move(Pose(), 3 * SECOND).x == 1.0 and profile.move(Pose(), 9 * SECOND).x == 1.5
    assert profile.distance(9 * SECOND) == 1.5
    assert profile.move(Pose(), 9 * SECOND, grip=0.5).x == 0.75


def test_without_limits_the_command_acts_at_once() -> None:
    profile = VelocityProfile(SECOND, (9.0, 0.0, 0.0), (1.0, 0.0, 0.0), 2 * SECOND)
    assert profile.velocity_at(SECOND) == (1.0, 0.0, 0.0) and profile.velocity_at(2 * SECOND) == STANDING
    assert profile.move(Pose(), SECOND // 2) == Pose() and profile.move(Pose(), 9 * SECOND) == Pose(1.0)
    assert profile.distance(9 * SECOND) == 1.0


def test_poses_and_distances_agree_with_a_sum_of_small_steps() -> None:
    profile = VelocityProfile(0, (-0.7, 0.2, -1.3), (0.9, -0.4, 1.1), 2 * SECOND, LIMITS)
    step, pose, driven = 1e-4, np.zeros(3), 0.0
    for nth in range(30_000):
        vx, vy, wz = profile.velocity_at((nth + 0.5) * step * SECOND)
        yaw = pose[2] + 0.5 * wz * step
        cos, sin = math.cos(yaw), math.sin(yaw)
        pose += step * np.array([cos * vx - sin * vy, sin * vx + cos * vy, wz])
        driven += step * math.hypot(vx, vy)
    assert tuple(profile.move(Pose(), 3 * SECOND)) == pytest.approx(tuple(pose), abs=1e-8)
    assert profile.distance(3 * SECOND) == pytest.approx(driven, abs=1e-8)


@pytest.mark.parametrize("radius", [0.0, 0.3])
@pytest.mark.parametrize("rate", [1.0, 10.0, 333.0])
def test_a_simulated_robot_has_the_positions_of_school_physics(rate: float, radius: float) -> None:
    limits = {"velocity_limits": (1.0, 1.0, 1.0), "acceleration_limits": (0.5, 1.0, 1.0)}
    sim = simulation(publish_rate=rate, robot_radius=radius, deceleration_limits=(1.0, 1.0, 1.0), **limits)
    drive(sim, 2.0)
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(2.0 + 3.0, abs=1e-9) and sim.truth.velocity == (1.0, 0.0, 0.0)
    drive(sim, 0.0)
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(2.0 + 3.5, abs=1e-9) and sim.truth.velocity == STANDING
    assert sim.truth.distance == pytest.approx(3.5, abs=1e-9)
    assert sim.latest("/odom").pose.pose.position.x == pytest.approx(3.5, abs=1e-9)


def test_when_a_ramp_is_read_changes_no_bit_also_with_a_footprint() -> None:
    ends = []
    for pause in (0.5, 0.0171, 2.0):
        for radius in (0.0, 0.3):
            limits = {"velocity_limits": (1.0, 1.0, 1.0), "acceleration_limits": (0.4, 1.0, 0.7)}
            sim = simulation((10.0, 10.0, 0.0), robot_radius=radius, velocity_timeout=1.3, **limits)
            for index in range(3):
                drive(sim, 0.7 - 0.3 * index, 0.4 * (-1) ** index)
                until = 2.0 * (index + 1)
                while sim.time < until:
                    sim.run_for(min(pause, until - sim.time))
                    sim.pose, sim.truth.distance, sim.truth.velocity  # noqa: B018
            ends.append((tuple(sim.pose), sim.truth.velocity, sim.truth.distance))
    assert ends == ends[:1] * len(ends)


def test_a_ramp_that_contact_interrupts_ends_at_the_wall() -> None:
    sim = simulation(robot_radius=0.3, acceleration_limits=(0.5, 1.0, 1.0))
    drive(sim, -1.0)
    sim.run_for(5.0)
    (contact,) = sim.truth.contacts
    assert sim.pose.x == pytest.approx(0.4, abs=2e-6) and sim.truth.velocity == STANDING
    # 1.6 m: 1 m in 2 s at 0.5 m/s^2, then 0.6 m at 1 m/s.
    assert contact.time == pytest.approx(2.6, abs=1e-5)
    drive(sim, 1.0)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(0.4 + 0.25, abs=2e-5)


def test_changed_limits_apply_to_a_robot_that_drives() -> None:
    sim = simulation(acceleration_limits=(0.5, 1.0, 1.0))
    drive(sim, 1.0)
    sim.run_for(1.0)
    sim.robot.set_parameters(acceleration_limits=(0.25, 1.0, 1.0))
    sim.run_for(1.0)
    assert sim.truth.velocity == pytest.approx((0.75, 0.0, 0.0)) and sim.pose.x == pytest.approx(2.0 + 0.25 + 0.625)


def test_a_profile_without_end_goes_on() -> None:
    assert VelocityProfile(0, STANDING, (1.0, 0.0, 0.0), FOREVER, LIMITS).velocity_at(10**6 * SECOND) == (1.0, 0.0, 0.0)
