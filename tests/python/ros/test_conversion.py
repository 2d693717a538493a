"""MessageConverter: converts our messages to ROS messages and back. Simple objects stand in for the ROS classes."""

from __future__ import annotations

import sys
from array import array
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mobile_robot_simulator.entity_messages import SetEntityStateRequest
from mobile_robot_simulator.messages import (
    JointState,
    LaserScan,
    Odometry,
    Pose,
    Quaternion,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    Twist,
    Vector3,
)
from mobile_robot_simulator.ros.conversion import MessageConverter

CONVERTER = MessageConverter(lambda values, present: array(present.typecode, values.tobytes()), "secs", "nsecs")


def ros_header() -> SimpleNamespace:
    return SimpleNamespace(stamp=SimpleNamespace(secs=0, nsecs=0), frame_id="")


def ros_scan() -> SimpleNamespace:
    numbers = dict.fromkeys(
        ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max"), 0.0
    )
    return SimpleNamespace(header=ros_header(), **numbers, ranges=array("f"), intensities=array("f"))


def ros_transform() -> SimpleNamespace:
    transform = SimpleNamespace(
        translation=SimpleNamespace(x=0.0, y=0.0, z=0.0), rotation=SimpleNamespace(x=0.0, y=0.0, z=0.0, w=1.0)
    )
    return SimpleNamespace(header=ros_header(), child_frame_id="", transform=transform)


def test_times_use_the_field_names_of_the_ros_version() -> None:
    ros_time = CONVERTER.fill(SimpleNamespace(secs=0, nsecs=0), Time(3, 5))
    assert (ros_time.secs, ros_time.nsecs) == (3, 5)
    assert CONVERTER.from_ros(ros_time, Time) == Time(3, 5)


def test_arrays_are_packed_and_come_back_with_their_dtype() -> None:
    scan = LaserScan(range_max=30.0, ranges=np.array([1.0, 2.5], np.float32))
    scan.header.stamp, scan.header.frame_id = Time(1, 2), "laser"
    ros_message = CONVERTER.to_ros(scan, ros_scan)
    assert ros_message.ranges == array("f", [1.0, 2.5])
    assert (ros_message.header.stamp.secs, ros_message.header.frame_id, ros_message.range_max) == (1, "laser", 30.0)
    back = CONVERTER.from_ros(ros_message, LaserScan)
    assert back == scan
    assert back.ranges.dtype == np.float32


def test_lists_of_messages_are_made_once_and_filled_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "geometry_msgs.msg", SimpleNamespace(TransformStamped=ros_transform))
    ros_message: Any = SimpleNamespace(transforms=[])
    items = []
    for x in (1.0, 2.0):
        transform = Transform(translation=Vector3(x=x), rotation=Quaternion(z=1.0, w=0.0))
        message = TFMessage([TransformStamped(child_frame_id="base_link", transform=transform)])
        CONVERTER.fill(ros_message, message)
        assert CONVERTER.from_ros(ros_message, TFMessage) == message
        items.append(ros_message.transforms[0])
    assert items[0] is items[1]


def test_classes_are_found_by_their_type_and_wrapped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "nav_msgs.msg", SimpleNamespace(Odometry=Odometry))
    wrapping = MessageConverter(
        lambda values, _: values, wrap_message_type=lambda ros_class: type("Wrapped", (ros_class,), {})
    )
    assert wrapping.find_type("nav_msgs/msg/Odometry") is Odometry
    assert wrapping.find_message_type("nav_msgs/msg/Odometry").__name__ == "Wrapped"
    with pytest.raises(ImportError):
        wrapping.find_type("no_such_package/msg/Odometry")


def test_a_field_that_a_version_of_ros_lacks_keeps_its_default() -> None:
    state = SimpleNamespace(header=ros_header(), pose=Pose(), twist=Twist())
    old = SimpleNamespace(entity="box", state=state)
    request = CONVERTER.from_ros(old, SetEntityStateRequest)
    assert (request.entity, request.set_pose, request.set_twist) == ("box", True, True)
    with pytest.raises(AttributeError):
        CONVERTER.from_ros(SimpleNamespace(entity="box"), SetEntityStateRequest)


def test_lists_of_texts_are_converted_both_ways() -> None:
    ours = JointState(name=["left", "right"], position=np.array([1.0, 2.0]))
    empty = SimpleNamespace(header=ros_header(), name=[], position=array("d"), velocity=array("d"), effort=array("d"))
    ros_message = CONVERTER.fill(empty, ours)
    assert ros_message.name == ["left", "right"] and ros_message.position == array("d", [1.0, 2.0])
    assert CONVERTER.from_ros(ros_message, JointState) == ours
    assert CONVERTER.fill(ros_message, JointState()).name == []
