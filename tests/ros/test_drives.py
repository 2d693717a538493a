"""Robots on wheels on ROS 1 and ROS 2: commands for a car, its odometry and its joint states."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.parameters.robot import JOINTS
from test_nodes import ODOM, odom_pose
from worlds import find

STEERED, JOINT_STATE = "ackermann_msgs/msg/AckermannDriveStamped", "sensor_msgs/msg/JointState"
SIZE = {"wheelbase": 0.5, "track": 0.4, "wheel_radius": 0.1}
CAR = mrs.Drive.ackermann(**SIZE, steering_limit=0.6)
SPEED, ANGLE, RATE = 0.5, float(np.float32(0.3)), float(np.float32(0.1))
"""The fields of the message are float32."""
RADIUS = SIZE["wheelbase"] / math.tan(ANGLE)


def steered(speed: float, angle: float, rate: float = 0.0) -> Any:
    message = find(STEERED)()
    message.drive.speed, message.drive.steering_angle, message.drive.steering_angle_velocity = speed, angle, rate
    return message


def middle(state: Any) -> float:
    """Steering angle of a wheel in the middle of the front axle, whose cotangent is the mean of those beside it."""
    left, right = state.position[4:]
    return math.atan(2.0 / (1.0 / math.tan(left) + 1.0 / math.tan(right)))


def test_a_car_takes_ackermann_drive_stamped(world: Any) -> None:
    process = world.start("robot", drive="ackermann", steering_limit=0.6, velocity_timeout=0.0, publish_rate=50.0, **SIZE)
    odom, joints = world.subscribe("/odom", ODOM), world.subscribe("/joint_states", JOINT_STATE)
    publish = world.publisher("/ackermann_cmd", STEERED)
    odom.wait_for(1)
    joints.wait_for(1)
    publish(steered(SPEED, ANGLE))
    odom.next(lambda it: odom_pose(it).yaw > 0.3)
    state = odom[-1]
    turn = SPEED / RADIUS
    assert (state.twist.twist.linear.x, state.twist.twist.angular.z) == pytest.approx((SPEED, turn), abs=1e-12)
    # The car drives on a circle to the left, whose centre is on the axis of its rear wheels.
    pose = odom_pose(state)
    expected = (RADIUS * math.sin(pose.yaw), RADIUS * (1.0 - math.cos(pose.yaw)))
    assert (pose.x, pose.y) == pytest.approx(expected, abs=1e-9)

    wheels = joints.next()
    assert list(wheels.name) == list(JOINTS["ackermann"])
    assert wheels.position[4:] == pytest.approx(CAR.steering_angles([ANGLE])[0], abs=1e-12)
    assert wheels.velocity[:4] == pytest.approx(CAR.wheels_of_twist([(SPEED, 0.0, turn)])[0], abs=1e-12)
    rear_left, rear_right = (SIZE["wheel_radius"] * angle for angle in wheels.position[2:4])
    assert (rear_right - rear_left) / SIZE["track"] == pytest.approx(0.5 * (rear_left + rear_right) / RADIUS, abs=1e-9)

    publish(steered(math.nan, 0.0))
    publish(steered(0.0, 0.0, RATE))
    turning = joints.next(lambda it: it.velocity[4] < 0.0)
    angle = middle(turning)
    assert 0.0 < angle < ANGLE
    assert turning.velocity[4:] == pytest.approx(CAR.steering_angle_rates([angle], [-RATE])[0], abs=1e-9)
    assert odom.next().twist.twist.linear.x == 0.0
    assert process.output.count("steering command refused: |speed|") == 1
