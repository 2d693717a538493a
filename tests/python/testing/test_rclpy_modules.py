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
