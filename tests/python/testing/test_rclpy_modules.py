"""The modules that replace rclpy: which names they contain."""

from __future__ import annotations

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.node import Node
from mobile_robot_simulator.testing.rclpy_modules import RCLPY, message_packages, module_contents
from mobile_robot_simulator.testing.ros_messages import generated_packages


def test_every_message_class_is_in_the_package_of_its_ros_type():
    packages = message_packages()
    assert packages["geometry_msgs.msg"]["Twist"] is mrs.messages.Twist
    assert packages["nav_msgs.srv"]["GetMap"] is mrs.messages.GetMap
    for module, names in packages.items():
        for name, kind in names.items():
            assert kind.ros_type == f"{module.replace('.', '/')}/{name}"


def test_the_contents_are_those_of_rclpy_and_of_the_message_packages():
    contents = module_contents()
    assert contents.keys() == RCLPY.keys() | message_packages().keys() | generated_packages().keys()
    for module, names in contents.items():
        sources = [source.get(module, {}) for source in (RCLPY, message_packages(), generated_packages())]
        assert names.keys() == set().union(*sources)
    assert contents["rclpy.node"]["Node"] is Node
    assert contents["sensor_msgs.msg"]["LaserScan"] is mrs.messages.LaserScan


def test_small_modules_of_rclpy_do_what_they_say(caplog):
    utilities, logging = RCLPY["rclpy.utilities"], RCLPY["rclpy.logging"]
    arguments = ["node", "--ros-args", "-p", "speed:=1", "--", "map.yaml"]
    assert utilities["remove_ros_args"](arguments) == ["node", "map.yaml"]
    assert utilities["ok"]() and utilities["shutdown"]() is None
    logger = logging["get_logger"]("helper")
    assert [logger.warning("careful", throttle_duration_sec=60.0) for _ in range(2)] == [True, False]
    assert [(it.name, it.message) for it in caplog.records] == [("mobile_robot_simulator.helper", "careful")]
