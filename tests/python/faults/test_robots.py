"""Faults of robots and nodes: slip, drift, clock jumps and outages."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from simulations import arrivals, drive, open_field


@pytest.fixture
def sim() -> mrs.Simulation:
    return open_field()


def test_a_slipping_robot_moves_less_than_its_odometry_says(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.Slip(0.4, start=1.0, end=2.0))
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(5.0 + 1.3) and sim.robot.believed_pose.x == pytest.approx(1.5)
    odometry, (to_odom, to_base) = sim.latest("/odom"), sim.latest("/tf").transforms
    assert odometry.pose.pose.position.x == pytest.approx(1.5) and odometry.twist.twist.linear.x == 0.5
    assert to_odom.transform.translation.x + to_base.transform.translation.x == pytest.approx(6.3)


def test_robots_with_a_footprint_slip_too():
    sim = open_field(robot_radius=0.2)
    drive(sim, 0.5)
    sim.add_fault(faults.Slip(0.4, start=1.0, end=2.0))
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(5.0 + 1.3) and sim.robot.believed_pose.x == pytest.approx(1.5)


def test_overlapping_slips_multiply_and_end_separately(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.Slip(0.5, start=0.5, end=3.1))
    sim.add_fault(faults.Slip(0.2, start=1.1, end=2.1))
    speeds = []
    for seconds in (0.2, 0.4, 1.0, 1.0, 1.0):
        sim.run_for(seconds)
        speeds.append(sim.truth.velocity[0])
    assert speeds == pytest.approx([0.5, 0.25, 0.2, 0.25, 0.5])


def test_overlapping_pushes_add_and_end_separately(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.Push(0.3, math.pi / 2, start=1.0, end=3.0))
    push = sim.add_fault(faults.Push(0.1, start=2.0))
    velocities = []
    for seconds in (0.5, 1.0, 1.0, 1.0):
        sim.run_for(seconds)
        velocities.append(sim.truth.velocity[:2])
    assert np.array(velocities) == pytest.approx(np.array([(0.5, 0.0), (0.5, 0.3), (0.6, 0.3), (0.6, 0.0)]))
    assert sim.latest("/faults").data == "the robot is pushed by (0.1, 0) m/s"
    push.stop()
    sim.run_for(1.0)
    assert sim.truth.velocity == (0.5, 0.0, 0.0)
    assert sim.pose.x == pytest.approx(5.0 + 0.5 * 4.5 + 0.1 * 1.5) and sim.pose.y == pytest.approx(5.0 + 0.3 * 2.0)
    odometry, (to_odom, to_base) = sim.latest("/odom"), sim.latest("/tf").transforms
    assert odometry.pose.pose.position.x == pytest.approx(0.5 * 4.5) and odometry.twist.twist.linear.x == 0.5
    assert to_odom.transform.translation.y + to_base.transform.translation.y == pytest.approx(5.6)


def test_drift_agrees_with_its_covariance():
    """The normalised squared errors of 400 drives follow a chi-squared distribution with 3 degrees of freedom.

    Their mean must be in its 99 % interval, and about a tenth of them must exceed the 90 % quantile 6.251.
    """
    alphas, count = (0.02, 0.01, 0.01, 0.02, 0.005, 0.005), 400
    errors = []
    sim = open_field(laser_frequency=0.01)
    sim.run_for(0.05)
    state = sim.save()
    for seed in range(count):
        sim.restore(state)
        sim.add_fault(faults.OdometryDrift(alphas, seed=seed))
        drive(sim, 0.6, 0.3)
        sim.run_for(3.05)
        drive(sim, 0.5, -0.4)
        sim.run_for(2.0)
        odometry = sim.latest("/odom")
        believed = odometry.pose.pose.to_planar()
        true = sim.robot.motion.pose(round(sim.time * 1e9))
        error = np.array([believed.x - true.x, believed.y - true.y, math.remainder(believed.yaw - true.yaw, math.tau)])
        covariance = odometry.pose.covariance.reshape(6, 6)[np.ix_([0, 1, 5], [0, 1, 5])]
        errors.append(error @ np.linalg.solve(covariance, error))
    spread = 2.576 * math.sqrt(2 * 3 / count)
    assert 3 - spread < np.mean(errors) < 3 + spread
    assert 0.05 < np.mean(np.array(errors) > 6.251) < 0.15


def test_without_drift_odometry_is_exact_and_its_covariance_small(sim):
    drive(sim, 0.6, 0.3)
    sim.run_for(1.0)
    odometry = sim.latest("/odom")
    assert odometry.pose.covariance.reshape(6, 6)[0, 0] == 1e-9
    assert tuple(odometry.pose.pose.to_planar()) == pytest.approx(tuple(mrs.Pose().integrate((0.6, 0, 0.3), 1.0)), abs=1e-12)


def test_a_parameter_makes_odometry_drift_too():
    sim = open_field(odometry_alphas=(0.1, 0.1, 0.1, 0.1, 0.1, 0.1))
    drive(sim)
    sim.run_for(2.0)
    believed = sim.latest("/odom").pose
    assert abs(believed.pose.position.x - 1.0) > 1e-3 and believed.covariance[0] > 1e-4
    map_from_odom, odom_from_base = (link.transform.to_planar() for link in sim.latest("/tf").transforms)
    assert tuple(map_from_odom * odom_from_base) == pytest.approx(tuple(sim.pose), abs=1e-9)


def test_only_one_drift_can_act_on_a_robot_at_a_time(sim):
    alphas = (0.1,) * 6
    sim.add_fault(faults.OdometryDrift(alphas, start=1.0, end=2.0))
    sim.add_fault(faults.OdometryDrift(alphas, start=2.0, end=3.0))
    with pytest.raises(ValueError, match="another acts from 1 s to 2 s"):
        sim.add_fault(faults.OdometryDrift(alphas, start=1.5))
    assert len(sim.faults) == 2


def test_the_drift_depends_on_the_seed_of_the_simulation():
    def believed(seed):
        sim = mrs.Simulation(open_field().grid, parameters={"odometry_alphas": (0.1,) * 6}, seed=seed, start=(5, 5, 0))
        drive(sim, 0.5)
        sim.run_for(1.0)
        return tuple(sim.robot.believed_pose)

    assert believed(1) == believed(1) != believed(2)


def test_a_clock_jump_changes_stamps_but_not_the_robot(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.ClockJump(-0.75, at=1.0))
    node = sim.create_node("clerk")
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(6.0)
    assert node.get_clock().now().nanoseconds == 1_250_000_000
    assert sim.latest("/clock").clock.nanoseconds == sim.latest("/scan").header.stamp.nanoseconds == 1_250_000_000
    assert "the clock jumps by -0.75 s" in sim.latest("/faults").data


def test_nodes_stop_and_start_again(sim):
    drive(sim, 0.5)
    sim.add_fault(faults.Outage("laser", start=0.55, end=1.05))
    sim.add_fault(faults.Outage("robot", start=2.0, end=3.0))
    times = [time for time, _ in arrivals(sim, "/scan", 2.0)]
    assert times == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 1.15, 1.25, 1.35, 1.45, 1.55, 1.65, 1.75, 1.85, 1.95])
    assert arrivals(sim, "/odom", 1.05) == []
    assert sim.pose.x == pytest.approx(6.0)
    drive(sim, 0.5)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(6.5) and sim.latest("/odom").header.stamp.nanoseconds > 3_000_000_000


def test_a_node_starts_again_after_the_last_of_its_outages(sim):
    sim.add_fault(faults.Outage("laser", start=0.55, end=2.1))
    sim.add_fault(faults.Outage("laser", start=0.75, end=1.1))
    sim.add_fault(faults.Outage("robot", start=0.85, end=3.0))
    times = [time for time, _ in arrivals(sim, "/scan", 2.4)]
    assert times == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 2.2, 2.3, 2.4])


def test_an_outage_ends_the_command_of_a_robot_with_a_footprint():
    sim = open_field(robot_radius=0.2)
    drive(sim, 0.5)
    sim.add_fault(faults.Outage("robot", start=1.0, end=2.0))
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(5.5) and sim.truth.velocity == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("radius", [0.0, 0.2])
def test_a_reset_does_not_end_faults(radius):
    sim = open_field(robot_radius=radius)
    sim.add_fault(faults.Slip(0.4, end=3.0))
    sim.add_fault(faults.OdometryDrift((0.1,) * 6, end=3.0))
    sim.run_for(1.0)
    sim.reset()
    drive(sim, 0.5)
    sim.run_for(1.0)
    assert sim.truth.velocity[0] == pytest.approx(0.3) and sim.pose.x == pytest.approx(5.3)
    assert sim.latest("/odom").pose.covariance[0] > 1e-6
    sim.run_for(1.5)
    assert sim.truth.velocity[0] == pytest.approx(0.5)
    assert sim.latest("/odom").twist.covariance[0] == 1e-9


@pytest.mark.parametrize("alphas", [None, (0.05,) * 6])
def test_after_a_drift_its_error_stays_and_the_noise_of_the_parameters_is_back(alphas):
    sim = open_field(odometry_alphas=alphas)
    sim.add_fault(faults.OdometryDrift((0.5, 0.0, 0.0, 0.0, 0.0, 0.0), end=2.0))
    drive(sim, 0.5)
    errors, variances = [], []
    for _ in range(2):
        sim.run_for(2.0)
        odometry = sim.latest("/odom")
        errors.append(odometry.pose.pose.position.x - (sim.pose.x - 5.0))
        variances.append(odometry.pose.covariance[0])
    assert abs(errors[0]) > 0.01
    if alphas is None:
        assert errors[1] == pytest.approx(errors[0], abs=1e-9) and variances[1] == pytest.approx(variances[0])
    else:
        assert abs(errors[1] - errors[0]) > 1e-4 and variances[1] > variances[0]
    sim.reset()
    sim.run_for(0.1)
    assert sim.latest("/odom").pose.covariance[0] < 1e-6


def test_a_stopped_slip_ends_at_once_and_its_planned_end_changes_nothing(sim):
    drive(sim, 0.5)
    slip = sim.add_fault(faults.Slip(0.4, end=2.0))
    sim.run_for(1.0)
    slip.stop()
    assert not slip.acts
    sim.add_fault(faults.Slip(0.2, start=1.5))
    sim.run_for(2.0)
    assert sim.pose.x == pytest.approx(5.0 + 0.3 + 0.25 + 1.5 * 0.4)
    slip.stop()  # has no effect


def test_a_stopped_drift_can_be_followed_by_another_which_its_planned_end_does_not_stop(sim):
    drift = sim.add_fault(faults.OdometryDrift((1.0,) * 6, end=2.0))
    drive(sim, 0.5)
    sim.run_for(1.0)
    drift.stop()
    sim.add_fault(faults.OdometryDrift((1.0,) * 6, start=1.0, seed=1))
    sim.run_for(1.0)
    before = sim.latest("/odom").pose.covariance[0]
    sim.run_for(2.0)
    assert 0.0 < before < sim.latest("/odom").pose.covariance[0]


def test_a_node_is_back_when_its_outage_is_stopped(sim):
    outage = sim.add_fault(faults.Outage("laser"))
    sim.run_for(1.0)
    assert len(arrivals(sim, "/scan", 1.0)) == 0
    outage.stop()
    assert len(arrivals(sim, "/scan", 1.0)) == 10


def test_a_fault_stopped_before_its_start_never_acts(sim):
    drop = sim.add_fault(faults.Drop("/scan", start=1.0))
    outage = sim.add_fault(faults.Outage("laser", start=1.0))
    drop.stop(), outage.stop()
    assert len(arrivals(sim, "/scan", 3.0)) == 30


def test_a_fault_of_no_simulation_cannot_be_stopped():
    with pytest.raises(ValueError, match=r"Slip\(0.4\) acts on no simulation"):
        faults.Slip(0.4).stop()


def test_a_restored_fault_acts_again(sim):
    drop = sim.add_fault(faults.Drop("/scan"))
    state = sim.save()
    drop.stop()
    sim.restore(state)
    assert len(arrivals(sim, "/scan", 1.0)) == 0


def test_bad_pushes_are_refused():
    for arguments in ((-0.1,), (math.inf,), (math.nan,), (0.1, math.nan), (0.1, math.inf)):
        with pytest.raises(ValueError, match="speed"):
            faults.Push(*arguments)
    with pytest.raises(TypeError, match="direction must be a number, got 'north'"):
        faults.Push(0.1, "north")
    assert repr(faults.Push(0.25, 1.5, end=2.0)) == "Push(0.25 m/s, direction=1.5 rad, end=2 s)"
