"""parameters: names, defaults, checks, and the objects built from them."""

from __future__ import annotations

import math
import pickle
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.parameters import (
    LaserParameters,
    MapParameters,
    Parameters,
    RobotParameters,
    check_names,
    motion_noise,
)

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


@pytest.mark.parametrize(
    ("model", "name", "default"),
    [(RobotParameters, *item) for item in ROBOT.items()] + [(LaserParameters, *item) for item in LASER.items()],
)
def test_names_and_defaults(model: type[Parameters], name: str, default: object) -> None:
    value = getattr(model(), name)
    assert value == default
    assert type(value) is type(default)
    assert model.model_fields[name].description


def test_the_seed_is_an_integer() -> None:
    assert isinstance(LaserParameters().seed, int)


def test_node_names_are_those_of_the_original() -> None:
    assert RobotParameters.node_name == "mobile_robot_simulator_node"
    assert LaserParameters.node_name == "laser_scanner_simulator_node"


# A laser_mount requires a frame other than the robot's.
FRAME: dict[type[Parameters], dict[str, str]] = {RobotParameters: {}, LaserParameters: {"laser_frame_id": "laser"}}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("publish_rate", 1e-3),
        ("publish_rate", 1000),
        ("velocity_timeout", 0),
        ("laser_fov", 2.0 * math.pi),
        ("laser_beam_count", 1),
        ("laser_min_range", 0.0),
        ("laser_beam_count", np.int64(181)),
        ("laser_max_range", np.float32(12.0)),
        ("seed", 2**64 - 1),
        ("z_hit", 17),
        ("laser_mount", [0.1, 0, -0.5]),
        ("laser_mount", [0.1, 0, 0.3, 3.14, 0, -0.5]),
        ("laser_mount", None),
        ("sigma_hit", "0.05e0"),
    ],
)
def test_valid_values_are_accepted(name: str, value: Any) -> None:
    model = RobotParameters if name in RobotParameters.model_fields else LaserParameters
    found = getattr(model.checked({**FRAME[model], name: value}), name)
    assert found == (tuple(value) if isinstance(value, list) else 0.05 if value == "0.05e0" else value)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("publish_rate", 0.0, "publish_rate must be greater than 0, got 0.0"),
        ("publish_rate", -1, "publish_rate must be greater than 0, got -1"),
        ("publish_rate", math.nan, "publish_rate must be a finite number, got nan"),
        ("publish_rate", math.inf, "publish_rate must be"),
        ("publish_rate", "fast", "publish_rate must be a valid number"),
        ("publish_rate", True, "publish_rate must be a number, got True"),
        ("publish_rate", None, "publish_rate must be a valid number, got None"),
        ("publish_rate", [10.0], "publish_rate must be a valid number, got [10.0]"),
        ("speed_factor", 0.0, "speed_factor must be greater than 0"),
        ("velocity_timeout", -0.1, "velocity_timeout must be greater than or equal to 0, got -0.1"),
        ("velocity_topic", 5, "velocity_topic must be a valid string, got 5"),
        ("velocity_topic", "", "velocity_topic must be a name such as /scan, got ''"),
        ("base_link_frame", "", "base_link_frame must have at least 1 character, got ''"),
        ("footprint", [[0, 0], [1, 1]], "footprint must be the corners [[x, y], ...] of a polygon"),
        ("publish_map_transform", "maybe", "publish_map_transform must be a valid boolean"),
        ("publish_map_transform", 7, "publish_map_transform must be a valid boolean"),
        ("laser_fov", 0.0, "laser_fov must be greater than 0, got 0.0"),
        ("laser_fov", 6.3, "laser_fov must be less than or equal to 6.28"),
        ("laser_beam_count", 0, "laser_beam_count must be greater than or equal to 1, got 0"),
        ("laser_beam_count", 541.5, "laser_beam_count must be a valid integer"),
        ("laser_beam_count", 10**9, "laser_beam_count must be less than or equal to 1000000, got 1000000000"),
        ("laser_max_range", 0.05, "laser_min_range must be less than laser_max_range 0.05, got 0.05"),
        ("laser_max_range", -1.0, "laser_max_range must be greater than 0, got -1.0"),
        ("laser_min_range", 30.0, "laser_min_range must be less than laser_max_range 30.0, got 30.0"),
        ("laser_min_range", -0.1, "laser_min_range must be greater than or equal to 0, got -0.1"),
        ("laser_frequency", 0.0, "laser_frequency must be greater than 0, got 0.0"),
        ("sigma_hit", 0.0, "sigma_hit must be greater than 0, got 0.0"),
        ("lambda_short", -2.0, "lambda_short must be greater than 0, got -2.0"),
        ("z_rand", -0.1, "z_rand must be greater than or equal to 0, got -0.1"),
        ("no_return", "nan", "no_return must be 'inf', 'max' or 'below_max', got 'nan'"),
        ("unknown", "maybe", "unknown must be 'free' or 'occupied', got 'maybe'"),
        ("seed", -1, "seed must be"),
        ("seed", 2**64, f"got {2**64}"),
        ("seed", 1.5, "seed must be a valid integer"),
        ("laser_mount", [0.0, 0.0], "laser_mount"),
        ("laser_mount", [0.0, 0.0, math.nan], "laser_mount"),
    ],
)
def test_errors_name_the_parameter_the_requirement_and_the_value(name: str, value: Any, words: str) -> None:
    model = RobotParameters if name in RobotParameters.model_fields else LaserParameters
    with pytest.raises(ValueError) as caught:
        model.checked({name: value})
    assert words in str(caught.value)


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


