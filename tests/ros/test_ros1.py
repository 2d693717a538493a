"""What is particular to ROS 1: its command-line tools, its bags, its launch file and its parameter server."""

from __future__ import annotations

import math
import re
import time
from pathlib import Path
from typing import Any

import numpy as np

import mobile_robot_simulator as mrs
from scenes import record_drive
from test_nodes import ODOM, QUIET, SCAN, TF, TWIST, twist
from worlds import find, wait_until

URDF = """
<robot name="robot">
  <link name="base_link"/>
  <link name="mast"/>
  <link name="laser"/>
  <joint name="base_to_mast" type="fixed">
    <parent link="base_link"/>
    <child link="mast"/>
    <origin xyz="0.3 0.1 0.4" rpy="0 0 1.5707963267948966"/>
  </joint>
  <joint name="mast_to_laser" type="fixed">
    <parent link="mast"/>
    <child link="laser"/>
    <origin xyz="0.2 0 0.1" rpy="0 0 0"/>
  </joint>
</robot>
"""
"""A laser on a mast, which is turned to the left."""


def test_rostopic_echo_and_hz_work(world: Any, map_file: Path) -> None:
    world.start("all", map_file=map_file, publish_rate=50.0, **QUIET)
    world.subscribe("/odom", ODOM).wait_for(1)
    echo = world.run("rostopic", "echo", "-n1", "/odom")
    assert echo.wait() == 0
    assert 'child_frame_id: "base_link"' in echo.output
    measure = world.run("rostopic", "hz", "/odom")
    rate = wait_until(lambda: re.findall(r"average rate: ([\d.]+)", measure.output)[2:], "rates")
    assert 47.0 < float(rate[0]) < 53.0


def test_remapping_node_names_and_private_parameters_work(world: Any) -> None:
    world.start("robot", remap=("/odom:=/moved", "__name:=tortoise"), base_link_frame="shell", publish_rate=20.0)
    assert world.subscribe("/moved", ODOM).next().child_frame_id == "shell"
    nodes = world.run("rosnode", "list")
    assert nodes.wait() == 0
    assert "/tortoise" in nodes.output.split()


def test_the_laser_of_all_subscribes_to_transforms_while_another_process_publishes_them(world: Any, map_file: Path) -> None:
    import rosgraph

    def subscribes() -> bool:
        _, subscribed, _ = rosgraph.Master("/test").getSystemState()
        return any(topic == "/tf" and "/simulator" in nodes for topic, nodes in subscribed)

    other = world.start("robot", remap=("__name:=other", "/odom:=/other"))
    world.subscribe("/other", ODOM).wait_for(1)
    world.start("all", map_file=map_file, remap=("__name:=simulator",), pose_source="tf")
    wait_until(subscribes, "a subscription")
    # The master still lists a node that was killed.
    other.kill()
    wait_until(lambda: not subscribes(), "the subscription's end")


def test_rosbag_records_and_replays(world: Any, map_file: Path, tmp_path: Path) -> None:
    nodes = world.start("all", map_file=map_file, publish_rate=50.0, laser_frequency=20.0, **QUIET)
    scan = world.subscribe("/scan", SCAN)
    scan.wait_for(2)
    recorder = world.run("rosbag", "record", "-O", str(tmp_path / "drive.bag"), "/odom", "/scan", "/tf", "/map")
    time.sleep(4.0)
    recorder.interrupt()
    nodes.interrupt()
    info = world.run("rosbag", "info", str(tmp_path / "drive.bag"))
    assert info.wait() == 0
    for topic in ("nav_msgs/Odometry", "sensor_msgs/LaserScan", "tf2_msgs/TFMessage", "nav_msgs/OccupancyGrid"):
        assert topic in info.output
    world.run("rosbag", "play", str(tmp_path / "drive.bag"))
    scan.wait_for(20)


def test_rosbag_plays_our_recordings(world: Any, map_file: Path, tmp_path: Path) -> None:
    bag = record_drive(map_file, tmp_path / "drive", "bag")
    odom, scan = world.subscribe("/odom", ODOM), world.subscribe("/scan", SCAN)
    player = world.run("rosbag", "play", "-d", "2", "-r", "2", str(bag))
    assert player.wait() == 0
    assert len(odom) >= 45
    assert len(scan) >= 45
    assert np.isfinite(np.asarray(scan[-1].ranges)).any()


