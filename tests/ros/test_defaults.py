"""The nodes with no parameters at all, among clients that know only the original."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from test_nodes import MAP, ODOM, SCAN, TWIST, TWIST_STAMPED
from worlds import VERSION, wait_until

PUBLISH = """
import sys, time
from importlib import import_module
kind, vx = sys.argv[1], float(sys.argv[2])
message = getattr(import_module("geometry_msgs.msg"), kind)()
(message.twist if kind == "TwistStamped" else message).linear.x = vx
if sys.argv[3] == "1":
    import rospy
    rospy.init_node("commander", anonymous=True)
    publisher = rospy.Publisher("/cmd_vel", type(message), queue_size=10)
else:
    import rclpy
    rclpy.init()
    publisher = rclpy.create_node("commander").create_publisher(type(message), "/cmd_vel", 10)
while True:
    publisher.publish(message)
    time.sleep(0.1)
"""
"""Sends commands of a type at 10 Hz. Arguments: type, velocity, version of ROS."""


def command(world: Any, ros_type: str, vx: float) -> Any:
    """Starts a process that sends commands. Fast DDS allows one type of a topic in each process."""
    return world.run(sys.executable, "-c", PUBLISH, ros_type.rpartition("/")[2], str(vx), VERSION)


def test_a_laser_and_a_map_server_measure_the_map(world: Any, map_file: Path) -> None:
    for node in ("map", "robot", "laser"):
        world.start(node, map_file=map_file if node == "map" else None)
    scan, maps = world.subscribe("/scan", SCAN), world.subscribe("/map", MAP, latched=True)
    scan.wait_for(2)
    assert len(scan[-1].ranges) == 541
    assert np.isfinite(np.asarray(scan[-1].ranges)).any()
    wait_until(lambda: maps, "the map")
    assert (scan[-1].header.frame_id, maps[-1].header.frame_id) == ("base_link", "map")


def test_commands_of_the_other_type_beside_the_own_one_are_ignored_with_one_warning(world: Any) -> None:
    own, other = (TWIST, TWIST_STAMPED) if VERSION == "1" else (TWIST_STAMPED, TWIST)
    process = world.start("robot")
    odom = world.subscribe("/odom", ODOM)
    command(world, own, 0.25)
    odom.next(lambda it: it.twist.twist.linear.x == 0.25)
    command(world, other, 0.5)
    wait_until(lambda: "published with several types" in process.output, "the warning")
    odom.wait_for(40)
    assert {it.twist.twist.linear.x for it in odom[-30:]} == {0.25}
    assert process.output.count("published with several types") == 1
    assert "using that" not in process.output


@pytest.mark.parametrize("name", ["map", "static_map"])
def test_a_robot_in_a_namespace_can_use_the_map_outside_of_it(world: Any, map_file: Path, name: str) -> None:
    world.start("map", map_file=map_file)
    process = world.start("all", remap=(*world.in_namespace("robot1"), f"{name}:=/{name}"))
    wait_until(lambda: "using a map of 160x120 cells" in process.output, "the map")
    world.subscribe("/robot1/scan", SCAN).wait_for(2)


@pytest.mark.skipif(VERSION != "1", reason="rostopic belongs to ROS 1")
def test_rostopic_pub_moves_the_robot(world: Any) -> None:
    world.start("robot")
    odom = world.subscribe("/odom", ODOM)
    world.run("rostopic", "pub", "-r", "10", "/cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.25}}")
    odom.next(lambda it: it.pose.pose.position.x > 0.05)
