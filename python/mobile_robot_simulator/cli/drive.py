"""Drive: a simulated robot with a driver. Collects results and draws a picture of the path."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from .._core import OccupancyGrid, Pose
from ..drivers.commander import Commander
from ..drivers.script import Script
from ..drivers.wander import Wander
from ..faults import Fault
from ..instant import NANOSECONDS
from ..messages import LaserScan, Odometry
from ..simulation.simulation import Simulation
from .summary import Summary

WANTED_CLEARANCE = 0.6
"""Distance of a random start pose from walls [m], if the map has such a place."""


class Drive:
    """A robot that drives through a map.

    Args:
        grid: Map to drive in.
        driver: Sends the velocity commands.
        parameters: Parameter values by name.
        seed: Random seed.
        start: First pose in the map frame. None chooses the parameter `initial_pose` or, without it, a random free pose.
        radius: Radius of the robot [m], for its random start pose. If `parameters` have neither `robot_radius` nor
            `footprint`, it is also the radius of the footprint, and `contact` is `report` by default.
        faults: Faults to add.

    Attributes:
        simulation: The simulation with the robot.
        odometry_messages: Number of odometry messages so far.
        scans: Number of scans so far.
        in_unknown_cells: Number of odometry messages sent from an unknown cell.
        off_map: Number of odometry messages sent from outside of the map.

    Raises:
        ValueError: A parameter or the start pose is invalid, there is no free place for the robot, or a fault names a topic
            or robot that does not exist.
        TypeError: A topic carries messages of a type that a fault cannot change.
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
        faults: Iterable[Fault] = (),
    ) -> None:
        start = usual_start(grid, parameters, start, radius, seed)
        self._grid, self._seed = grid, seed
        if not has_outline(parameters):
            parameters = {"robot_radius": radius, "contact": "report", **parameters}
        self.simulation = Simulation(grid, parameters=parameters, seed=seed, start=start)
        self.odometry_messages = self.scans = self.beams = self.in_unknown_cells = self.off_map = 0
        robot, laser = self.simulation.robot.parameters, self.simulation.laser.parameters
        self.simulation.subscribe(robot.odometry_topic, Odometry, self._follow)
        for each in self.simulation.named(None).scanners.values():
            self.simulation.subscribe(each.parameters.laser_topic, LaserScan, self._count)
        node = self.simulation.create_node("driver")
        commander = Commander(node, robot.velocity_topic, stamped=robot.cmd_vel_stamped)
        if isinstance(driver, Wander):
            driver.start(node, commander, laser.laser_topic, seed)
        else:
            driver.start(node, commander)
        for fault in faults:
            self.simulation.add_fault(fault)

    def run(
        self,
        duration: float,
        *,
        real_time: bool = False,
        progress: Callable[[float], None] = lambda _: None,
        ended: Callable[[], None] = lambda: None,
    ) -> Summary:
        """Drives and returns the results.

        A KeyboardInterrupt ends the drive early; the results then cover the time until it.

        Args:
            duration: Simulated time [s], rounded to nanoseconds.
            real_time: Run at `speed_factor` times real time instead of as fast as possible.
            progress: Called repeatedly with the simulated time [s].
            ended: Called when the drive has ended. A KeyboardInterrupt until then is one during the drive.
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
            ended()
        except KeyboardInterrupt:
            interrupted = True
            ended()
        return self._summary(time.perf_counter() - began, interrupted=interrupted)

    def _summary(self, wall_seconds: float, *, interrupted: bool) -> Summary:
        simulation = self.simulation
        start, end = simulation.robot.start_pose, simulation.pose
        return Summary(
            simulated_seconds=simulation.time,
            wall_seconds=wall_seconds,
            real_time_factor=simulation.time / wall_seconds,
            scans=self.scans,
            beams=self.beams,
            beams_per_second=self.beams / wall_seconds,
            distance=simulation.robot.distance,
            collisions=len(simulation.truth.contacts),
            unknown_share=(self.in_unknown_cells + self.off_map) / max(1, self.odometry_messages),
            start=(start.x, start.y, start.yaw),
            end=(end.x, end.y, end.yaw),
            seed=self._seed,
            interrupted=interrupted,
        )

    def draw(self, file: Path) -> None:
        """Saves the picture of the simulation.

        Args:
            file: File to write. Its ending selects the format: .png, .pdf or .svg.

        Raises:
            ImportError: Matplotlib is not installed.
        """
        self.simulation.draw(file)

    def _follow(self, odometry: Odometry) -> None:
        """Counts the odometry messages, and those sent from unknown cells and from outside of the map."""
        pose = self.simulation.pose
        cell = self._grid.cell_at(pose.x, pose.y)
        self.odometry_messages += 1
        if cell is None:
            self.off_map += 1
        elif self._grid.cells[cell] < 0:
            self.in_unknown_cells += 1

    def _count(self, scan: LaserScan) -> None:
        self.scans += 1
        self.beams += len(scan.ranges)


def has_outline(parameters: Mapping[str, Any]) -> bool:
    """Returns True if parameters give the robot a footprint."""
    return bool({"robot_radius", "footprint"} & {key.rpartition(":")[2] for key in parameters})


def usual_start(
    grid: OccupancyGrid, parameters: Mapping[str, Any], start: Pose | None, radius: float, seed: int
) -> Pose | None:
    """Returns the start pose that is given, None if the parameter `initial_pose` gives it, else a random free one.

    Raises:
        ValueError: There is no free place for the robot.
    """
    if start is not None or any(key.rpartition(":")[2] == "initial_pose" for key in parameters):
        return start
    return draw_start(grid, radius, seed)


def draw_start(grid: OccupancyGrid, radius: float, seed: int) -> Pose:
    """Returns a random free pose with `WANTED_CLEARANCE` around it or, if the map has none, with room for the robot.

    Raises:
        ValueError: There is no free place for the robot.
    """
    try:
        return grid.draw_free_pose(radius=max(radius, WANTED_CLEARANCE), seed=seed)
    except ValueError:
        return grid.draw_free_pose(radius=radius, seed=seed)
