"""Inputs: what a page may send."""

import pytest

from mobile_robot_simulator.live.inputs import AddObstacle, Drive, SetGoal, read_input


def test_an_input_is_an_object_with_a_kind():
    assert read_input({"kind": "drive", "robot": "", "vx": 0.5}) == Drive(robot="", vx=0.5)
    assert read_input({"kind": "add_obstacle", "x": 1, "y": 2, "radius": 0.3}) == AddObstacle(x=1.0, y=2.0, radius=0.3)
    assert read_input({"kind": "set_goal", "robot": "a", "x": 1, "y": 2, "yaw": 0}) == SetGoal(
        robot="a", x=1.0, y=2.0, yaw=0.0
    )


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (None, "an input must be an object with a kind, got None"),
        ([1], "an input must be an object"),
        ({"kind": "explode"}, "explode"),
        ({}, "kind"),
        ({"kind": "drive", "robot": "", "vx": float("nan")}, "drive vx: .*finite.*got nan"),
        ({"kind": "drive", "robot": "", "vx": 1e9}, "drive vx: .*less than or equal to"),
        ({"kind": "drive", "robot": 3}, "drive robot: .*string.*got 3"),
        ({"kind": "drive", "robot": "", "more": 1}, "drive more: .*not permitted"),
        ({"kind": "drive", "robot": "x" * 2000}, "drive robot: .*at most 1000"),
        ({"kind": "set_pose", "robot": "", "x": "inf", "y": 0, "yaw": 0}, "set_pose x: .*finite"),
        ({"kind": "step", "seconds": 0}, "step seconds: .*greater than 0"),
        ({"kind": "step", "seconds": 1e6}, "step seconds: .*less than or equal to 60"),
        ({"kind": "speed", "factor": -1}, "speed factor"),
        ({"kind": "record", "name": "../../etc"}, "record name: .*pattern.*got '../../etc'"),
        ({"kind": "record", "name": ""}, "record name"),
        ({"kind": "save_state", "name": "a/b"}, "save_state name"),
        ({"kind": "seed", "seed": -1}, "seed seed: .*greater than or equal to 0"),
        ({"kind": "autopilot", "robot": "", "driver": "rm"}, "autopilot driver"),
    ],
)
def test_anything_else_is_refused_with_its_field(data, message):
    with pytest.raises(ValueError, match=message):
        read_input(data)
