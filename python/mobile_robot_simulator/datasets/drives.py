"""Drives: the poses of a simulated robot that a policy drives."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, LaserScanner, OccupancyGrid, Pose, Shape, clearance
from ..benchmarks.control_loop import Controller, Observation
from ..drivers.wander import Wander, Wandering
from ..instant import NANOSECONDS
from ..messages import Twist, Vector3
from ..parameters import LaserParameters, RobotParameters
from ..quoting import quoted
from ..simulation import Simulation
from .plan import Noise, Plan

__all__ = ["Drive", "drive", "policy_of"]

TRIES = 1000
"""Number of places that are drawn until one is clear of obstacles."""


class Drive(NamedTuple):
    """Where a robot was at each scan of a drive."""

    poses: NDArray[np.float64]
    """(N, 3), poses in the map frame [m, m, rad]."""

    twists: NDArray[np.float64]
    """(N, 3), velocities in the robot's frame [m/s, m/s, rad/s]."""

    goal: tuple[float, float]
    """Goal in the map frame [m]."""


def policy_of(text: str) -> Callable[[], Controller]:
    """Returns what makes a controller, from `module:name`.

    Raises:
        ImportError: There is no such module.
        ValueError: The module has no such name, or it cannot be called.
    """
    module, _, name = text.partition(":")
    found = getattr(import_module(module), name, None)
    if not callable(found):
        raise ValueError(f"poses.policy must be module:name of a class or function, got {quoted(text)}")
    return found  # type: ignore[no-any-return]


def drive(
    plan: Plan,
    grid: OccupancyGrid,
    scanner: LaserScanner,
    noise: BeamModel | None,
    obstacles: list[tuple[Shape, Pose]],
    count: int,
    seed: Callable[[str], int],
    check: Callable[[], None],
) -> Drive:
    """Returns where a robot is at each scan of a drive, from a random start on the way to a random goal.

    The policy gets the scan of the simulation, which has the scanner and the noise of the scene, at each period, and returns
    the command for the next one. It goes on when the robot has arrived.

    Args:
        plan: The plan.
        grid: The map.
        scanner: The scanner.
        noise: Noise of the scans that the policy gets.
        obstacles: Obstacles that stand in the map.
        count: Number of scans.
        seed: Returns the seed for what has a name.
        check: Called before each scan. An exception of it ends the drive.

    Raises:
        ValueError: There is no free place for the start, a parameter is invalid, or a command is not two finite numbers.
    """
    start = _clear_place(grid, obstacles, plan.poses.clearance, seed("start"))
    goal = _clear_place(grid, obstacles, plan.poses.clearance, seed("goal"))
    simulation = Simulation(grid, parameters=_parameters(plan, scanner, noise), seed=seed("simulation"), start=start)
    with simulation:
        for shape, pose in obstacles:
            simulation.add_obstacle(shape, pose)
        robot: RobotParameters = simulation.robot.parameters
        laser: LaserParameters = simulation.laser.parameters
        control = policy_of(plan.poses.policy)() if plan.poses.policy else _roaming(plan.poses.clearance, seed("driver"))
        poses, twists = np.empty((count, 3)), np.empty((count, 3))
        for index in range(count):
            check()
            simulation.run_for(plan.poses.period)
            pose = simulation.truth.pose
            poses[index], twists[index] = tuple(pose), simulation.truth.velocity
            ahead = pose.inverse() * Pose(goal.x, goal.y)
            scan, odometry = simulation.latest(laser.laser_topic), simulation.latest(robot.odometry_topic)
            command = control(Observation(simulation.time, scan, odometry, (ahead.x, ahead.y)))
            simulation.publish(robot.velocity_topic, _twist(command))
    return Drive(poses, twists, (goal.x, goal.y))


def _roaming(radius: float, seed: int) -> Controller:
    """Returns a controller that roams and avoids obstacles."""
    wandering = Wandering(Wander(radius), seed)

    def control(observation: Observation) -> tuple[float, float]:
        speed, _, turn_rate = wandering.velocity(observation.scan, round(observation.time * NANOSECONDS))
        return speed, turn_rate

    return control


def _clear_place(grid: OccupancyGrid, obstacles: list[tuple[Shape, Pose]], radius: float, seed: int) -> Pose:
    """Returns a random pose at which a disc is free of walls and obstacles."""
    disc = Shape.disc(max(radius, 1e-3))
    for place in grid.draw_free_poses(TRIES, radius=radius, seed=seed, threads=1).tolist():
        if clearance(grid, disc, place, limit=1e-3, obstacles=obstacles) > 0.0:
            return Pose(*place)
    raise ValueError(f"poses.clearance must leave room between {len(obstacles)} obstacles, got {radius} m")


def _parameters(plan: Plan, scanner: LaserScanner, noise: BeamModel | None) -> dict[str, Any]:
    """Returns the parameters of a simulation with a scanner and noise."""
    low, high = sorted((scanner.angle_min, scanner.angle_max))
    values: dict[str, Any] = {
        "laser_angle_min": low,
        "laser_angle_max": high,
        "laser_clockwise": scanner.angle_increment < 0.0,
        "laser_beam_count": scanner.beam_count,
        "laser_max_range": scanner.max_range,
        "laser_min_range": scanner.min_range,
        "laser_mount": scanner.mount_in_space,
        "laser_frame_id": "laser",
        "laser_frequency": 1.0 / plan.poses.period,
        "apply_noise": noise is not None,
    }
    for name in Noise.model_fields if noise is not None else ():
        values[name] = getattr(noise, name)
    if not {"robot_radius", "footprint"} & plan.poses.robot.keys() and plan.poses.clearance:
        values["robot_radius"] = plan.poses.clearance
    return values | plan.poses.robot


def _twist(command: Any) -> Twist:
    try:
        speed, turn_rate = np.array(command, np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"a command of the policy must be (speed, turn rate), got {quoted(command)}") from None
    if not np.isfinite([speed, turn_rate]).all():
        raise ValueError(f"a command of the policy must be finite, got {quoted(command)}")
    return Twist(linear=Vector3(x=float(speed)), angular=Vector3(z=float(turn_rate)))
