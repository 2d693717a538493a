"""A drive: a simulation with a driver at the wheel, what came of it, and its recording and picture."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from .._core import OccupancyGrid, Pose
from ..messages import LaserScan, Odometry
from ..simulation.simulation import Simulation
from .drivers import Commander, Script, Wander

WANTED_CLEARANCE = 0.6
"""A start is drawn this far from walls [m], if there is such a place."""


@dataclass(frozen=True)
class Summary:
    """What came of a drive. Seconds, metres, radians; collisions are contacts begun, unknown_share is of the odometry."""

    simulated_seconds: float
    wall_seconds: float
    real_time_factor: float
    scans: int
    beams: int
    beams_per_second: float
    distance: float
    collisions: int
    unknown_share: float
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    seed: int
    interrupted: bool

    def save(self, path: Path) -> None:
        """Write the summary as JSON."""
        path.write_text(json.dumps(asdict(self), indent=2) + "\n", encoding="utf-8")


@dataclass
class Drive:
    """A robot of a radius on its way through a map.

    driver: what sends the commands. start: first pose, drawn from free space if None.
    """

    grid: OccupancyGrid
    driver: Wander | Script
    parameters: Mapping[str, Any]
    seed: int
    start: Pose | None = None
    radius: float = 0.2
    simulation: Simulation = field(init=False)
    path: list[tuple[float, float, float]] = field(init=False, default_factory=list)
    scans: int = field(init=False, default=0)
    collisions: int = field(init=False, default=0)
    in_unknown: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        start = self.start if self.start is not None else draw_start(self.grid, self.radius, self.seed)
        self.start = start
        self.simulation = Simulation(self.grid, parameters=self.parameters, seed=self.seed, start=start)
        simulation = self.simulation
        robot, laser = simulation.robot.parameters, simulation.laser.parameters
        self.path.append((start.x, start.y, start.yaw))
        self._touching = self._touches(start)
        simulation.subscribe(robot.odometry_topic, Odometry, self._follow)
        simulation.subscribe(laser.laser_topic, LaserScan, self._count)
        node = simulation.create_node("driver")
        commander = Commander(node, robot.velocity_topic, stamped=robot.cmd_vel_stamped)
        if isinstance(self.driver, Wander):
            self.driver.start(node, commander, laser.laser_topic, self.seed)
        else:
            self.driver.start(node, commander)

    def run(
        self, duration: float, *, real_time: bool = False, progress: Callable[[float], None] = lambda _: None
    ) -> Summary:
        """Drive for so many simulated seconds, as fast as can be or, with `real_time`, at `speed_factor` times the wall's.

        progress: called with the simulated time now and then. Ctrl-C ends the drive early; all until then counts.
        """
        simulation, interrupted = self.simulation, False
        began, pace = time.perf_counter(), simulation.robot.parameters.speed_factor
        step = 0.02 * pace if real_time else 1.0
        try:
            while (left := duration - simulation.time) > 0.0:
                if real_time:
                    time.sleep(max(0.0, simulation.time / pace - (time.perf_counter() - began)))
                simulation.run_for(min(step, left))
                progress(simulation.time)
        except KeyboardInterrupt:
            interrupted = True
        wall = time.perf_counter() - began
        beams = self.scans * simulation.laser.parameters.laser_beam_count
        end = simulation.pose
        return Summary(
            simulated_seconds=simulation.time,
            wall_seconds=wall,
            real_time_factor=simulation.time / wall,
            scans=self.scans,
            beams=beams,
            beams_per_second=beams / wall,
            distance=simulation.robot.distance,
            collisions=self.collisions,
            unknown_share=self.in_unknown / len(self.path),
            start=self.path[0],
            end=(end.x, end.y, end.yaw),
            seed=self.seed,
            interrupted=interrupted,
        )

    def draw(self, file: Path) -> None:
        """Save a picture of the map, the way driven and the last scan."""
        from ..plotting import DrivePicture

        simulation = self.simulation
        scan = simulation.latest(simulation.laser.parameters.laser_topic)
        pose = simulation.pose
        points = None if scan is None else simulation.laser.scanner.end_points(pose, scan.ranges)
        path = np.array([*self.path, tuple(pose)])
        DrivePicture(self.grid, path, scan_points=points, laser_pose=pose).save(file)

    def _follow(self, odometry: Odometry) -> None:
        pose = self.simulation.pose
        self.path.append((pose.x, pose.y, pose.yaw))
        touching = self._touches(pose)
        self.collisions += touching and not self._touching
        cell = self.grid.cell_at(pose.x, pose.y)
        self.in_unknown += cell is None or bool(self.grid.cells[cell] < 0)
        self._touching = touching

    def _touches(self, pose: Pose) -> bool:
        return not self.grid.is_free_disc(pose.x, pose.y, self.radius)

    def _count(self, scan: LaserScan) -> None:
        self.scans += 1


def draw_start(grid: OccupancyGrid, radius: float, seed: int) -> Pose:
    """A pose drawn from free space, with room to turn if there is such a place.

    raises: ValueError if the robot fits nowhere.
    """
    try:
        return grid.draw_free_pose(radius=max(radius, WANTED_CLEARANCE), seed=seed)
    except ValueError:
        return grid.draw_free_pose(radius=radius, seed=seed)
