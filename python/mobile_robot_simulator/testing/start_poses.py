"""Random start poses for robots, in free space and at a distance from each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..quoting import quoted

# pytest loads this module at every start, in all projects. To keep that fast, functions import other modules when needed.
if TYPE_CHECKING:
    from .._core import OccupancyGrid, Pose
    from ..physics.obstacles import PoseLike

RADIUS = 0.3
"""Radius of free space around a start pose [m]. A larger robot gets the radius that its outline needs."""

ATTEMPTS = 100
"""Number of random poses to try for each robot."""


def draw_start_poses(
    grid: OccupancyGrid, names: Sequence[str], parameters: Mapping[str, Any], seed: int
) -> dict[str, PoseLike]:
    """Returns a random start pose for each robot, where its outline touches neither walls nor other robots.

    Args:
        grid: The map.
        names: Names of the robots.
        parameters: Parameters by name. They define the outlines of the robots.
        seed: Seed of the poses.

    Raises:
        ValueError: Two robots have the same name, or no pose was found for a robot.
    """
    from ..namespaces import of_namespace
    from ..parameters import RobotParameters, for_node

    if isinstance(names, str) or len(set(names)) < len(names):
        raise ValueError(f"robots must be a list of different names, got {quoted(names)}")
    placed: dict[str, tuple[Pose, float]] = {}
    for index, name in enumerate(names):
        shape = for_node(RobotParameters, of_namespace(name, parameters)).shape
        reach = RADIUS if shape is None else max(RADIUS, shape.reach)
        for attempt in range(ATTEMPTS):
            pose = grid.draw_free_pose(radius=reach, seed=(seed + index + attempt * len(names)) % 2**64)
            if all(math.hypot(pose.x - other.x, pose.y - other.y) > reach + far for other, far in placed.values()):
                break
        else:
            raise ValueError(
                f"no start pose was found for robot {name} beside {', '.join(placed)}: use a larger map or give robots poses"
            )
        placed[name] = pose, reach
    return {name: pose for name, (pose, _) in placed.items()}
