"""Robots of a simulation: start poses, names, namespaces, and how they see each other and collide."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.messages import Clock
from simulations import SEED, drive, hall, pair, small_room


@pytest.fixture
def sim() -> mrs.Simulation:
    return small_room()


def test_set_pose_and_reset(sim):
    drive(sim)
    sim.run_for(1.0)
    sim.set_pose((3.0, 3.0, 1.0))
    assert tuple(sim.pose) == pytest.approx((3.0, 3.0, 1.0))
    with pytest.raises(ValueError, match="inside a wall"):
        sim.set_pose((1.0, 0.05, 0.0))
    sim.reset()
    assert tuple(sim.pose) == (1.0, 1.0, 0.0)
    assert sim.truth.distance == 0.0 and sim.truth.velocity == (0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="unknown robot 'x'"):
        sim.set_pose((3.0, 3.0, 1.0), "x")


def test_a_robot_must_not_start_in_an_obstacle():
    sim = mrs.Simulation(hall(5.0), robots={"one": (1, 1, 0)})
    sim.add_obstacle(mrs.Shape.disc(0.2), [(0.0, 3.0, 3.0, 0.0), (1.0, 4.0, 3.0, 0.0)], "cat")
    with pytest.raises(ValueError, match="beside obstacle cat"):
        sim.add_robot("two", start=(3.3, 3.0, 0.0))
    sim.run_for(1.0)
    sim.add_robot("two", start=(3.3, 3.0, 0.0))


def test_each_robot_has_its_own_topics_frames_and_services():
    sim = pair()
    sim.run_for(0.2)
    scan, odometry = sim.latest("/robot2/scan"), sim.latest("/robot2/odom")
    assert scan.header.frame_id == "robot2/base_link"
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("robot2/odom", "robot2/base_link")
    links = {(transform.header.frame_id, transform.child_frame_id) for transform in sim.latest("/tf").transforms}
    assert links == {("map", "robot2/odom"), ("robot2/odom", "robot2/base_link")}
    with pytest.raises(ValueError, match="unknown topic '/scan'"):
        sim.latest("/scan")
    clocks = []
    sim.subscribe("/clock", mrs.messages.Clock, clocks.append)
    sim.run_for(1.0)
    assert len(clocks) == 10
    sim.publish(
        "/robot2/initialpose",
        mrs.messages.PoseWithCovarianceStamped(
            pose=mrs.messages.PoseWithCovariance(mrs.messages.Pose.from_planar(mrs.Pose(3, 3, 1)))
        ),
    )
    sim.run_for(0.1)
    assert tuple(sim.robots["robot2"].pose) == pytest.approx((3, 3, 1))
    assert sim.named("robot1").pose.x == 5.0


def test_the_noise_of_a_robot_does_not_depend_on_other_robots():
    both = pair(apply_noise=True)
    alone = mrs.Simulation(
        hall(),
        parameters={"laser_beam_count": 60, "laser_fov": 2 * math.pi, "robot_radius": 0},
        seed=SEED,
        robots={"robot2": (9.0, 10.0, math.pi)},
    )
    for sim in (both, alone):
        sim.run_for(0.3)
    seen, free = both.latest("/robot2/scan").ranges, alone.latest("/robot2/scan").ranges
    assert np.sum(seen != free) < 6
    assert not np.array_equal(both.latest("/robot1/scan").ranges, seen)


def test_names_and_start_poses_of_new_robots_are_checked():
    sim = pair()
    for name in ("robot1", "", "1st", "a b"):
        with pytest.raises(ValueError, match="name"):
            sim.add_robot(name, start=(2, 2, 0))
    with pytest.raises(ValueError, match="room beside walls"):
        sim.add_robot("robot3", start=(0.2, 2.0, 0.0))
    assert sim.add_robot("robot3", start=(3, 3, 0), parameters={"robot_radius": 0.4}).robot.parameters.robot_radius == 0.4


@pytest.mark.parametrize("topic", ["odom", "scan"])
def test_a_robot_whose_topic_has_another_type_is_not_added(topic: str) -> None:
    with_failure, without = pair(robot_radius=0.3), pair(robot_radius=0.3)
    with_failure.create_node("other").create_publisher(Clock, f"/robot3/{topic}", 1)
    with pytest.raises(TypeError, match=f"/robot3/{topic}"):
        with_failure.add_robot("robot3", start=(7.0, 10.0, 0.0))
    assert list(with_failure.robots) == ["robot1", "robot2"]
    sent = []
    for sim in (with_failure, without):
        drive(sim, 1.0, topic="/robot1/cmd_vel")
        sim.run_for(4.0)
        sent.append((sim.latest("/robot1/scan").ranges.tobytes(), sim.robots["robot1"].pose))
    assert sent[0] == sent[1] and with_failure.latest("/robot3/odom") is None
    assert with_failure.add_robot("robot4", start=(7.0, 10.0, 0.0)).scanners, "its place is free"


def test_robots_have_different_seeds_and_are_reset_together():
    sim = pair(apply_noise=True)
    seeds = {robot.laser.parameters.seed for robot in sim.robots.values()}
    seeds |= {robot.robot.parameters.odometry_seed for robot in sim.robots.values()}
    assert len(seeds) >= 2 and SEED not in seeds
    assert len({robot.laser.parameters.seed for robot in sim.robots.values()}) == 2
    for name in sim.robots:
        drive(sim, 0.5, topic=f"/{name}/cmd_vel")
    sim.run_for(1.0)
    sim.reset()
    assert [tuple(robot.pose) for robot in sim.robots.values()] == [(5.0, 10.0, 0.0), (9.0, 10.0, math.pi)]


def test_the_repr_shows_name_and_pose():
    sim = pair()
    assert repr(sim.named("robot1")) == "SimulatedRobot(robot robot1 at (5.00, 10.00, 0.00))"
    assert repr(sim.named("robot2").truth).startswith("GroundTruth(robot 'robot2' at (9.00, 10.00, 3.14), ")


def test_a_simulation_without_robots_says_so(room):
    with pytest.raises(ValueError, match="no robot yet: add one with add_robot"):
        mrs.Simulation(room, robots={}).pose  # noqa: B018


@pytest.mark.parametrize("key", ["unknown", "mobile_robot_simulator_node:unknown", "laser_scanner_simulator_node:unknown"])
def test_all_robots_share_the_treatment_of_unknown_cells(key: str) -> None:
    sim = mrs.Simulation(hall(), robots={"robot1": (5.0, 5.0, 0.0)})
    with pytest.raises(ValueError, match="unknown must be 'free', as for all nodes that share the map of the simulation"):
        sim.add_robot("robot2", start=(9.0, 9.0, 0.0), parameters={key: "occupied"})
    assert list(sim.robots) == ["robot1"]


def test_the_laser_decides_how_a_simulation_treats_unknown_cells() -> None:
    key = "laser_scanner_simulator_node:unknown"
    sim = mrs.Simulation(hall(), parameters={key: "occupied"}, start=(5.0, 5.0, 0.0))
    assert (sim.grid.unknown, sim.robot.parameters.unknown) == ("occupied", "occupied")
    with pytest.raises(ValueError, match=r"got 'free' for mobile_robot_simulator_node"):
        mrs.Simulation(hall(), parameters={key: "occupied", "unknown": "free"}, start=(5.0, 5.0, 0.0))


def test_a_robot_added_again_after_a_restore_gets_its_mount_from_tf():
    sim = mrs.Simulation(hall(), robots={"robot1": (5.0, 5.0, 0.0)})
    state, mounts = sim.save(), []
    for _ in range(2):
        robot = sim.add_robot("robot2", start=(9.0, 9.0, 0.0), parameters={"laser_frame_id": "scanner"})
        link = mrs.messages.TransformStamped(mrs.messages.Header(frame_id="robot2/base_link"), "robot2/scanner")
        link.transform.translation.x = 0.5
        sim.publish("/tf", mrs.messages.TFMessage([link]))
        sim.run_for(1.0)
        mounts.append(tuple(robot.laser.scanner.mount))
        sim.restore(state)
    assert mounts == [(0.5, 0.0, 0.0)] * 2


@pytest.mark.parametrize(
    ("pose", "message"),
    [
        ((0.05, 0.05, 0.0), "the pose must not be inside a wall"),
        ((0.3, 2.0, 0.0), "the pose must leave the robot room beside walls"),
        ((9.0, 10.0, 0.0), "the pose must leave the robot room beside robot robot2"),
        ((15.2, 15.0, 0.0), "the pose must leave the robot room beside obstacle pillar"),
    ],
)
def test_a_robot_cannot_be_moved_to_where_it_could_not_start(pose, message, caplog):
    sim = pair(robot_radius=0.25)
    sim.add_obstacle(mrs.Shape.disc(0.5), (15.0, 15.0, 0.0), name="pillar")
    before = tuple(sim.robots["robot1"].truth.pose)
    with pytest.raises(ValueError, match=message):
        sim.set_pose(pose, robot="robot1")
    # The same through the node: it refuses and logs a warning.
    where = mrs.messages.PoseWithCovarianceStamped()
    where.header.frame_id = "map"
    where.pose.pose = mrs.messages.Pose.from_planar(mrs.Pose(*pose))
    sim.publish("/robot1/initialpose", where)
    sim.run_for(0.1)
    assert any(f"pose refused: {message}" in record.message for record in caplog.records)
    assert tuple(sim.robots["robot1"].truth.pose) == before
    sim.set_pose((before[0] + 0.1, before[1], 0.0), robot="robot1")  # it may overlap where it is now


def test_a_place_off_the_map_gives_a_warning():
    with pytest.warns(UserWarning, match=r"start \(50, 2\) is off the map"):
        sim = mrs.Simulation(hall(), start=(50.0, 2.0, 0.0))
    with pytest.warns(UserWarning, match=r"the pose \(-3, 2\) is off the map") as caught:
        sim.set_pose((-3.0, 2.0, 0.0))
    assert caught[0].filename == __file__


def test_the_error_of_the_default_start_says_that_none_was_given():
    with pytest.raises(ValueError, match=r"0.0\); no start was given; give one, such as start=grid.draw_free_pose"):
        mrs.Simulation(hall())
    with pytest.raises(ValueError, match=r"got \(0.0, 0.0, 0.0\)$"):
        mrs.Simulation(hall(), start=(0.0, 0.0, 0.0))
