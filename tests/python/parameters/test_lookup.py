"""lookup: which names are known."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.parameters import LaserParameters, RobotParameters, check_names, for_node


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


def test_a_name_that_is_no_text_is_unknown() -> None:
    with pytest.raises(ValueError, match=r"^unknown parameter 3; known parameters: acceleration_limits"):
        check_names([3])  # type: ignore[list-item]


def test_a_key_with_a_node_counts_for_that_node_only_and_comes_first() -> None:
    values = {"odometry_topic": "shared", "laser_scanner_simulator_node:odometry_topic": "own", "publish_rate": 5.0}
    check_names(values)
    robot, laser = for_node(RobotParameters, values), for_node(LaserParameters, values)
    assert (robot.odometry_topic, robot.publish_rate, laser.odometry_topic) == ("shared", 5.0, "own")
    with pytest.raises(ValueError, match=r"^unknown node 'laser'; did you mean"):
        check_names(["laser:odometry_topic"])
    with pytest.raises(ValueError, match=r"^unknown parameter 'publish_rate'"):
        check_names(["laser_scanner_simulator_node:publish_rate"])
