"""The picture of a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .._core import OccupancyGrid, Pose
from ..bus.bus import Bus
from ..messages import LaserScan
from ..physics.world import World
from .robots import Robots

if TYPE_CHECKING:
    from ..plotting import DrivePicture


def picture_of(
    grid: OccupancyGrid, bus: Bus, world: World, robots: Robots, goal: Sequence[float] | None = None
) -> DrivePicture:
    """Returns a picture of the map, the true paths of all robots, all outlines, and the first robot's last scans.

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
    points, places = list[Any](), list[Pose]()
    for laser in first.scanners.values():
        scans = bus.topic(laser.parameters.laser_topic, LaserScan)
        base = first.robot.motion.map_pose_at(scans.latest_ns)
        places.append(base * laser.scanner.mount)
        if isinstance(scans.latest, LaserScan):
            points.append(laser.scanner.end_points(base, scans.latest.ranges))
    contacts = [robot.truth.contacts[0].point for robot in robots if robot.robot.footprint and robot.truth.contacts]
    return DrivePicture(
        grid,
        path=first.truth.path[:, 1:],
        name=first.name if others else "",
        others={robot.name: robot.truth.path[:, 1:] for robot in others},
        shapes=[placed for _, placed in world.everybody()],
        scan_points=np.concatenate(points) if points else None,
        laser_pose=places[0],
        goal=goal,
        contacts=np.array(contacts) if contacts else None,
    )
