"""messages: ROS field names, sensible defaults, equality by value, and planar poses there and back."""

from __future__ import annotations

import copy
import math
import pickle
from dataclasses import fields
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages

# Fields of the ROS definitions, in the same order.
FIELDS = {
    "Time": ("builtin_interfaces/msg/Time", "sec nanosec"),
    "Duration": ("builtin_interfaces/msg/Duration", "sec nanosec"),
    "Header": ("std_msgs/msg/Header", "stamp frame_id"),
    "Vector3": ("geometry_msgs/msg/Vector3", "x y z"),
    "Point": ("geometry_msgs/msg/Point", "x y z"),
    "Quaternion": ("geometry_msgs/msg/Quaternion", "x y z w"),
    "Pose": ("geometry_msgs/msg/Pose", "position orientation"),
    "Transform": ("geometry_msgs/msg/Transform", "translation rotation"),
    "PoseStamped": ("geometry_msgs/msg/PoseStamped", "header pose"),
    "PointStamped": ("geometry_msgs/msg/PointStamped", "header point"),
    "Bool": ("std_msgs/msg/Bool", "data"),
    "PoseWithCovariance": ("geometry_msgs/msg/PoseWithCovariance", "pose covariance"),
    "PoseWithCovarianceStamped": ("geometry_msgs/msg/PoseWithCovarianceStamped", "header pose"),
    "Twist": ("geometry_msgs/msg/Twist", "linear angular"),
    "TwistStamped": ("geometry_msgs/msg/TwistStamped", "header twist"),
    "TwistWithCovariance": ("geometry_msgs/msg/TwistWithCovariance", "twist covariance"),
    "TransformStamped": ("geometry_msgs/msg/TransformStamped", "header child_frame_id transform"),
    "TFMessage": ("tf2_msgs/msg/TFMessage", "transforms"),
    "Odometry": ("nav_msgs/msg/Odometry", "header child_frame_id pose twist"),
    "JointState": ("sensor_msgs/msg/JointState", "header name position velocity effort"),
    "AckermannDrive": (
        "ackermann_msgs/msg/AckermannDrive",
        "steering_angle steering_angle_velocity speed acceleration jerk",
    ),
    "AckermannDriveStamped": ("ackermann_msgs/msg/AckermannDriveStamped", "header drive"),
    "LaserScan": (
        "sensor_msgs/msg/LaserScan",
        "header angle_min angle_max angle_increment time_increment scan_time range_min range_max ranges intensities",
    ),
    "MapMetaData": ("nav_msgs/msg/MapMetaData", "map_load_time resolution width height origin"),
    "OccupancyGrid": ("nav_msgs/msg/OccupancyGrid", "header info data"),
    "Clock": ("rosgraph_msgs/msg/Clock", "clock"),
    "String": ("std_msgs/msg/String", "data"),
    "GetMapRequest": ("nav_msgs/srv/GetMap_Request", ""),
    "GetMapResponse": ("nav_msgs/srv/GetMap_Response", "map"),
    "TriggerRequest": ("std_srvs/srv/Trigger_Request", ""),
    "TriggerResponse": ("std_srvs/srv/Trigger_Response", "success message"),
    "SetPoseRequest": ("robot_localization/srv/SetPose_Request", "pose"),
    "SetPoseResponse": ("robot_localization/srv/SetPose_Response", ""),
}


@pytest.mark.parametrize(("name", "ros_type", "names"), [(name, *rest) for name, rest in FIELDS.items()])
def test_fields_and_types_are_those_of_ros(name: str, ros_type: str, names: str) -> None:
    message_type = getattr(messages, name)
    assert message_type.ros_type == ros_type
    assert [field.name for field in fields(message_type)] == names.split()
    assert message_type() == message_type()


def test_every_message_is_in_the_table() -> None:
    classes = {
        name
        for name, value in vars(messages).items()
        if isinstance(value, type) and issubclass(value, messages.Message) and value is not messages.Message
    }
    assert classes == set(FIELDS)


def test_the_default_orientation_is_the_identity() -> None:
    assert (messages.Quaternion().w, messages.Pose().to_planar()) == (1.0, mrs.Pose())


def test_messages_do_not_share_default_objects() -> None:
    one, other = messages.Odometry(), messages.Odometry()
    one.pose.covariance[0] = 1.0
    one.pose.pose.position.x = 1.0
    one.header.stamp.sec = 5
    assert other == messages.Odometry()