def test_roslaunch_starts_the_map_server_the_robot_and_the_laser(world: Any, map_file: Path) -> None:
    launch = world.run("roslaunch", "mobile_robot_simulator", "simulator.launch", f"map_file:={map_file}")
    scan, odom = world.subscribe("/scan", SCAN), world.subscribe("/odom", ODOM)
    scan.wait_for(5)
    assert len(scan[-1].ranges) == 541
    world.publisher("/cmd_vel", TWIST)(twist(0.5, 0.0))
    odom.next(lambda it: it.pose.pose.position.x > 0.05)
    given = world.rospy.get_param("/laser_scanner_simulator_node")
    defaults = mrs.nodes.LaserScannerSimulator(
        mrs.Simulation(mrs.load_map(map_file)).create_node("x")
    ).parameters.model_dump()
    assert given == {name: value for name, value in defaults.items() if value is not None}
    launch.interrupt()
    assert "Traceback" not in launch.output
    assert "unknown parameter" not in launch.output


def test_tf2_transforms_scans_as_they_arrive(world: Any, map_file: Path) -> None:
    import rospy
    import tf2_ros

    buffer, found = tf2_ros.Buffer(debug=False), list[bool]()
    listener = tf2_ros.TransformListener(buffer, tcp_nodelay=True)

    def look_up(scan: Any) -> None:
        # Transforms and scans arrive on connections of their own, so a scan may be ahead by the switch of a thread.
        found.append(buffer.can_transform("odom", scan.header.frame_id, scan.header.stamp, rospy.Duration(0.02)))

    world.start("all", map_file=map_file)
    scans = world.subscribe("/scan", SCAN)
    scans.wait_for(10)
    world.inboxes.append(rospy.Subscriber("/scan", find(SCAN), look_up))
    wait_until(lambda: len(found) >= 40, "scans")
    listener.unregister()
    assert np.mean(found) >= 0.95


def test_robot_state_publisher_mounts_the_laser_where_the_urdf_says(world: Any, map_file: Path) -> None:
    import rospy

    rospy.set_param("/urdf/robot", URDF)
    world.run("rosrun", "robot_state_publisher", "robot_state_publisher", "robot_description:=/urdf/robot")
    # The mount has to be known before the first scan.
    world.subscribe("/tf_static", TF).wait_for(1)
    world.start("all", map_file=map_file, laser_frame_id="laser", **QUIET)
    scan = world.subscribe("/scan", SCAN).next()
    mount = mrs.Pose(0.3, 0.1, math.pi / 2) * mrs.Pose(0.2, 0.0, 0.0)
    laser = mrs.LaserScanner(fov=4.71, beam_count=181, max_range=30.0)
    differences = np.abs(np.asarray(scan.ranges) - laser.scan(mrs.load_map(map_file), mount))
    # Beams close to a corner may hit either side of it.
    assert np.sum(differences > 1e-3) <= 2
    assert scan.header.frame_id == "laser"


def test_with_use_sim_time_the_laser_follows_the_clock_of_the_robot(world: Any, map_file: Path) -> None:
    world.rospy.set_param("/use_sim_time", True)
    try:
        world.start("robot", publish_clock=True, speed_factor=3.0, publish_rate=50.0, publish_map_transform=True)
        world.start("map", map_file=map_file)
        world.start("laser", laser_frequency=10.0)
        scan = world.subscribe("/scan", SCAN)
        scan.wait_for(5)
        start, began = len(scan), time.monotonic()
        time.sleep(4.0)
        assert 26.0 < (len(scan) - start) / (time.monotonic() - began) < 34.0
    finally:
        world.rospy.set_param("/use_sim_time", False)


def test_a_deleted_parameter_gets_its_default(world: Any, map_file: Path) -> None:
    world.start("all", map_file=map_file, **QUIET)
    scan = world.subscribe("/scan", SCAN)
    assert len(scan.next().ranges) == 181
    world.rospy.delete_param("/mobile_robot_simulator/laser_beam_count")
    scan.next(lambda it: len(it.ranges) == 541)


def test_a_refusal_is_logged_once_for_all_nodes_and_takes_the_value_back(world: Any) -> None:
    process = world.start("all")
    world.subscribe("/odom", ODOM).wait_for(1)
    world.rospy.set_param("/mobile_robot_simulator/base_frame_id", "shell")
    wait_until(lambda: "base_frame_id (a parameter of nav2_loopback_sim) can only be set" in process.output, "the refusal")
    # The laser's mount is not set, so there is no value to write back.
    world.rospy.set_param("/mobile_robot_simulator/laser_mount", "nowhere")
    wait_until(lambda: not world.rospy.has_param("/mobile_robot_simulator/laser_mount"), "the end of the value")
    assert process.output.count("base_frame_id (a parameter of nav2_loopback_sim) can only be set") == 1
    assert world.set_parameter("mobile_robot_simulator", "publish_rate", 20.0)
    assert process.running
