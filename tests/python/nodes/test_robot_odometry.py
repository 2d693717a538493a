"""RobotOdometry: what the robot believes, while it slips, drifts and is carried."""

from __future__ import annotations

import pytest

import mobile_robot_simulator as mrs
from robot_rigs import Rig, close
from simulations import drive, simulation


@pytest.mark.parametrize("map_transform", [False, True])
@pytest.mark.parametrize("drifts", [False, True])
def test_the_odometry_does_not_notice_that_the_robot_is_carried(map_transform: bool, drifts: bool) -> None:
    alphas = {"odometry_alphas": (0.1,) * 6} if drifts else {}
    rigs = [Rig(publish_map_transform=map_transform, **alphas) for _ in range(2)]
    for rig in rigs:
        rig.drive(0.5, 1.0, 0.0, 0.5)
    rigs[0].robot.set_pose(mrs.Pose(-7.0, 0.0, 0.5))
    for rig in rigs:
        rig.drive(1.0, 1.0, 0.0, 0.5)
    for carried, left in zip(rigs[0].all("/odom"), rigs[1].all("/odom"), strict=True):
        assert carried.header == left.header
        close(carried.pose.pose.to_planar(), *left.pose.pose.to_planar())
        assert carried.twist.twist.linear.x == pytest.approx(left.twist.twist.linear.x, abs=1e-9)
        assert carried.pose.covariance == pytest.approx(left.pose.covariance)
    close(rigs[0].robot.pose, *mrs.Pose(-7.0, 0.0, 0.5).integrate((1.0, 0.0, 0.5), 0.5))


def test_slip_and_drift_can_be_parameters_that_change_while_the_robot_drives() -> None:
    rig = Rig(wheel_slip=0.5, velocity_timeout=0.0)
    rig.command(1.0)
    rig.run_to(1.0)
    assert rig.robot.pose.x == pytest.approx(0.5)
    rig.robot.set_parameters(wheel_slip=0.0)
    rig.run_to(2.0)
    assert rig.robot.pose.x == pytest.approx(1.5)
    rig.robot.slip(0.8)
    rig.run_to(3.0)
    assert rig.robot.pose.x == pytest.approx(1.7)
    rig.robot.set_parameters(wheel_slip=0.1)
    rig.robot.slip(None)
    rig.run_to(4.0)
    assert rig.robot.pose.x == pytest.approx(2.6)
    exact = rig.all("/odom")[-1]
    assert exact.pose.pose.position.x == pytest.approx(4.0) and exact.pose.covariance[0] == 1e-9
    rig.robot.set_parameters(odometry_alphas=(0.2,) * 6)
    rig.run_to(5.0)
    drifted = rig.all("/odom")[-1]
    assert abs(drifted.pose.pose.position.x - 5.0) > 1e-3 and drifted.pose.covariance[0] > 1e-6


def test_without_the_map_transform_odometry_starts_at_the_start_pose() -> None:
    rig = Rig(start_pose=mrs.Pose(3.0, 4.0, 1.0))
    rig.run_to(0.1)
    close(rig.all("/odom")[0].pose.pose.to_planar(), 3.0, 4.0, 1.0)


def test_restored_encoders_go_on_from_what_they_had_counted() -> None:
    sim = simulation(drive="differential", track=0.4, wheel_radius=0.1, encoder_ticks=64, publish_map_transform=False)
    drive(sim, 0.5, 0.3)
    sim.run_for(0.75)
    saved, believed = sim.save(), []
    for _ in range(2):
        sim.restore(saved)
        sim.run_for(0.5)
        first = sim.latest("/odom")
        sim.run_for(2.0)
        believed.append((first, sim.latest("/odom")))
    assert believed[0] == believed[1]
