"""Picture: what a drawing of a simulation shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid, Pose, Shape
from ..bus.bus import Bus
from ..messages import LaserScan
from ..physics.world import World
from .robots import Robots


@dataclass(frozen=True)
class Picture:
    """What a drawing of a simulation shows, under the names of the arguments of `plotting.plot_drive`.

    Attributes:
        grid: The map.
        path: True path of the first robot, (N, 3) float64: x [m], y [m], yaw [rad] in the map frame.
        others: True paths of the other robots, by name.
        shapes: Footprints of robots and obstacles, with their current poses in the map frame.
        scan_points: End points of the beams of the first robot's last scan, (M, 2) float64 [m]; None without a scan.
        laser_pose: Pose in the map frame from which that scan was taken.
    """

    grid: OccupancyGrid
    path: NDArray[np.float64]
    others: dict[str, NDArray[np.float64]]
    shapes: list[tuple[Shape, Pose]]
    scan_points: NDArray[np.float64] | None
    laser_pose: Pose


def picture_of(grid: OccupancyGrid, bus: Bus, world: World, robots: Robots) -> Picture:
    """Returns what a drawing of a simulation shows now.

    Args:
        grid: The map.
        bus: The bus, for the last scan.
        world: The world, for the shapes of robots and obstacles.
        robots: The robots, for their paths.

    Raises:
        ValueError: There is no robot.
    """
    first, *others = [robots.first, *list(robots)[1:]]
    scans = bus.topic(first.laser.parameters.laser_topic, LaserScan)
    base, scanner = first.robot.motion.map_pose_at(scans.latest_ns), first.laser.scanner
    return Picture(
        grid,
        path=first.truth.path[:, 1:],
        others={robot.name: robot.truth.path[:, 1:] for robot in others},
        shapes=[placed for _, placed in world.everybody()],
        scan_points=scanner.end_points(base, scans.latest.ranges) if isinstance(scans.latest, LaserScan) else None,
        laser_pose=base * scanner.mount,
    )
