"""Namespaces: topics, frames, seeds and outlines of a robot with a name."""

from __future__ import annotations

from mobile_robot_simulator.namespaces import RADIUS, SHARED, TOPICS, of_namespace
from mobile_robot_simulator.parameters import LaserParameters, RobotParameters, for_node


def test_a_robot_without_a_name_keeps_its_parameters():
    values = {"seed": 3, "laser_topic": "scan"}
    assert of_namespace("", values) == values


def test_topics_and_frames_are_prefixed_whether_they_are_given_or_not():
    values = of_namespace("one", {"laser_topic": "/front/scan", "base_link_frame": "/base"})
    robot, laser = for_node(RobotParameters, values), for_node(LaserParameters, values)
    assert (laser.laser_topic, robot.velocity_topic, robot.odometry_topic) == (
        "/one/front/scan",
        f"/one/{RobotParameters().velocity_topic.lstrip('/')}",
        f"/one/{RobotParameters().odometry_topic.lstrip('/')}",
    )
    assert (robot.frames["base_link_frame"], robot.frames["odom_frame_id"]) == ("one/base", "one/odom")


def test_seeds_depend_on_the_given_seed_and_the_name_only():
    seeds = {of_namespace(name, {"seed": seed, "robot_radius": 1.0})["seed"] for name in ("one", "two") for seed in (1, 2)}
    assert len(seeds) == 4
    assert of_namespace("one", {"seed": 1})["seed"] in seeds


def test_a_robot_gets_an_outline_unless_it_has_one():
    assert of_namespace("one", {})["robot_radius"] == RADIUS
    assert of_namespace("one", {"robot_radius": 0.0})["robot_radius"] == 0.0
    assert "robot_radius" not in of_namespace("one", {"footprint": [[0, 0], [1, 0], [0, 1]]})


def test_every_topic_is_either_a_robots_own_or_shared():
    names = {name for model in (RobotParameters, LaserParameters) for name in model.model_fields}
    assert {name for name in names if name.endswith(("_topic", "_service"))} == {*TOPICS, *SHARED}
