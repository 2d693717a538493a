"""The definitions of common services and actions: each gives a class whose parts have defaults."""

from __future__ import annotations

import subprocess
import sys

import pytest

from mobile_robot_simulator.messages import copied
from mobile_robot_simulator.testing.common_definitions import ACTIONS, SERVICES
from mobile_robot_simulator.testing.ros_messages import generated_packages


@pytest.mark.parametrize("ros_type", [*SERVICES, *ACTIONS])
def test_the_parts_of_every_class_have_defaults(ros_type):
    package, folder, name = ros_type.split("/")
    kind = generated_packages()[f"{package}.{folder}"][name]
    parts = ("Goal", "Result", "Feedback") if ros_type in ACTIONS else ("Request", "Response")
    for part in (getattr(kind, part)() for part in parts):
        assert copied(part) == part and part.ros_type.startswith(f"{ros_type}_")


def test_an_action_of_the_user_can_be_the_first_definition():
    code = """
from mobile_robot_simulator.testing import stand_in
with stand_in({"lift_msgs/action/Lift": "float64 height\\n---\\nbool done\\n---\\n"}):
    from lift_msgs.action import Lift
print(Lift.Goal(height=0.5).height)
"""
    assert subprocess.check_output([sys.executable, "-c", code], text=True) == "0.5\n"
