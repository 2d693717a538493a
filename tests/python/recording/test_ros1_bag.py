"""Ros1Bag: what ROS 1 expects of a bag."""

from __future__ import annotations

from pathlib import Path

from rosbags.highlevel import AnyReader
from rosbags.interfaces import ConnectionExtRosbag1

from mobile_robot_simulator import messages as ros
from recordings import KINDS, read, record

# MD5 sums of the message definitions of ROS 1 Noetic. Players and subscribers refuse other sums.
ROS1_SUMS = {
    "geometry_msgs/msg/PoseWithCovarianceStamped": "953b798c0f514ff060a53a3498ce6246",
    "geometry_msgs/msg/Twist": "9f195f881246fdfa2798d1d3eebca84a",
    "geometry_msgs/msg/TwistStamped": "98d34b0043a2093cf9d9345ab6eef12e",
    "nav_msgs/msg/OccupancyGrid": "3381f2d731d4076ec5c71b0759edbe4e",
    "nav_msgs/msg/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "rosgraph_msgs/msg/Clock": "a9c97c1d230cfc112e270351a944ee47",
    "sensor_msgs/msg/LaserScan": "90c7ef2dc6895d81024acba2ac42f369",
    "tf2_msgs/msg/TFMessage": "94810edda583a504dfda3829e70d7eec",
}


def test_type_checksums_and_latching(tmp_path: Path) -> None:
    messages: list[tuple[str, ros.Message, int]] = [
        (f"/{kind.__name__}", kind(), 1) for kind in KINDS if kind.ros_type in ROS1_SUMS
    ]
    messages += [("/map", ros.OccupancyGrid(), 1)]
    with AnyReader([record(tmp_path, "bag", messages)]) as reader:
        sums = {connection.msgtype: connection.digest for connection in reader.connections}
        extras = {connection.topic: connection.ext for connection in reader.connections}
    assert sums == ROS1_SUMS
    assert extras["/map"] == ConnectionExtRosbag1(None, 1)
    assert extras["/Odometry"] == ConnectionExtRosbag1(None, None)


def test_headers_have_a_sequence_number(tmp_path: Path) -> None:
    messages: list[tuple[str, ros.Message, int]] = [("/scan", ros.LaserScan(), 1)]
    ((_, got, _),) = read(record(tmp_path, "bag", messages))
    assert got.header.seq == 0
