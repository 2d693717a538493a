"""Parameters of nav2_loopback_sim keep their meaning when they are translated to ours."""

from __future__ import annotations

import math
from typing import Any

import pytest

from mobile_robot_simulator.nav2_loopback_names import SYNONYMS, translate
from mobile_robot_simulator.parameters import NODES


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"update_duration": 0.02}, {"publish_rate": 50.0}),
        ({"update_duration": 0.02, "odom_publish_dur": 0.1}, {"publish_rate": 50.0}),
        ({"scan_use_inf": False}, {"no_return": "below_max"}),
        ({"scan_noise_std": 0.0}, {"apply_noise": False}),
        ({"scan_noise_std": 0.02}, {"sigma_hit": 0.02}),
        (
            {"scan_angle_increment": 0.02617},
            {"laser_angle_min": -math.pi, "laser_angle_max": math.pi, "laser_beam_count": 240},
        ),
        (
            {"scan_angle_min": -1.0, "scan_angle_max": 1.0, "scan_angle_increment": 0.1},
            {"laser_angle_min": -1.0, "laser_angle_max": 1.0, "laser_beam_count": 21},
        ),
        (
            {"scan_angle_min": -0.5, "scan_angle_max": 1.0, "scan_angle_increment": 0.1},
            {"laser_angle_min": -0.5, "laser_angle_max": 1.0, "laser_beam_count": 16},
        ),
    ],
)
def test_values_are_translated(given: dict[str, Any], expected: dict[str, Any]) -> None:
    meanings = translate(given)
    assert set(meanings) == set(given)
    for meaning in meanings.values():
        assert meaning == expected


@pytest.mark.parametrize("given", [{"update_duration": 0.0}, {"scan_publish_dur": "fast"}, {"scan_angle_min": 4.0}])
def test_values_without_a_translation_are_refused(given: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(given))):
        translate(given)


def test_no_name_of_nav2_loopback_sim_is_also_one_of_ours() -> None:
    assert not {name for model in NODES for name in model.model_fields} & set(SYNONYMS)
