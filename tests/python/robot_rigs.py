"""A robot node on a bus of its own, for tests of what it does and publishes."""

from __future__ import annotations

from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.parameters import RobotParameters

SECOND = 1_000_000_000


def twist(vx: float = 0.0, vy: float = 0.0, wz: float = 0.0) -> mrs.messages.Twist:
    return mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx, y=vy), angular=mrs.messages.Vector3(z=wz))


class Rig:
    """A robot on its own bus, with everything it publishes."""

    def __init__(self, *, start_pose: mrs.Pose | None = None, started: bool = True, **parameters: Any) -> None:
        self.bus = Bus()
        parameters = {"cmd_vel_stamped": False, **parameters}
        self.robot = mrs.nodes.MobileRobotSimulator(
            NoCopyNode(self.bus, "robot"), RobotParameters.checked(parameters), start_pose=start_pose
        )
        self.node = NoCopyNode(self.bus, "tester")
        self.sent: list[tuple[str, Any, int]] = []
        self.bus.taps.append(lambda *event: self.sent.append(event))
        if started:
            self.robot.start()

    def run_to(self, seconds: float) -> None:
        self.bus.run_until(round(seconds * SECOND))

    def command(self, vx: float = 0.0, vy: float = 0.0, wz: float = 0.0) -> None:
        self.node.create_publisher(mrs.messages.Twist, "/cmd_vel").publish(twist(vx, vy, wz))

    def place(self, x: float, y: float, yaw: float, frame: str = "map") -> None:
        message = mrs.messages.PoseWithCovarianceStamped(mrs.messages.Header(frame_id=frame))
        message.pose.pose = mrs.messages.Pose.from_planar(mrs.Pose(x, y, yaw))
        self.node.create_publisher(mrs.messages.PoseWithCovarianceStamped, "/initialpose").publish(message)

    def drive(self, until: float, vx: float = 0.0, vy: float = 0.0, wz: float = 0.0, every: float = 0.25) -> None:
        """Repeats a command until a time [s]."""
        while self.bus.time_ns < round(until * SECOND):
            self.command(vx, vy, wz)
            self.run_to(min(until, self.bus.time_ns / SECOND + every))

    def all(self, topic: str) -> list[Any]:
        return [message for name, message, _ in self.sent if name == topic]


def close(pose: mrs.Pose, x: float, y: float, yaw: float, tolerance: float = 1e-12) -> bool:
    assert tuple(pose) == pytest.approx((x, y, yaw), abs=tolerance)
    return True
