"""robot: names, defaults and checks of the robot's parameters, and the objects built from them."""

from __future__ import annotations

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.parameters import RobotParameters, motion_noise

# Names and defaults of the original package, which existing launch files use.
ROBOT = {
    "publish_map_transform": False,
    "publish_rate": 10.0,
    "velocity_topic": "cmd_vel",
    "odometry_topic": "odom",
    "base_link_frame": "base_link",
    "cmd_vel_stamped": True,
    "speed_factor": 1.0,
    "velocity_timeout": 0.5,
}


@pytest.mark.parametrize(("name", "default"), ROBOT.items())
def test_names_and_defaults(name: str, default: object) -> None:
    value = getattr(RobotParameters(), name)
    assert value == default
    assert type(value) is type(default)
    assert RobotParameters.model_fields[name].description


def test_the_node_name_is_that_of_the_original() -> None:
    assert RobotParameters.node_name == "mobile_robot_simulator_node"


def test_a_footprint_has_an_area() -> None:
    with pytest.raises(ValueError, match=r"^footprint must be the corners \[\[x, y\], \.\.\.\] of a polygon"):
        RobotParameters.checked({"footprint": [[0, 0], [1, 1]]})


def test_parameters_build_the_noise_model() -> None:
    alphas = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    numbered = {"alpha1": 0.1, "alpha2": 0.2, "alpha3": 0.3, "alpha4": 0.4, "alpha5": 0.5, "alpha6": 0.6}
    noise = mrs.MotionNoise(**numbered, reference_step=0.1)
    assert motion_noise(alphas) == RobotParameters(odometry_alphas=alphas).motion_noise == noise
    assert RobotParameters().motion_noise is None
