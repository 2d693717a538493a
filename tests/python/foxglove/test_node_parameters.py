"""NodeParameters: names as on ROS, values that JSON can carry, changes since the last look."""

from __future__ import annotations

import math

import pytest

from mobile_robot_simulator.foxglove.node_parameters import NodeParameters
from simulations import open_field, pair

ROBOT, LASER = "/mobile_robot_simulator_node", "/laser_scanner_simulator_node"


def test_values_by_name() -> None:
    parameters = NodeParameters(open_field())
    assert parameters.values([f"{ROBOT}.publish_rate", "/nobody.knows", f"{LASER}.laser_beam_count"]) == {
        f"{ROBOT}.publish_rate": 10.0,
        f"{LASER}.laser_beam_count": 61,
    }
    assert set(parameters.values()) > {f"{ROBOT}.initial_pose", f"{LASER}.laser_topic"}


def test_values_that_json_cannot_carry_are_texts_which_can_be_set_again() -> None:
    simulation = open_field(velocity_limits=(1.0, 0.0, math.inf), seed=2**64 - 1)
    parameters = NodeParameters(simulation)
    limits, seed = f"{ROBOT}.velocity_limits", f"{LASER}.seed"
    assert parameters.values([limits]) == {limits: [1.0, 0.0, "inf"]}
    simulation.laser.set_parameters(seed=2**64 - 1)
    assert parameters.values([seed]) == {seed: f"{2**64 - 1}"}
    for name, node in ((limits, simulation.robot), (seed, simulation.laser)):
        before = node.parameters
        parameters.set(name, parameters.values([name])[name])
        assert node.parameters == before


def test_each_robot_and_scanner_has_names_of_its_own() -> None:
    simulation = pair(scanners=("front", "rear"))
    parameters = NodeParameters(simulation)
    parameters.set("/robot2/rear_laser_scanner_simulator_node.laser_beam_count", 7)
    counts = {
        (robot, scanner): laser.parameters.laser_beam_count
        for robot, it in simulation.robots.items()
        for scanner, laser in it.scanners.items()
    }
    assert counts == {("robot1", "front"): 60, ("robot1", "rear"): 60, ("robot2", "front"): 60, ("robot2", "rear"): 7}


def test_what_is_unknown_or_wrong_is_refused() -> None:
    simulation = open_field()
    parameters = NodeParameters(simulation)
    with pytest.raises(ValueError, match=rf"unknown parameter '{ROBOT}\.publish_rat'; did you mean {ROBOT}\.publish_rate\?"):
        parameters.set(f"{ROBOT}.publish_rat", 5)
    with pytest.raises(ValueError, match="publish_rate"):
        parameters.set(f"{ROBOT}.publish_rate", -5)
    assert simulation.robot.parameters.publish_rate == 10.0


def test_changes_since_the_last_look() -> None:
    simulation = open_field()
    parameters = NodeParameters(simulation)
    assert parameters.changed() == {}
    simulation.robot.set_parameters(publish_rate=20.0)
    simulation.laser.set_parameters(laser_beam_count=5)
    assert parameters.changed() == {f"{ROBOT}.publish_rate": 20.0, f"{LASER}.laser_beam_count": 5}
    assert parameters.changed() == {}
