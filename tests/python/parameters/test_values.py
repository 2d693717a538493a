"""values: the types of values take what is valid, and their errors say what is needed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from mobile_robot_simulator.parameters import LaserParameters, RobotParameters


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
        ("sigma_hit", "0.05e0"),
    ],
)
def test_valid_values_are_accepted(name: str, value: Any) -> None:
    model = RobotParameters if name in RobotParameters.model_fields else LaserParameters
    found = getattr(model.checked({name: value}), name)
    assert found == (0.05 if value == "0.05e0" else value)


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
        ("publish_map_transform", "maybe", "publish_map_transform must be a valid boolean"),
        ("publish_map_transform", 7, "publish_map_transform must be a valid boolean"),
        ("laser_fov", 0.0, "laser_fov must be greater than 0, got 0.0"),
        ("laser_beam_count", 0, "laser_beam_count must be greater than or equal to 1, got 0"),
        ("laser_beam_count", 541.5, "laser_beam_count must be a valid integer"),
        ("laser_beam_count", 10**9, "laser_beam_count must be less than or equal to 1000000, got 1000000000"),
        ("laser_max_range", -1.0, "laser_max_range must be greater than 0, got -1.0"),
        ("laser_min_range", -0.1, "laser_min_range must be greater than or equal to 0, got -0.1"),
        ("laser_frequency", 0.0, "laser_frequency must be greater than 0, got 0.0"),
        ("sigma_hit", 0.0, "sigma_hit must be greater than 0, got 0.0"),
        ("lambda_short", -2.0, "lambda_short must be greater than 0, got -2.0"),
        ("z_rand", -0.1, "z_rand must be greater than or equal to 0, got -0.1"),
        ("seed", -1, "seed must be"),
        ("seed", 2**64, f"got {2**64}"),
        ("seed", 1.5, "seed must be a valid integer"),
    ],
)
def test_errors_name_the_parameter_the_requirement_and_the_value(name: str, value: Any, words: str) -> None:
    model = RobotParameters if name in RobotParameters.model_fields else LaserParameters
    with pytest.raises(ValueError) as caught:
        model.checked({name: value})
    assert words in str(caught.value)


def test_an_integer_of_too_many_digits_is_no_valid_integer() -> None:
    with pytest.raises(ValueError, match=r"^seed must be a valid integer, got '999"):
        LaserParameters(seed="9" * 5000)  # type: ignore[arg-type]


def test_the_seed_is_an_integer() -> None:
    assert isinstance(LaserParameters().seed, int)
