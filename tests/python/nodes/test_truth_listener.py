"""TruthListener, and a scanner that measures from the ground truth of a robot on its topic."""

from __future__ import annotations

import logging
import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.parameters import LaserParameters, RobotParameters

SECOND = 1_000_000_000


class Rig:
    """A robot and a scanner that know each other only through topics."""

    def __init__(self, grid: mrs.OccupancyGrid, *, robot: dict[str, Any] | None = None, **laser: Any) -> None:
        self.bus = Bus()
        self.scans: list[messages.LaserScan] = []
        self.node = NoCopyNode(self.bus, "tester")
        self.laser = mrs.nodes.LaserScannerSimulator(
            NoCopyNode(self.bus, "laser"),
            LaserParameters.checked({"laser_beam_count": 61, "apply_noise": False, **laser}),
            grid=grid,
        )
        parameters = {
            "initial_pose": (-2.0, -2.0, 0.5),
            "odometry_alphas": (0.2,) * 6,
            "cmd_vel_stamped": False,
            **(robot or {}),
        }
        self.robot = mrs.nodes.MobileRobotSimulator(NoCopyNode(self.bus, "robot"), RobotParameters.checked(parameters))
        self.robot.start()
        self.laser.start()
        self.node.create_subscription(messages.LaserScan, "/scan", self.scans.append, QoS.DEFAULT)
        self.commands = self.node.create_publisher(messages.Twist, "/cmd_vel")

    def drive(self, until: float, vx: float = 0.0, wz: float = 0.0) -> None:
        twist = messages.Twist(messages.Vector3(vx), messages.Vector3(z=wz))
        while self.bus.time_ns < round(until * SECOND):
            self.commands.publish(twist)
            self.bus.run_until(min(self.bus.time_ns + SECOND // 4, round(until * SECOND)))

    def is_seen_from(self, scan: messages.LaserScan, grid: mrs.OccupancyGrid, pose: mrs.Pose) -> bool:
        scanner = self.laser.scanner
        expected = scanner.mark_invalid(scanner.scan_batch(grid, [tuple(pose)])[0], no_return="inf")
        return np.allclose(scan.ranges, expected, atol=1e-4)


def test_a_scan_is_measured_from_the_true_pose_and_not_from_tf(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, laser_frequency=40.0)
    rig.drive(1.0, 0.5, 0.4)
    assert len(rig.scans) > 35
    # The last scan lies between two messages, or at one of them.
    assert rig.is_seen_from(rig.scans[-1], room, mrs.Pose(-2.0, -2.0, 0.5).integrate((0.5, 0.0, 0.4), 1.0))
    assert not rig.is_seen_from(rig.scans[-1], room, rig.robot.believed_pose)


def test_a_carried_robot_scans_from_its_new_place(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.drive(1.0)
    rig.robot.set_pose(mrs.Pose(3.0, -1.0, -2.0))
    rig.drive(1.3)
    assert rig.is_seen_from(rig.scans[-1], room, mrs.Pose(3.0, -1.0, -2.0))


@pytest.mark.parametrize("laser", [{"pose_source": "tf"}, {"ground_truth_topic": ""}])
def test_without_the_truth_scans_are_measured_from_tf(room: mrs.OccupancyGrid, laser: dict[str, Any]) -> None:
    rig = Rig(room, **laser)
    rig.drive(1.0, 0.5, 0.4)
    assert rig.is_seen_from(rig.scans[-1], room, rig.robot.believed_pose)


def test_tf_counts_until_the_first_true_pose(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room, robot={"ground_truth_topic": ""})
    rig.drive(1.0, 0.5, 0.4)
    assert rig.is_seen_from(rig.scans[-1], room, rig.robot.believed_pose)
    rig.robot.set_parameters(ground_truth_topic="ground_truth")
    rig.drive(1.5, 0.5, 0.4)
    assert rig.is_seen_from(rig.scans[-1], room, mrs.Pose(-2.0, -2.0, 0.5).integrate((0.5, 0.0, 0.4), 1.5))


def test_if_the_true_pose_ends_there_are_no_scans_and_the_log_says_so(
    room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture
) -> None:
    rig = Rig(room)
    rig.drive(1.0)
    rig.robot.set_parameters(ground_truth_topic="")
    with caplog.at_level(logging.WARNING):
        rig.drive(6.0)
    assert rig.scans[-1].header.stamp.nanoseconds <= 2.1 * SECOND
    assert "the laser waits for the robot's pose (on topic /ground_truth, where the last one is" in caplog.text


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_truth_that_is_not_finite_is_refused(
    room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture, bad: float
) -> None:
    rig = Rig(room, robot={"ground_truth_topic": ""})
    truth = rig.node.create_publisher(messages.Odometry, "ground_truth")
    message = messages.Odometry()
    message.pose.pose.position.x = bad
    truth.publish(message)
    message = messages.Odometry()
    message.twist.twist.linear.x = bad
    with caplog.at_level(logging.WARNING):
        truth.publish(message)
        rig.drive(0.5)
    assert caplog.text.count("ground truth on /ground_truth refused: ") == 1
    assert rig.is_seen_from(rig.scans[-1], room, rig.robot.believed_pose)


def test_a_saved_listener_remembers_the_truth(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.drive(0.2)
    state = rig.laser.save()
    rig.robot.set_pose(mrs.Pose(3.0, -1.0, 0.0))
    rig.drive(0.4)
    rig.laser.restore(state)
    assert rig.laser.save().truth == state.truth


@pytest.mark.parametrize(("frame", "child"), [("odom", "base_link"), ("map", "other")])
def test_a_truth_in_another_frame_or_of_another_robot_is_refused(
    room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture, frame: str, child: str
) -> None:
    rig = Rig(room, robot={"ground_truth_topic": ""})
    message = messages.Odometry(messages.Header(frame_id=frame), child)
    with caplog.at_level(logging.WARNING):
        rig.node.create_publisher(messages.Odometry, "ground_truth").publish(message)
        rig.drive(0.5)
    assert "ground truth on /ground_truth refused: it must be " in caplog.text
    assert rig.is_seen_from(rig.scans[-1], room, rig.robot.believed_pose)


def test_without_a_topic_from_now_on_tf_counts_again(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.drive(1.0, 0.5, 0.4)
    rig.laser.set_parameters(ground_truth_topic="")
    rig.drive(3.0, 0.1, 0.4)
    assert rig.scans[-1].header.stamp.nanoseconds == 3 * SECOND
    assert rig.is_seen_from(rig.scans[-1], room, rig.robot.believed_pose)
