"""Drive: a simulated robot with a driver. Collects results and draws a picture of the path."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .._core import OccupancyGrid, Pose
from ..instant import NANOSECONDS
from ..messages import LaserScan, Odometry
from ..simulation.simulation import Simulation
from .commander import Commander
from .script import Script
from .summary import Summary
from .wander import Wander

WANTED_CLEARANCE = 0.6
"""Distance of a random start pose from walls [m], if the map has such a place."""


class Drive:
    """A robot that drives through a map.

    Args:
        grid: Map to drive in.
        driver: Sends the velocity commands.
        parameters: Parameter values by name.
        seed: Random seed.
        start: First pose in the map frame. None chooses a random free pose.
        radius: Radius of the robot [m], for collisions and for the random start pose.

    Attributes:
        simulation: The simulation with the robot.
        path: True poses (x, y [m], yaw [rad]) in the map frame: the first, then one for each odometry message.
        scans: Number of scans so far.
        collisions: Number of times that the robot began to touch a wall.
        in_unknown: Number of odometry messages sent from an unknown cell or from outside of the map.

    Raises:
        ValueError: A parameter or the start pose is invalid, or there is no free place for the robot.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        driver: Wander | Script,
        parameters: Mapping[str, Any],
        seed: int,
        *,
        start: Pose | None = None,
        radius: float = 0.2,
    ) -> None:
        start = start if start is not None else draw_start(grid, radius, seed)
        self._grid, self._radius, self._seed = grid, radius, seed
        self.simulation = Simulation(grid, parameters=parameters, seed=seed, start=start)
        self.path = [(start.x, start.y, start.yaw)]
        self.scans = self.collisions = self.in_unknown = 0
        self._touching = self._touches(start)
        robot, laser = self.simulation.robot.parameters, self.simulation.laser.parameters
        self.simulation.subscribe(robot.odometry_topic, Odometry, self._follow)
        self.simulation.subscribe(laser.laser_topic, LaserScan, self._count)
        node = self.simulation.create_node("driver")
        commander = Commander(node, robot.velocity_topic, stamped=robot.cmd_vel_stamped)
        if isinstance(driver, Wander):
            driver.start(node, commander, laser.laser_topic, seed)
        else:
            driver.start(node, commander)

    def run(
        self, duration: float, *, real_time: bool = False, progress: Callable[[float], None] = lambda _: None
    ) -> Summary:
        """Drives and returns the results. Ctrl-C ends the drive early; the results then cover the time until Ctrl-C.

        Args:
            duration: Simulated time [s], rounded to nanoseconds.
            real_time: Run at `speed_factor` times real time instead of as fast as possible.
            progress: Called repeatedly with the simulated time [s].
        """
        simulation, began = self.simulation, time.perf_counter()
        speed = simulation.robot.parameters.speed_factor
        # Whole nanoseconds: a rest of less than half of one would never get shorter.
        end_ns = round(duration * NANOSECONDS)
        step_ns = max(1, round(0.02 * speed * NANOSECONDS)) if real_time else NANOSECONDS
        interrupted = False
        try:
            while (left_ns := end_ns - round(simulation.time * NANOSECONDS)) > 0:
                if real_time:
                    time.sleep(max(0.0, simulation.time / speed - (time.perf_counter() - began)))
                simulation.run_for(min(step_ns, left_ns) / NANOSECONDS)
                progress(simulation.time)
        except KeyboardInterrupt:
            interrupted = True
        return self._summary(time.perf_counter() - began, interrupted=interrupted)

    def _summary(self, wall_seconds: float, *, interrupted: bool) -> Summary:
        simulation = self.simulation
        beams = self.scans * simulation.laser.parameters.laser_beam_count
        end = simulation.pose
        return Summary(
            simulated_seconds=simulation.time,
            wall_seconds=wall_seconds,
            real_time_factor=simulation.time / wall_seconds,
            scans=self.scans,
            beams=beams,
            beams_per_second=beams / wall_seconds,
            distance=simulation.robot.distance,
            collisions=self.collisions,
            unknown_share=self.in_unknown / len(self.path),
            start=self.path[0],
            end=(end.x, end.y, end.yaw),
            seed=self._seed,
            interrupted=interrupted,
        )

    def draw(self, file: Path) -> None:
        """Saves a picture of the map, the path and the last scan.

        Args:
            file: File to write. Its ending selects the format: .png, .pdf or .svg.

        Raises:
            ImportError: Matplotlib is not installed.
        """
        from ..plotting import DrivePicture

        simulation = self.simulation
        scan = simulation.latest(simulation.laser.parameters.laser_topic)
        pose = simulation.pose
        points = None if scan is None else simulation.laser.scanner.end_points(pose, scan.ranges)
        path = np.array([*self.path, tuple(pose)])
        DrivePicture(self._grid, path, scan_points=points, laser_pose=pose).save(file)

    def _follow(self, odometry: Odometry) -> None:
        """Records the true pose at an odometry message, and counts collisions and time in unknown space."""
        pose = self.simulation.pose
        self.path.append((pose.x, pose.y, pose.yaw))
        touching = self._touches(pose)
        self.collisions += touching and not self._touching
        cell = self._grid.cell_at(pose.x, pose.y)
        self.in_unknown += cell is None or bool(self._grid.cells[cell] < 0)
        self._touching = touching

    def _touches(self, pose: Pose) -> bool:
        return not self._grid.is_free_disc(pose.x, pose.y, self._radius)

    def _count(self, scan: LaserScan) -> None:
        self.scans += 1


def draw_start(grid: OccupancyGrid, radius: float, seed: int) -> Pose:
    """Returns a random free pose with `WANTED_CLEARANCE` around it or, if the map has none, with room for the robot.

    Raises:
        ValueError: There is no free place for the robot.
    """
    try:
        return grid.draw_free_pose(radius=max(radius, WANTED_CLEARANCE), seed=seed)
    except ValueError:
        return grid.draw_free_pose(radius=radius, seed=seed)
