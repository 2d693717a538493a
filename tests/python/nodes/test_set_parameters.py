"""set_parameters, services and new maps, on the bus: what a running node takes over, and what it refuses unchanged."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.nodes.map_messages import from_message, to_message
from mobile_robot_simulator.nodes.map_server import MapFileServer
from mobile_robot_simulator.parameters import MapParameters

FORWARD = mrs.messages.Twist(linear=mrs.messages.Vector3(x=1.0))


def room(side: int = 100) -> mrs.OccupancyGrid:
    cells = np.zeros((side, side), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-side / 20, -side / 20, 0.0))


def simulation(**parameters: Any) -> mrs.Simulation:
    return mrs.Simulation(room(), parameters={"apply_noise": False, "laser_beam_count": 5, **parameters})


def call(sim: mrs.Simulation, service: Any, name: str, request: Any) -> Any:
    future = sim.create_node("client").create_client(service, name).call_async(request)
    sim.run_for(0.0)
    return future.result()


@pytest.mark.parametrize(("timeout", "moved"), [(2.0, 0.3 + 2.0), (0.1, 0.3 + 0.1)])
def test_a_command_in_force_is_held_anew(timeout: float, moved: float) -> None:
    sim = simulation()
    sim.publish("/cmd_vel", FORWARD)
    sim.run_for(0.3)
    sim.robot.set_parameters(velocity_timeout=timeout)
    assert sim.pose.x == pytest.approx(0.3)
    sim.run_for(3.0)
    assert sim.pose.x == pytest.approx(moved, abs=1e-12)


def test_a_command_that_is_over_stays_over() -> None:
    sim = simulation()
    sim.publish("/cmd_vel", FORWARD)
    sim.run_for(1.0)
    sim.robot.set_parameters(velocity_timeout=10.0)
    sim.run_for(1.0)
    assert sim.pose.x == pytest.approx(0.5, abs=1e-12)


def test_rates_and_topics_change_at_once() -> None:
    sim = simulation(publish_rate=10.0)
    sim.run_for(1.0)
    sim.robot.set_parameters(publish_rate=50.0, odometry_topic="/moved")
    sim.laser.set_parameters(laser_beam_count=9, laser_topic="/front")
    counts = {"/moved": 0, "/odom": 0, "/front": 0}
    for topic, kind in (
        ("/moved", mrs.messages.Odometry),
        ("/odom", mrs.messages.Odometry),
        ("/front", mrs.messages.LaserScan),
    ):
        sim.subscribe(topic, kind, lambda _, topic=topic: counts.update({topic: counts[topic] + 1}))  # type: ignore[misc]
    sim.run_for(1.0)
    assert counts == {"/moved": 50, "/odom": 0, "/front": 10}
    assert len(sim.latest("/front").ranges) == 9


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        ({"laser_fov": 9.0}, "laser_fov must be less than or equal to 6.28"),
        ({"laser_beam_count": 3, "laser_topic": "no name"}, "laser_topic must be a name such as /scan, got 'no name'"),
        ({"laser_topic": "/odom"}, "/odom carries Odometry, got LaserScan"),
    ],
)
def test_what_is_refused_changes_nothing(values: dict[str, Any], complaint: str) -> None:
    sim = simulation()
    sim.run_for(1.0)
    before = sim.laser.parameters
    with pytest.raises((ValueError, TypeError), match=complaint.replace("(", r"\(")):
        sim.laser.set_parameters(**values)
    assert sim.laser.parameters == before
    last = sim.latest("/scan")
    sim.run_for(1.0)
    assert sim.latest("/scan").header.stamp.nanoseconds > last.header.stamp.nanoseconds
    assert len(sim.latest("/scan").ranges) == 5


def test_unknown_cells_are_read_anew() -> None:
    cells = np.zeros((20, 20), np.int8)
    cells[:, 15] = -1
    sim = mrs.Simulation(mrs.OccupancyGrid(cells, resolution=0.1), start=(0.55, 1.05, 0.0))
    sim.laser.set_parameters(apply_noise=False, laser_beam_count=1)
    sim.run_for(0.5)
    assert sim.latest("/scan").ranges[0] == math.inf
    sim.laser.set_parameters(unknown="occupied", laser_fov=1e-3)
    sim.run_for(0.5)
    assert sim.latest("/scan").ranges[0] == pytest.approx(0.95, abs=1e-3)


def test_reset_goes_back_to_the_start() -> None:
    sim = mrs.Simulation(room(), start=(1.0, 2.0, 0.5))
    sim.publish("/cmd_vel", FORWARD)
    sim.run_for(0.3)
    assert call(sim, messages.Trigger, "reset", messages.TriggerRequest()).success
    assert tuple(sim.pose) == (1.0, 2.0, 0.5)
    assert sim.robot.distance == 0.0
    sim.run_for(0.3)
    assert tuple(sim.pose) == (1.0, 2.0, 0.5)


def test_set_pose_puts_the_robot_there_or_refuses() -> None:
    sim = simulation()
    pose = messages.PoseWithCovariance(messages.Pose.from_planar(mrs.Pose(1.0, -2.0, 0.25)))
    for frame in ("somewhere", "map"):
        stamped = messages.PoseWithCovarianceStamped(messages.Header(frame_id=frame), pose)
        call(sim, messages.SetPose, "set_pose", messages.SetPoseRequest(stamped))
        assert tuple(sim.pose) == pytest.approx((1.0, -2.0, 0.25) if frame == "map" else (0.0, 0.0, 0.0))


def test_a_new_map_takes_the_place_of_the_old_and_a_broken_one_does_not() -> None:
    sim = simulation()
    sim.run_for(1.0)
    broken = to_message(room(40))
    broken.info.width = 7
    sim.publish("/map", broken)
    sim.run_for(1.0)
    assert sim.latest("/scan").ranges[2] == pytest.approx(4.9)
    sim.publish("/map", to_message(room(40)))
    sim.run_for(1.0)
    assert sim.latest("/scan").ranges[2] == pytest.approx(1.9)


def test_the_simulations_own_map_is_not_replaced_by_its_copy() -> None:
    sim = mrs.Simulation(mrs.OccupancyGrid(room().cells, resolution=0.1, origin=(-5.0, -5.0, 1e-3)))
    used = sim.laser._grid
    sim.run_for(1.0)
    assert sim.laser._grid is used


def test_a_resolution_off_the_wire_is_the_decimal_it_stands_for() -> None:
    message = to_message(mrs.OccupancyGrid(np.zeros((2, 2), np.int8), resolution=0.05))
    message.info.resolution = float(np.float32(0.05))
    assert from_message(message).resolution == 0.05


def test_a_map_server_changes_its_file(tmp_path: Path) -> None:
    for side in (40, 60):
        mrs.save_map(room(side), tmp_path / f"{side}.yaml")
    sim = simulation(map_topic="")
    node = sim.create_node("files")
    names = {"topic_name": "/other_map", "service_name": "/other"}
    server = MapFileServer(node, MapParameters(yaml_filename=f"{tmp_path}/40.yaml", **names))  # type: ignore[arg-type]
    server.start()
    with pytest.raises(OSError, match="absent"):
        server.set_parameters(yaml_filename=f"{tmp_path}/absent.yaml")
    assert sim.latest("/other_map").info.width == 40
    server.set_parameters(yaml_filename=f"{tmp_path}/60.yaml")
    assert sim.latest("/other_map").info.width == 60


def test_the_clock_can_go_at_a_rate_of_its_own_or_not_at_all() -> None:
    sim = simulation(clock_rate=100.0)
    times: list[int] = []
    sim.subscribe("/clock", mrs.messages.Clock, lambda message: times.append(message.clock.nanoseconds))
    sim.run_for(1.0)
    assert len(times) == 100
    sim.robot.set_parameters(publish_clock=False)
    sim.run_for(1.0)
    assert len(times) == 100