@pytest.mark.parametrize(
    ("left", "right"),
    [
        (mrs.messages.Twist(), mrs.messages.Twist(linear=mrs.messages.Vector3(x=1.0))),
        (mrs.messages.LaserScan(ranges=np.zeros(3, np.float32)), mrs.messages.LaserScan(ranges=np.zeros(4, np.float32))),
        (mrs.messages.LaserScan(ranges=np.array([1, math.inf])), mrs.messages.LaserScan(ranges=np.array([1, -math.inf]))),
        (mrs.messages.TFMessage([mrs.messages.TransformStamped()]), mrs.messages.TFMessage()),
        (mrs.messages.Vector3(), mrs.messages.Point()),
        (mrs.messages.Vector3(), 5),
    ],
)
def test_unequal_messages_are_unequal(left: Any, right: Any) -> None:
    assert left != right
    assert not left == right


def test_equal_messages_are_equal() -> None:
    ranges = np.array([1.0, math.inf, -math.inf, math.nan], np.float32)
    assert mrs.messages.LaserScan(ranges=ranges) == mrs.messages.LaserScan(ranges=ranges.copy())


@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda message: pickle.loads(pickle.dumps(message))])
@pytest.mark.parametrize("name", FIELDS)
def test_copies_are_equal(name: str, duplicate: Any) -> None:
    message = getattr(messages, name)()
    assert duplicate(message) == message


def test_an_unknown_field_is_rejected() -> None:
    with pytest.raises(AttributeError):
        mrs.messages.Twist().speed = 1.0
    with pytest.raises(TypeError, match="speed"):
        mrs.messages.Twist(speed=1.0)


@pytest.mark.parametrize("nanoseconds", [0, 1, 999_999_999, 1_000_000_000, 12_345_678_901_234])
def test_times_convert_there_and_back(nanoseconds: int) -> None:
    time = mrs.messages.Time.from_nanoseconds(nanoseconds)
    assert (time.sec, time.nanosec) == (nanoseconds // 10**9, nanoseconds % 10**9)
    assert time.nanoseconds == nanoseconds


@pytest.mark.parametrize("yaw", [-3.0, -0.5, 0.0, 1.0, math.pi])
def test_planar_poses_convert_there_and_back(yaw: float) -> None:
    pose = mrs.Pose(1.0, -2.0, yaw)
    message = messages.Pose.from_planar(pose)
    assert (message.position.x, message.position.y, message.position.z) == (1.0, -2.0, 0.0)
    assert (message.orientation.x, message.orientation.y) == (0.0, 0.0)
    assert (message.orientation.z, message.orientation.w) == pytest.approx((math.sin(yaw / 2), math.cos(yaw / 2)), abs=1e-15)
    transform = messages.Transform.from_planar(pose)
    assert (transform.translation.x, transform.translation.y, transform.translation.z) == (1.0, -2.0, 0.0)
    assert transform.rotation == message.orientation
    for back in (message.to_planar(), transform.to_planar()):
        assert tuple(back) == pytest.approx(tuple(pose), abs=1e-15)


def test_messages_are_only_in_their_module() -> None:
    """ROS messages live in `mrs.messages`: `Pose` and `OccupancyGrid` mean something else at the top level."""
    assert mrs.messages is messages
    for name in FIELDS:
        assert getattr(messages, name).ros_type
        assert name in ("Pose", "OccupancyGrid") or not hasattr(mrs, name)


@pytest.mark.parametrize("name", FIELDS)
def test_checked_copies_equal_the_message_and_share_nothing_that_can_change(name):
    message = getattr(messages, name)()
    copied = messages.checked_copy(message)
    assert copied == message == messages.copied(message) and type(copied) is type(message) and copied is not message
    for field in fields(message):
        value = getattr(copied, field.name)
        if isinstance(value, messages.Message | list) or (isinstance(value, np.ndarray) and value.flags.writeable):
            assert value is not getattr(message, field.name)


def test_checked_copies_keep_each_value_and_refuse_what_the_checks_refuse():
    odd = messages.Twist(messages.Vector3(np.float32(0.5), 1, -math.inf), messages.Vector3(math.nan, True, -0.0))
    copied = messages.checked_copy(odd)
    values = [getattr(part, axis) for part in (copied.linear, copied.angular) for axis in "xyz"]
    kinds = [np.float32, int, float, float, bool, float]
    assert [type(value) for value in values] == kinds and repr(copied) == repr(odd)
    for wrong in (messages.Twist(linear=3), messages.Twist(messages.Vector3(x="a")), messages.Header(messages.Time(0.5, 0))):
        with pytest.raises(TypeError) as caught:
            messages.checked_copy(wrong)
        with pytest.raises(TypeError) as expected:
            messages.check_fields(wrong)
        assert str(caught.value) == str(expected.value)
    nested = messages.TwistStamped(messages.Header(messages.Time(1, 2), "base"), messages.Twist())
    copied = messages.checked_copy(nested)
    nested.header.stamp.sec, nested.twist.linear.x = 5, 1.0
    assert (copied.header.stamp.sec, copied.twist.linear.x, copied.header.frame_id) == (1, 0.0, "base")
