"""The picture of a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .._core import OccupancyGrid
from ..bus.bus import Bus
from ..messages import LaserScan
from ..physics.world import World
from .robots import Robots

if TYPE_CHECKING:
    from ..plotting import DrivePicture


def picture_of(
    grid: OccupancyGrid, bus: Bus, world: World, robots: Robots, goal: Sequence[float] | None = None
) -> DrivePicture:
    """Returns a picture of the map, the true paths of all robots, all outlines, and the first robot's last scan.

    It also shows where each robot first touched something.

    Args:
        grid: The map.
        bus: The bus, for the last scan.
        world: The world, for the outlines of robots and obstacles.
        robots: The robots, for their paths and contacts.
        goal: Goal to show: x, y [m] in the map frame.

    Raises:
        ImportError: Matplotlib is not installed.
        ValueError: There is no robot.
    """
    from ..plotting import DrivePicture

    first, *others = [robots.first, *list(robots)[1:]]
    scans = bus.topic(first.laser.parameters.laser_topic, LaserScan)
    base, scanner = first.robot.motion.map_pose_at(scans.latest_ns), first.laser.scanner
    contacts = [robot.truth.contacts[0].point for robot in robots if robot.robot.footprint and robot.truth.contacts]
    return DrivePicture(
        grid,
        path=first.truth.path[:, 1:],
        others={robot.name: robot.truth.path[:, 1:] for robot in others},
        shapes=[placed for _, placed in world.everybody()],
        scan_points=scanner.end_points(base, scans.latest.ranges) if isinstance(scans.latest, LaserScan) else None,
        laser_pose=base * scanner.mount,
        goal=goal,
        contacts=np.array(contacts) if contacts else None,
    )