def test_one_error_reports_all_invalid_values() -> None:
    with pytest.raises(ValueError) as caught:
        LaserParameters.checked({"laser_fov": -1.0, "sigma_hit": 0.0})
    assert "laser_fov" in str(caught.value) and "sigma_hit" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("laser_beams_count", "laser_beam_count"),
        ("laser_frequence", "laser_frequency"),
        ("publish_rat", "publish_rate"),
        ("sigma", "sigma_hit"),
    ],
)
def test_errors_suggest_the_nearest_known_name(name: str, near: str) -> None:
    with pytest.raises(ValueError, match=f"unknown parameter '{name}'; did you mean '{near}'"):
        check_names([name])


def test_changed_checks_the_values_and_returns_a_copy() -> None:
    old = LaserParameters()
    assert old.changed({"laser_fov": 1.0}).laser_fov == 1.0
    assert old.laser_fov == 4.71
    for bad in ({"laser_fov": -1.0}, {"laser_min_range": 99.0}, {"laser_fow": 1.0}):
        with pytest.raises(ValueError, match="laser_"):
            old.changed(bad)


def test_a_missing_value_is_reported_as_required() -> None:
    with pytest.raises(ValueError, match=r"^yaml_filename is required$"):
        MapParameters.checked({})


def test_parameters_build_the_noise_models_and_the_scanner() -> None:
    alphas = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    numbered = {"alpha1": 0.1, "alpha2": 0.2, "alpha3": 0.3, "alpha4": 0.4, "alpha5": 0.5, "alpha6": 0.6}
    noise = mrs.MotionNoise(**numbered, reference_step=0.1)
    assert motion_noise(alphas) == RobotParameters(odometry_alphas=alphas).motion_noise == noise
    assert RobotParameters().motion_noise is None
    laser = LaserParameters(sigma_hit=0.1, z_hit=3.0, z_max=1.0, laser_mount=(0.1, 0.0, 0.0), laser_frame_id="laser")
    assert repr(laser.beam_model) == repr(mrs.BeamModel(sigma_hit=0.1, lambda_short=2.0, z_hit=0.75, z_max=0.25))
    assert laser.scanner().mount == mrs.Pose(0.1)
    assert laser.scanner(mrs.Pose(0.2)).mount == mrs.Pose(0.2)
    assert LaserParameters().scanner().mount == mrs.Pose()


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


def test_an_integer_of_too_many_digits_is_no_valid_integer() -> None:
    with pytest.raises(ValueError, match=r"^seed must be a valid integer, got '999"):
        LaserParameters(seed="9" * 5000)  # type: ignore[arg-type]


def test_a_mount_can_be_an_array() -> None:
    assert LaserParameters(laser_frame_id="laser", laser_mount=np.array([0.1, 0.0, 0.5])).laser_mount == (0.1, 0.0, 0.5)


def test_a_name_that_is_no_text_is_unknown() -> None:
    with pytest.raises(ValueError, match=r"^unknown parameter 3; known parameters: acceleration_limits"):
        check_names([3])  # type: ignore[list-item]


def test_frames_have_the_prefix_and_are_no_values() -> None:
    parameters, unused = (RobotParameters(frame_prefix="one/", base_link_frame="/base") for _ in range(2))
    assert parameters.frames["base_link_frame"] == "one/base"
    assert parameters == unused == pickle.loads(pickle.dumps(parameters))
    assert parameters.model_dump() == unused.model_dump() and repr(parameters) == repr(unused)
    assert parameters.changed({"frame_prefix": ""}).frames["base_link_frame"] == "/base"


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
