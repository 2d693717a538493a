"""Parameter fields: units, limits and choices."""

import pytest

from mobile_robot_simulator.live.parameter_fields import fields_of
from mobile_robot_simulator.parameters import LaserParameters, RobotParameters

FIELDS = {field["name"]: field for model in (RobotParameters, LaserParameters) for field in fields_of(model)}


@pytest.mark.parametrize(
    ("name", "unit", "limits"),
    [
        ("laser_frequency", "Hz", "above 0, at most 1,000,000"),
        ("laser_fov", "rad", "above 0, at most 2π"),
        ("laser_angle_min", "rad", "-2π to 2π"),
        ("laser_beam_count", "", "1 to 1,000,000"),
        ("wheel_slip", "", "0 to 1"),
        ("velocity_timeout", "s", "at least 0"),
        ("lambda_short", "1/m", "above 0"),
        ("initial_pose", "m, m, rad", "3 numbers"),
        ("velocity_limits", "m/s, m/s, rad/s", "3 numbers, each at least 0"),
        ("acceleration_limits", "m/s^2, m/s^2, rad/s^2", "3 numbers, each at least 0"),
        ("odometry_alphas", "", "6 numbers, each at least 0"),
        ("frame_prefix", "", ""),
    ],
)
def test_a_field_has_its_unit_and_limits(name, unit, limits):
    assert (FIELDS[name]["unit"], FIELDS[name]["limits"]) == (unit, limits)


def test_choices_are_listed():
    assert FIELDS["contact"]["choices"] == ["stop", "slide", "report"]
    assert FIELDS["apply_noise"]["choices"] == ["true", "false"]
    assert FIELDS["sigma_hit"]["choices"] is None


def test_what_is_seldom_changed_is_marked():
    seldom = {name for name, field in FIELDS.items() if field["is_seldom"]}
    assert {"laser_topic", "odom_frame_id", "map_service", "contact_topic", "scanners"} <= seldom
    assert not seldom & {"contact", "footprint", "robot_radius", "unknown", "laser_frequency"}


def test_every_parameter_is_a_field_with_its_description():
    for model in (RobotParameters, LaserParameters):
        assert [field["name"] for field in fields_of(model)] == list(model.model_fields)
        assert all(field["help"] for field in fields_of(model))
