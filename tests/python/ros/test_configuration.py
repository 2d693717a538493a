"""Configuration: which nodes run, and how they get and change their parameters."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.nodes import LaserScannerSimulator, MobileRobotSimulator
from mobile_robot_simulator.parameters import LaserParameters, MapParameters, RobotParameters
from mobile_robot_simulator.ros.configuration import (
    ParameterResolver,
    change_parameters,
    create_behaviour,
    models_of,
    split_arguments,
    warn_about_unknown,
)
from mobile_robot_simulator.ros.node import RosProcess


class Log:
    """A logger that keeps its messages."""

    def __init__(self) -> None:
        self.infos: list[str] = []
        self.warnings: list[str] = []

    def info(self, message: str) -> None:
        self.infos.append(message)

    def warning(self, message: str) -> None:
        self.warnings.append(message)


def create_node() -> Any:
    grid = mrs.OccupancyGrid(np.zeros((10, 10), np.int8), resolution=1.0)
    return mrs.Simulation(grid).create_node("test")


def resolver(name: str = "all", map_file: str | None = None) -> ParameterResolver:
    return ParameterResolver(name, {RobotParameters: {"clock_rate": 100.0}}, map_file)


def is_ros_argument(argument: str) -> bool:
    return ":=" in argument


def test_all_runs_every_node() -> None:
    assert models_of("all") == [RobotParameters, LaserParameters, MapParameters]
    assert models_of("laser") == [LaserParameters]


@pytest.mark.parametrize(
    ("parameters", "expected"), [(RobotParameters, MobileRobotSimulator), (LaserParameters, LaserScannerSimulator)]
)
def test_the_parameters_choose_the_node(parameters: Any, expected: Any) -> None:
    assert isinstance(create_behaviour(parameters(), create_node(), RosProcess()), expected)


@pytest.mark.parametrize(
    ("name", "arguments", "expected"),
    [
        ("robot", [], (None, [])),
        ("robot", ["_publish_rate:=20"], (None, ["_publish_rate:=20"])),
        ("map", ["map.yaml"], ("map.yaml", [])),
        # Everything after the first ROS argument is for ROS.
        ("all", ["map.yaml", "_seed:=1", "other"], ("map.yaml", ["_seed:=1", "other"])),
    ],
)
def test_arguments_are_split(name: str, arguments: list[str], expected: Any) -> None:
    assert split_arguments(name, arguments, is_ros_argument) == expected


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("laser", ["map.yaml"], "unexpected argument 'map.yaml'; laser takes ROS arguments only"),
        ("map", ["map.yaml", "more"], "unexpected argument 'more'; map takes a map file and ROS arguments"),
    ],
)
def test_unexpected_arguments_are_refused(name: str, arguments: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        split_arguments(name, arguments, is_ros_argument)


def test_given_values_override_the_defaults_of_ros() -> None:
    assert resolver().resolve(RobotParameters, {}, Log()) == RobotParameters(clock_rate=100.0)
    given = {"clock_rate": 20.0, "laser_fov": 1.0}
    assert resolver().resolve(RobotParameters, given, Log()) == RobotParameters(clock_rate=20.0)


def test_names_of_nav2_loopback_sim_are_logged_once_and_our_names_win() -> None:
    log, all_nodes = Log(), resolver()
    given = {"base_frame_id": "theirs", "base_link_frame": "ours"}
    for model in (RobotParameters, LaserParameters):
        parameters: Any = all_nodes.resolve(model, given, log)
        assert parameters.base_link_frame == "ours"
    assert log.infos == ["base_frame_id (a parameter of nav2_loopback_sim) sets base_link_frame = theirs"]


def test_a_map_server_needs_a_map_unless_all_nodes_run() -> None:
    assert resolver("all").resolve(MapParameters, {}, Log()) is None
    with pytest.raises(ValueError, match="map needs a map file"):
        resolver("map").resolve(MapParameters, {}, Log())


def test_the_map_file_of_the_command_line_wins() -> None:
    parameters: Any = resolver("map", "a.yaml").resolve(MapParameters, {"yaml_filename": "b.yaml"}, Log())
    assert parameters.yaml_filename == "a.yaml"


def test_unknown_names_are_warned_about() -> None:
    log = Log()
    warn_about_unknown(["publish_rate", "base_frame_id", "laser_beam_cuont"], log)
    assert log.warnings == ["unknown parameter 'laser_beam_cuont'; did you mean 'laser_beam_count'?"]


def test_parameters_change_or_the_reason_is_returned() -> None:
    laser = create_behaviour(LaserParameters(), create_node(), RosProcess())
    assert change_parameters(laser, {"laser_beam_count": 91, "publish_rate": -1.0}) is None
    assert laser.parameters.laser_beam_count == 91
    refusal = change_parameters(laser, {"seed": 5, "laser_beam_count": 0})
    assert refusal == "laser_beam_count must be greater than or equal to 1, got 0"
    assert (laser.parameters.seed, laser.parameters.laser_beam_count) == (0, 91)


def test_some_parameters_can_only_be_set_at_startup() -> None:
    robot = create_behaviour(RobotParameters(publish_clock=False), create_node(), RosProcess())
    assert change_parameters(robot, {"publish_clock": False}) is None
    assert change_parameters(robot, {"publish_clock": True}) == "publish_clock can only be set at startup and stays False"
    refusal = change_parameters(robot, {"update_duration": 0.1})
    assert refusal == (
        "update_duration (a parameter of nav2_loopback_sim) can only be set at startup; set publish_rate instead"
    )


def test_the_robot_of_a_process_moves_in_its_world() -> None:
    process, node = RosProcess(), create_node()
    robot: Any = create_behaviour(RobotParameters(robot_radius=0.3), node, process)
    assert robot in [body for body, _ in process.world_for(node).everybody()]
