"""Configuration: which nodes run, and how they get and change their parameters."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.nodes import LaserScannerSimulator, MobileRobotSimulator
from mobile_robot_simulator.parameters import LaserParameters, MapParameters, RobotParameters, WorldParameters
from mobile_robot_simulator.ros.configuration import (
    Fleet,
    ParameterResolver,
    change_everywhere,
    change_parameters,
    check_options_follow,
    create_behaviour,
    models_of,
    split_arguments,
    warn_about_scanners,
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


def absolute(name: str) -> str:
    return f"/outside/{name}"


def test_all_runs_every_node() -> None:
    assert models_of("all") == [RobotParameters, LaserParameters, MapParameters, WorldParameters]
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
    assert split_arguments(name, arguments, is_ros_argument, "_NAME:=VALUE") == expected


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("laser", ["map.yaml"], "unexpected argument 'map.yaml'; laser takes ROS arguments only (_NAME:=VALUE)"),
        ("all", ["-p", "seed:=1"], "unexpected argument '-p'; all takes a map file and ROS arguments (_NAME:=VALUE)"),
        ("robot", ["--params-file", "a.yaml"], "unexpected argument '--params-file'"),
        ("map", ["map.yaml", "more"], "unexpected argument 'more'; map takes a map file and ROS arguments"),
    ],
)
def test_unexpected_arguments_are_refused(name: str, arguments: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        split_arguments(name, arguments, is_ros_argument, "_NAME:=VALUE")


def test_an_option_of_ros_before_its_marker_is_refused() -> None:
    for arguments in ([], ["map.yaml"], ["--ros-args", "-p", "x:=1"], ["map.yaml", "--ros-args", "-r", "a:=b"], ["--other"]):
        check_options_follow("--ros-args", ["-p", "-r"], arguments)
    for arguments in (["-p", "x:=1"], ["map.yaml", "-p", "x:=1", "--ros-args", "-r", "a:=b"]):
        with pytest.raises(ValueError, match=r"^-p needs --ros-args before it$"):
            check_options_follow("--ros-args", ["-p", "-r"], arguments)


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
    fleet = Fleet({"robots": ["robot1"]})
    warn_about_unknown(
        ["publish_rate", "base_frame_id", "laser_beam_cuont", "robot1.seed", "robot1.robot_radios"], log, fleet
    )
    assert log.warnings == [
        "unknown parameter 'laser_beam_cuont'; did you mean 'laser_beam_count'?",
        "unknown parameter 'robot_radios'; did you mean 'robot_radius'?",
    ]


def test_each_unknown_name_is_warned_about_once() -> None:
    log, fleet = Log(), Fleet({"robots": ["robot1", "robot2"]})
    for names in (["sede"], ["sede", "robot1.sede"], ["robot2.sede"]):
        warn_about_unknown(names, log, fleet)
    assert len(log.warnings) == 1


def test_one_robot_gets_what_is_given() -> None:
    fleet, given = Fleet({}), {"seed": 3, "robot1.seed": 4}
    assert fleet.owners_of(RobotParameters) == fleet.owners_of(MapParameters) == [("", "")]
    assert fleet.given_to("", given, absolute) == given


def test_each_robot_of_a_fleet_gets_parameters_of_its_own() -> None:
    given = {
        "robots": ["robot1", "robot2"],
        "initial_pose": [1.0, 0.0, 0.0],
        "robot2.initial_pose": [2.0, 0.0, 0.0],
        "robot2.robot_radius": 0.5,
        "map_topic": "floor",
    }
    fleet = Fleet(given)
    assert fleet.owners_of(RobotParameters) == fleet.owners_of(LaserParameters) == [("robot1", ""), ("robot2", "")]
    assert fleet.owners_of(MapParameters) == [("", "")]
    first, second = (fleet.given_to(name, given, absolute) for name in ("robot1", "robot2"))
    assert (first["initial_pose"], second["initial_pose"]) == ([1.0, 0.0, 0.0], [2.0, 0.0, 0.0])
    assert (first["robot_radius"], second["robot_radius"]) == (0.2, 0.5)
    assert (first["frame_prefix"], second["frame_prefix"]) == ("robot1/", "robot2/")
    assert first["map_topic"] == second["map_topic"] == "/outside/floor"
    assert first["map_service"] == "/outside/static_map"
    assert "publish_clock" not in first and second["publish_clock"] is False
    assert first["seed"] != second["seed"]
    assert "robot2.initial_pose" not in first and "robot2.initial_pose" not in fleet.given_to("", given, absolute)


@pytest.mark.parametrize("robots", [["robot 1"], ["1"], [""], "robot1", [3], ["a", "a"], 3])
def test_names_of_robots_are_checked(robots: Any) -> None:
    with pytest.raises(ValueError, match="robots must be a list of"):
        Fleet({"robots": robots})


def test_each_scanner_of_a_robot_gets_parameters_of_its_own() -> None:
    given = {"robots": ["a", "b"], "scanners": ["front", "rear"], "b.scanners": [], "laser_fov": 2.0, "front.laser_fov": 1.0}
    given |= {"b.laser_fov": 3.0, "a.rear.laser_fov": 4.0, "seed": 1}
    fleet = Fleet(given)
    for robot in "ab":
        fleet.add(robot, resolver().resolve(RobotParameters, fleet.given_to(robot, given, absolute), Log()))  # type: ignore
    assert fleet.owners_of(RobotParameters) == [("a", ""), ("b", "")]
    assert fleet.owners_of(LaserParameters) == [("a", "front"), ("a", "rear"), ("b", "")]
    assert fleet.owners_of(WorldParameters) == [("", "")]
    front, rear, only = (
        LaserParameters.checked({name: value for name, value in values.items() if name in LaserParameters.model_fields})
        for values in (
            fleet.given_to(robot, given, absolute, scanner) for robot, scanner in fleet.owners_of(LaserParameters)
        )
    )
    assert (front.laser_topic, front.laser_frame_id, front.frame_prefix) == ("front/scan", "front_laser", "a/")
    assert (only.laser_topic, only.laser_frame_id, only.frame_prefix) == ("scan", "base_link", "b/")
    assert (front.laser_fov, rear.laser_fov, only.laser_fov) == (1.0, 4.0, 3.0)
    assert len({front.seed, rear.seed, only.seed, 1}) == 4


def test_parameters_of_scanners_that_no_robot_has_are_warned_about_once() -> None:
    fleet, log = Fleet({}), Log()
    fleet.add("", RobotParameters(scanners=("front",)))
    for _ in range(2):
        warn_about_unknown(["front.laser_fov", "frnt.laser_fov", "front.laser_fow"], log, fleet)
        warn_about_scanners(["front.laser_fov", "frnt.laser_fov"], log, fleet)
    unknown, without_effect = log.warnings
    assert "unknown parameter 'front.laser_fow'" in unknown
    assert without_effect == "frnt.laser_fov has no effect, because no robot has a scanner frnt: name it in scanners"


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


def test_an_assignment_before_the_arguments_of_ros_2_is_not_a_map_file() -> None:
    with pytest.raises(ValueError, match=r"unexpected argument 'seed:=1'; all takes .* \(--ros-args"):
        split_arguments("all", ["seed:=1"], lambda argument: argument == "--ros-args", "--ros-args -p NAME:=VALUE")


def nodes_of(**parameters: Any) -> tuple[Any, Any]:
    process, node = RosProcess(), create_node()
    robot = create_behaviour(RobotParameters(), node, process)
    return robot, create_behaviour(LaserParameters.checked(parameters), node, process)


def test_a_change_applies_to_all_nodes_or_to_none() -> None:
    robot, laser = nodes_of(laser_frame_id="scanner", laser_mount=(0.1, 0.0, 0.0))
    assert change_everywhere([robot, laser], "base_link_frame", lambda _: "shell") is None
    assert (robot.parameters.base_link_frame, laser.parameters.base_link_frame) == ("shell", "shell")
    # The robot would accept this.
    refusal = change_everywhere([robot, laser], "base_link_frame", lambda _: "scanner")
    assert refusal is not None and "laser_mount needs a laser_frame_id other than base_link_frame" in refusal
    assert (robot.parameters.base_link_frame, laser.parameters.base_link_frame) == ("shell", "shell")


def test_a_refusal_is_returned_once_for_all_nodes() -> None:
    refusal = change_everywhere(nodes_of(), "update_duration", lambda _: 0.1)
    assert refusal is not None and refusal.startswith("update_duration (a parameter of nav2_loopback_sim) can only be set")
    assert change_everywhere(nodes_of(), "no_parameter", lambda _: 0.1) is None


def test_a_deleted_parameter_gets_the_default_of_ros_or_of_the_node() -> None:
    defaults = resolver().defaults_of
    assert (defaults(RobotParameters)["clock_rate"], defaults(LaserParameters)["laser_fov"]) == (100.0, 4.71)
    robot, laser = nodes_of(laser_fov=1.0)
    assert change_everywhere([robot, laser], "laser_fov", lambda model: defaults(model)["laser_fov"]) is None
    assert laser.parameters.laser_fov == 4.71


def test_a_parameter_without_a_default_cannot_be_deleted(tmp_path: Path) -> None:
    mrs.save_map(mrs.OccupancyGrid(np.zeros((5, 5), np.int8), resolution=1.0), tmp_path / "map.yaml")
    parameters = MapParameters(yaml_filename=str(tmp_path / "map.yaml"))
    server = create_behaviour(parameters, create_node(), RosProcess())
    defaults = resolver().defaults_of
    refusal = change_everywhere([server], "yaml_filename", lambda model: defaults(model)["yaml_filename"])
    assert refusal == f"yaml_filename has no default and stays {tmp_path / 'map.yaml'}"


@pytest.mark.parametrize("name", ["speed_factor", "unknown", "faults"])
def test_what_robots_share_cannot_differ_between_them(name: str) -> None:
    given = {"robots": ["robot1"], f"robot1.{name}": 2.0}
    with pytest.raises(ValueError, match=f"{name} must be the same for all robots: set {name}, not robot1.{name}"):
        Fleet(given).given_to("robot1", given, absolute)


def test_a_change_without_effect_is_refused() -> None:
    fleet = Fleet({"robots": ["robot1"]})
    with pytest.raises(ValueError, match=r"robot1\.seed can only be set at startup; set seed on the nodes of robot1"):
        fleet.check_change("robot1.seed", "robot1", LaserParameters.model_fields)
    with pytest.raises(ValueError, match="robots can only be set at startup"):
        fleet.check_change("robots", "robot1", LaserParameters.model_fields)
    fleet.check_change("seed", "robot1", LaserParameters.model_fields)
