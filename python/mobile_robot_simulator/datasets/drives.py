"""Drives: the poses of a simulated robot that a policy drives."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, LaserScanner, OccupancyGrid, Pose, Shape, SurfaceModel, clearance
from ..benchmarks.control_loop import Controller, ControlLoop, Observation
from ..drivers.wander import Wander, Wandering
from ..instant import NANOSECONDS
from ..quoting import quoted
from ..simulation import Simulation
from .plan import Noise, Plan, Surfaces

__all__ = ["Drive", "drive", "policy_of"]

TRIES = 1000
"""Number of places that are drawn until one is clear of obstacles."""


class Drive(NamedTuple):
    """Where a robot was at each scan of a drive."""

    poses: NDArray[np.float64]
    """(N, 3), poses in the map frame [m, m, rad]."""

    twists: NDArray[np.float64]
    """(N, 3), velocities in the robot's frame [m/s, m/s, rad/s]."""

    commands: NDArray[np.float64]
    """(N, 2), the command that follows each scan: forward velocity and turn rate [m/s, rad/s]."""

    goal: tuple[float, float]
    """Goal in the map frame [m]."""

    goal_distances: NDArray[np.float64]
    """(N,), length of the straight line from the robot to the goal [m]."""


def policy_of(text: str, folder: Path) -> Callable[[], Controller]:
    """Returns what makes a controller, from `module:name`.

    Args:
        text: Module and name.
        folder: Folder in which the module may be; it is put into `sys.path`.

    Raises:
        ImportError: There is no such module.
        ValueError: The module has no such name, it cannot be called, or another module has the name of that in the folder.
    """
    module, _, name = text.partition(":")
    if str(folder.absolute()) not in sys.path:
        sys.path.insert(0, str(folder.absolute()))
    try:
        imported = import_module(module)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"poses.policy {quoted(text)}: {error}, neither in {folder} nor elsewhere") from error
    file, own = getattr(imported, "__file__", None), folder / f"{module}.py"
    if own.is_file() and file is not None and not own.samefile(file):
        raise ValueError(f"poses.policy {quoted(text)}: {own} cannot be imported, because {file} has the same name")
    found = getattr(imported, name, None)
    if not callable(found):
        raise ValueError(f"poses.policy must be module:name of a class or function, got {quoted(text)}")
    return found  # type: ignore[no-any-return]


def drive(
    plan: Plan,
    grid: OccupancyGrid,
    scanner: LaserScanner,
    noise: tuple[BeamModel | None, SurfaceModel | None],
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
        noise: Noise of the scans that the policy gets, and how what a beam meets changes it.
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
        policy = plan.poses.policy
        control = policy_of(policy, plan.folder)() if policy else _roaming(plan.poses.clearance, seed("driver"))
        loop = ControlLoop(simulation, control, (goal.x, goal.y), name=f"poses.policy {quoted(policy)}")
        poses, twists, commands = np.empty((count, 3)), np.empty((count, 3)), np.zeros((count, 2))
        for index in range(count):
            check()
            simulation.run_for(plan.poses.period)
            poses[index], twists[index] = tuple(simulation.truth.pose), simulation.truth.velocity
            command = loop.command()
            if command is not None:
                commands[index] = command
    goal_distances = np.array([math.dist((x, y), (goal.x, goal.y)) for x, y, _ in poses.tolist()])
    return Drive(poses, twists, commands, (goal.x, goal.y), goal_distances)


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


def _parameters(plan: Plan, scanner: LaserScanner, noise: tuple[BeamModel | None, SurfaceModel | None]) -> dict[str, Any]:
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
        "apply_noise": noise[0] is not None,
    }
    for names, model in zip((Noise.model_fields, Surfaces.model_fields), noise, strict=True):
        for name in names if model is not None else ():
            values[name] = getattr(model, name)
    if not {"robot_radius", "footprint"} & plan.poses.robot.keys() and plan.poses.clearance:
        values["robot_radius"] = plan.poses.clearance
    return values | plan.poses.robot
