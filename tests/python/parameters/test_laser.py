"""laser: names, defaults and checks of the scanner's parameters, and the objects built from them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.parameters import LaserParameters

# Names and defaults of the original package, which existing launch files use.
LASER = {
    "laser_topic": "scan",
    "map_service": "static_map",
    "laser_frame_id": "base_link",
    "laser_fov": 4.71,
    "laser_beam_count": 541,
    "laser_max_range": 30.0,
    "laser_min_range": 0.05,
    "laser_frequency": 10.0,
    "apply_noise": True,
    "sigma_hit": 0.005,
    "lambda_short": 2.0,
    "z_hit": 0.995,
    "z_short": 0.0,
    "z_max": 0.005,
    "z_rand": 0.0,
    "no_return": "inf",
    "unknown": "free",
}


@pytest.mark.parametrize(("name", "default"), LASER.items())
def test_names_and_defaults(name: str, default: object) -> None:
    value = getattr(LaserParameters(), name)
    assert value == default
    assert type(value) is type(default)
    assert LaserParameters.model_fields[name].description


def test_the_node_name_is_that_of_the_original() -> None:
    assert LaserParameters.node_name == "laser_scanner_simulator_node"


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("laser_fov", 6.3, "laser_fov must be less than or equal to 6.28"),
        ("laser_max_range", 0.05, "laser_min_range must be less than laser_max_range 0.05, got 0.05"),
        ("laser_min_range", 30.0, "laser_min_range must be less than laser_max_range 30.0, got 30.0"),
        ("no_return", "nan", "no_return must be 'inf', 'max' or 'below_max', got 'nan'"),
        ("unknown", "maybe", "unknown must be 'free' or 'occupied', got 'maybe'"),
        ("laser_mount", [0.0, 0.0], "laser_mount must be 3 numbers [x, y, yaw] or 6 numbers"),
        ("laser_mount", [0.0, 0.0, math.nan], "laser_mount[2] must be a finite number, got nan"),
    ],
)
def test_invalid_values_are_refused(name: str, value: Any, words: str) -> None:
    with pytest.raises(ValueError) as caught:
        LaserParameters.checked({name: value})
    assert words in str(caught.value)


@pytest.mark.parametrize("mount", [[0.1, 0, -0.5], [0.1, 0, 0.3, 3.14, 0, -0.5], np.array([0.1, 0.0, 0.5])])
def test_a_mount_is_a_list_or_an_array(mount: Any) -> None:
    # A laser_mount requires a frame other than the robot's.
    assert LaserParameters(laser_frame_id="laser", laser_mount=mount).laser_mount == tuple(mount)


def test_a_mount_can_be_none() -> None:
    assert LaserParameters(laser_mount=None).laser_mount is None


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"laser_angle_min": 0.0}, "laser_angle_min and laser_angle_max must be given together, got 0.0 and None"),
        (
            {"laser_angle_min": 1.0, "laser_angle_max": 1.0},
            "laser_angle_max must exceed laser_angle_min by at most 2π, got 1.0",
        ),
        ({"laser_angle_min": -4.0, "laser_angle_max": 4.0}, "laser_angle_max must exceed laser_angle_min by at most 2π"),
        ({"laser_angle_min": -7.0, "laser_angle_max": 0.0}, "laser_angle_min must be greater than or equal to -6.28"),
    ],
)
def test_angles_of_beams_that_do_not_fit_are_refused(values: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError) as caught:
        LaserParameters.checked(values)
    assert words in str(caught.value)


@pytest.mark.parametrize("turn", [6.28319, 6.2832, 2 * 3.1416, 2 * 3.14159])
def test_what_drivers_state_for_a_full_turn_is_accepted(turn: float) -> None:
    for values in ({"laser_fov": turn}, {"laser_angle_min": -turn / 2, "laser_angle_max": turn / 2}):
        scanner = LaserParameters.checked({**values, "laser_beam_count": 360}).scanner()
        assert scanner.angle_increment == pytest.approx(turn / 360, rel=1e-12)


def test_weights_must_not_all_be_zero() -> None:
    with pytest.raises(ValueError, match="at least one of z_hit, z_short, z_max, z_rand must be positive"):
        LaserParameters.checked({"z_hit": 0.0, "z_max": 0.0})


def test_parameters_build_the_noise_model_and_the_scanner() -> None:
    laser = LaserParameters(sigma_hit=0.1, z_hit=3.0, z_max=1.0, laser_mount=(0.1, 0.0, 0.0), laser_frame_id="laser")
    assert repr(laser.beam_model) == repr(mrs.BeamModel(sigma_hit=0.1, lambda_short=2.0, z_hit=0.75, z_max=0.25))
    assert laser.scanner().mount == mrs.Pose(0.1)
    assert laser.scanner(mrs.Pose(0.2)).mount == mrs.Pose(0.2)
    assert LaserParameters().scanner().mount == mrs.Pose()


def test_the_surface_model_is_none_unless_it_changes_something() -> None:
    parameters = LaserParameters
    assert parameters().surface_model is None
    assert parameters(incidence_limit=1.0).surface_model is None
    values = {
        "incidence_sigma": 0.5,
        "incidence_bias": 0.03,
        "correlation": 0.4,
        "reference_range": 20.0,
        "beam_divergence": 0.01,
    }
    for name, value in values.items():
        assert repr(parameters(**{name: value}).surface_model) == repr(mrs.SurfaceModel(**{name: value}))
    values |= {"incidence_limit": 1.2, "edge_depth": 0.2, "mixing_length": 0.3}
    assert parameters(edge_depth=0.2, mixing_length=0.3).surface_model is None
    assert repr(parameters(**values).surface_model) == repr(mrs.SurfaceModel(**values))
    by_range = {"range_offset": 0.1, "range_sigma_base": 0.01, "range_sigma_per_metre": 0.02, "range_step": 0.001}
    assert repr(parameters(**by_range, range_step_share=0.01).beam_model) == repr(
        mrs.BeamModel(**by_range, range_step_share=0.01)
    )
