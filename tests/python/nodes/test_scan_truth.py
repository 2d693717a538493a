"""ScanTruth and laser_scan_duration: every beam of a scan is taken at its own time, from where the robot is then."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.python.simulations import hall

import mobile_robot_simulator as mrs
from mobile_robot_simulator.messages import LaserScan, Twist, Vector3

DURATION = 0.08
DISC, BOX = mrs.Shape.disc(0.4), mrs.Shape.rectangle(0.8, 0.4)


def moving(size: float = 20.0, **parameters: Any) -> mrs.Simulation:
    """Returns a simulation of a robot that drives a curve in a hall, past a disc that moves and a box that stands."""
    quiet = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 90, "laser_fov": 2 * math.pi}
    values = {"laser_scan_duration": DURATION, **quiet, **parameters}
    sim = mrs.Simulation(hall(size), parameters=values, seed=3, start=(6.0, 6.0, 0.5))
    sim.add_obstacle(DISC, (8.0, 6.0, 0.0))
    sim.move_obstacle("1", velocity=(-0.5, 0.8, 2.0))
    sim.add_obstacle(BOX, (4.0, 6.0, 1.0))
    send(sim, 1.0, -0.4, 1.5)
    return sim


def send(sim: mrs.Simulation, vx: float, vy: float, wz: float, robot: str = "") -> None:
    sim.publish(f"{robot}/cmd_vel", Twist(linear=Vector3(x=vx, y=vy), angular=Vector3(z=wz)))


def one_by_one(sim: mrs.Simulation, around: Callable[[int], list[Any]], name: str = "") -> np.ndarray:
    """Returns the ranges of the last scan, each from a scan of its own at the pose at the time of its beam."""
    robot = sim.robots[name]
    truth, scanner = robot.laser.scan_truth, robot.laser.scanner
    assert truth is not None
    ranges = []
    for beam, offset in enumerate(truth.times_ns.tolist()):
        time_ns = truth.stamp_ns + offset
        pose = robot.truth.pose_at(time_ns / 1e9)
        ranges.append(scanner.scan(sim.grid, pose, obstacles=around(time_ns))[beam])
    return np.array(ranges)


def obstacles(sim: mrs.Simulation) -> Callable[[int], list[Any]]:
    return lambda time_ns: [(obstacle.shape, obstacle.pose(time_ns)) for obstacle in sim.obstacles]


@pytest.mark.parametrize(
    "parameters",
    [
        {},
        {"robot_radius": 0.2},
        {"acceleration_limits": [0.7, 0.7, 2.0]},
        {"acceleration_limits": [0.7, 0.7, 2.0], "robot_radius": 0.2, "velocity_timeout": 0.07},
        {"laser_clockwise": True, "laser_fov": 4.0},
        {"laser_frame_id": "laser", "laser_mount": [0.2, 0.1, 0.4, math.pi, 0.0, 0.3]},
        {"laser_frame_id": "laser", "laser_mount": [0.2, 0.1, 0.4, 0.1, 0.2, 0.3]},
    ],
)
def test_each_beam_sees_the_world_at_its_own_time(parameters: dict[str, Any]) -> None:
    sim = moving(**parameters)
    # The velocity changes within the second scan.
    for seconds, velocity in ((0.14, (1.0, -0.4, 1.5)), (0.19, (0.2, 0.3, -2.0)), (0.38, (0.0, 0.0, 1.0))):
        send(sim, *velocity)
        sim.run_for(seconds)
        if sim.laser.scan_truth is not None:
            expected = one_by_one(sim, obstacles(sim))
            assert np.array_equal(sim.laser.scan_truth.ranges, expected)
            scan = sim.latest("/scan")
            assert np.array_equal(scan.ranges, sim.laser.scanner.mark_invalid(expected))
    truth = sim.laser.scan_truth
    assert truth is not None
    assert not np.array_equal(truth.ranges, truth.instant())


def test_robots_see_each_other_at_the_time_of_each_beam() -> None:
    values = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 180, "laser_fov": 2 * math.pi}
    sim = mrs.Simulation(
        hall(),
        robots={"a": (5.0, 10.0, 0.0), "b": (7.0, 10.0, math.pi)},
        parameters={**values, "robot_radius": 0.3, "laser_scan_duration": DURATION},
    )
    send(sim, 0.5, 0.0, 2.0, "/a")
    send(sim, 0.0, 0.9, 1.0, "/b")
    sim.run_for(0.5)
    other = sim.robots["b"]
    shape = mrs.Shape.disc(0.3)
    expected = one_by_one(sim, lambda time_ns: [(shape, other.truth.pose_at(time_ns / 1e9))], "a")
    truth = sim.robots["a"].laser.scan_truth
    assert truth is not None and np.array_equal(truth.ranges, expected)
    assert not np.array_equal(truth.ranges, one_by_one(sim, lambda _: [], "a"))


def test_waypoints_and_functions_are_followed_within_a_scan() -> None:
    sim = moving()
    sim.add_obstacle(DISC, [(0.0, 6.0, 9.0, 0.0), (1.0, 9.0, 9.0, 3.0)])
    sim.add_obstacle(BOX, lambda time: (3.0, 3.0 + math.sin(3 * time), time))
    sim.run_for(0.61)
    truth = sim.laser.scan_truth
    assert truth is not None and np.array_equal(truth.ranges, one_by_one(sim, obstacles(sim)))


def test_the_message_has_the_times_of_the_beams() -> None:
    sim = moving(laser_frequency=10.0)
    sim.run_for(0.25)
    scan, truth = sim.latest("/scan"), sim.laser.scan_truth
    assert isinstance(scan, LaserScan) and truth is not None
    assert scan.header.stamp.nanoseconds == truth.stamp_ns == 120_000_000
    assert scan.time_increment == pytest.approx(DURATION / 90)
    assert scan.scan_time == pytest.approx(0.1)
    assert truth.times_ns[-1] == pytest.approx(DURATION * 1e9 * 89 / 90, abs=1)
    assert np.allclose(truth.beam_poses, sim.truth.poses_at((truth.stamp_ns + truth.times_ns) / 1e9), rtol=0, atol=1e-9)


def test_an_instant_scan_has_the_noise_of_the_scan_over_time() -> None:
    noisy = {"apply_noise": True, "sigma_hit": 0.05, "z_short": 0.2, "z_rand": 0.1}
    sim, instantaneous = moving(**noisy), moving(**noisy, laser_scan_duration=0.0)
    for each in (sim, instantaneous):
        send(each, 0.0, 0.0, 0.0)
        each.move_obstacle("1", velocity=(0.0, 0.0, 0.0))
        each.run_for(0.51)
    truth = sim.laser.scan_truth
    assert truth is not None
    # Nothing moves, so both are what a scanner without a duration measures.
    assert np.array_equal(truth.instant(), truth.ranges)
    assert np.array_equal(sim.latest("/scan").ranges, instantaneous.latest("/scan").ranges)
    with pytest.raises(ValueError, match=r"beam must be in 0\.\.89, got 90"):
        truth.instant(90)


def test_true_poses_undo_the_distortion() -> None:
    # Small, because a float32 of 16 m or more is not exact to 1e-6 m.
    sim = moving(size=10.0, laser_beam_count=360)
    sim.remove_obstacle("1")
    sim.remove_obstacle("2")
    send(sim, 1.0, 0.0, 3.0)
    sim.run_for(0.31)
    truth = sim.laser.scan_truth
    assert truth is not None
    angles = sim.laser.scanner.angles
    x, y, yaw = truth.beam_poses.T
    points = np.stack(
        (x + truth.ranges * np.cos(yaw + angles), y + truth.ranges * np.sin(yaw + angles)), axis=1, dtype=np.float64
    )
    # From the first pose, a ray to each point ends at the point: in a hall without edges, nothing stands in between.
    offsets = points - truth.beam_poses[0, :2]
    bearings = np.arctan2(offsets[:, 1], offsets[:, 0])
    rays = np.column_stack((np.broadcast_to(truth.beam_poses[0, :2], points.shape), bearings))
    assert np.abs(mrs.cast_rays(sim.grid, rays, 30.0) - np.hypot(*offsets.T)).max() < 1e-6
    # With one pose for all beams, they do not.
    distorted = np.abs(truth.ranges - truth.instant())
    assert distorted.max() > 0.1


def test_a_saved_simulation_goes_on_with_the_same_bytes() -> None:
    sim = moving(apply_noise=True, robot_radius=0.2)
    sim.run_for(0.27)
    state = sim.save()
    truth = sim.laser.scan_truth
    sim.run_for(0.5)
    after = sim.latest("/scan").ranges.tobytes()
    sim.restore(state)
    assert sim.laser.scan_truth is truth
    sim.run_for(0.5)
    assert sim.latest("/scan").ranges.tobytes() == after


def test_a_duration_longer_than_a_period_is_refused() -> None:
    with pytest.raises(ValueError, match=r"laser_scan_duration must be at most 1 / laser_frequency, 0\.1 s, got 0\.2"):
        moving(laser_scan_duration=0.2)
    with pytest.raises(ValueError, match="laser_scan_duration"):
        moving(laser_scan_duration=-0.1)
