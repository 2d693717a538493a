"""model: checks at the constructor, in files and after changes, and the names of frames."""

from __future__ import annotations

import pickle
from typing import Any

import pytest

from mobile_robot_simulator.parameters import LaserParameters, RobotParameters

MOUNT = "laser_mount must be 3 numbers [x, y, yaw] or 6 numbers [x, y, z, roll, pitch, yaw]"


@pytest.mark.parametrize(
    ("model", "values", "message"),
    [
        (LaserParameters, {"laser_mount": (1, 2)}, MOUNT + ", got (1, 2)"),
        (LaserParameters, {"laser_mount": [1, 2, 3, 4]}, MOUNT + ", got [1, 2, 3, 4]"),
        (LaserParameters, {"laser_mount": 3}, MOUNT + ", got 3"),
        (LaserParameters, {"laser_mount": {1, 2, 3}}, MOUNT + ", got {1, 2, 3}"),
        (LaserParameters, {"laser_mount": "abc"}, MOUNT + ", got 'abc'"),
        (LaserParameters, {"laser_mount": [1, "a", 3]}, "laser_mount[1] must be a valid number, got 'a'"),
        (
            RobotParameters,
            {"odometry_alphas": [0.1] * 2},
            "odometry_alphas must be 6 numbers [alpha1, alpha2, alpha3, alpha4, alpha5, alpha6], got [0.1, 0.1]",
        ),
        (RobotParameters, {"velocity_limits": [1, 2]}, "velocity_limits must be 3 numbers [vx, vy, wz], got [1, 2]"),
        (LaserParameters, {"laser_fov": "x"}, "laser_fov must be a valid number, got 'x'"),
        (LaserParameters, {"laser_beam_count": 1.5}, "laser_beam_count must be a valid integer, got 1.5"),
        (LaserParameters, {"laser_beam_count": "x"}, "laser_beam_count must be a valid integer, got 'x'"),
        (LaserParameters, {"apply_noise": 3}, "apply_noise must be a valid boolean, got 3"),
        (LaserParameters, {"laser_fow": 1.5}, "unknown parameter 'laser_fow'; did you mean 'laser_fov'?"),
    ],
)
def test_a_constructor_and_a_file_give_the_same_message(model: Any, values: dict[str, Any], message: str) -> None:
    for create in (model.checked, lambda values: model(**values)):
        with pytest.raises(ValueError) as caught:
            create(values)
        assert str(caught.value) == message


def test_changed_checks_the_values_and_returns_a_copy() -> None:
    old = LaserParameters()
    assert old.changed({"laser_fov": 1.0}).laser_fov == 1.0
    assert old.laser_fov == 4.71
    for bad in ({"laser_fov": -1.0}, {"laser_min_range": 99.0}, {"laser_fow": 1.0}):
        with pytest.raises(ValueError, match="laser_"):
            old.changed(bad)


def test_frames_have_the_prefix_and_are_no_values() -> None:
    parameters, unused = (RobotParameters(frame_prefix="one/", base_link_frame="/base") for _ in range(2))
    assert parameters.frames["base_link_frame"] == "one/base"
    assert parameters == unused == pickle.loads(pickle.dumps(parameters))
    assert parameters.model_dump() == unused.model_dump() and repr(parameters) == repr(unused)
    assert parameters.changed({"frame_prefix": ""}).frames["base_link_frame"] == "/base"
