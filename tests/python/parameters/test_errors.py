"""errors: one message about all that is wrong."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.parameters import LaserParameters, unknown_name


def test_one_error_reports_all_invalid_values() -> None:
    with pytest.raises(ValueError) as caught:
        LaserParameters.checked({"laser_fov": -1.0, "sigma_hit": 0.0})
    assert "laser_fov" in str(caught.value) and "sigma_hit" in str(caught.value)


def test_an_error_of_no_single_parameter_is_not_prefixed() -> None:
    with pytest.raises(ValueError, match=r"^laser_min_range must be less than laser_max_range 1\.0, got 2\.0$"):
        LaserParameters.checked({"laser_min_range": 2.0, "laser_max_range": 1.0})


def test_an_unknown_name_is_answered_with_the_nearest_one_or_with_all() -> None:
    assert unknown_name("scan_topc", ["scan_topic", "map"]) == "unknown parameter 'scan_topc'; did you mean 'scan_topic'?"
    assert unknown_name("zzz", ["scan", "tf"], kind="topic") == "unknown topic 'zzz'; known topics: scan, tf"
