"""Descriptors of parameters: their defaults are those of ROS, with rosbags and without."""

from __future__ import annotations

from dataclasses import fields

import pytest

from mobile_robot_simulator.bus import parameter_descriptor
from mobile_robot_simulator.testing.ros_messages import generated_packages


@pytest.mark.parametrize("name", ["ParameterDescriptor", "FloatingPointRange", "IntegerRange"])
def test_the_fields_and_defaults_are_those_of_ros(name):
    ours, ros = getattr(parameter_descriptor, name)(), generated_packages()["rcl_interfaces.msg"][name]()
    assert {it.name: getattr(ours, it.name) for it in fields(ours)} == {it.name: getattr(ros, it.name) for it in fields(ros)}
