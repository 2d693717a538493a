"""MovingAI: the problems of the Grid-Based Pathfinding Benchmarks, driven by a robot.

Sources: N. Sturtevant, *Benchmarks for grid-based pathfinding*, IEEE Transactions on Computational Intelligence and AI in
Games 4(2), 2012, and https://movingai.com/benchmarks; the score: N. Yokoyama, S. Ha and D. Batra, *Success weighted by
completion time: a dynamics-aware evaluation criteria for embodied navigation*, IROS 2021.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .._core import OccupancyGrid
from ..maps import Scenario
from .task import Task

__all__ = ["movingai_task"]

RADIUS = 0.4
"""Radius of the robot [cells]: it fits between the walls wherever the shortest path does."""

TOLERANCE = 0.5
"""Largest distance from the goal on arrival [cells]."""

SLOWEST = 8.0
"""Time limit, as a multiple of the optimal time."""

SHORTEST_LIMIT = 20.0
"""Smallest time limit [s], for a turn before a short drive."""


def movingai_task(
    grid: OccupancyGrid,
    scenario: Scenario,
    *,
    speed: float = 1.0,
    name: str | None = None,
    parameters: Mapping[str, Any] | None = None,
) -> Task:
    """Returns the task to drive from the start of a MovingAI problem to its goal.

    The score is the success weighted by completion time: OT / max(OT, time) if the robot arrives, else 0. The optimal time
    OT is that of the shortest path of the problem at `speed`. This path has steps to eight neighbours, so a robot that moves
    in any direction can be faster; it scores 1. The time limit is 8 OT, at least 20 s. The robot is a disc with a radius of
    0.4 cells, so it fits wherever the shortest path does.

    Args:
        grid: The map of the problem, as `load_map` returns it. Its resolution decides the size of a cell.
        scenario: The problem, as `load_scenarios` returns it.
        speed: Top speed of the robot [m/s].
        name: Name in the table of results. Default: the map, start and goal.
        parameters: Parameters of the robot that replace or complete its radius and its speed limit.

    Raises:
        ValueError: The grid has another size than the map of the problem, the start is the goal, or the speed is not
            positive.

    Example:
        >>> import numpy as np
        >>> import mobile_robot_simulator as mrs
        >>> from mobile_robot_simulator.benchmarks import movingai_task
        >>> from mobile_robot_simulator.maps import Scenario
        >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
        >>> task = movingai_task(grid, Scenario(1, "maps/field.map", (9, 9), (0, 0), (8, 0), 8.0))
        >>> task.name, task.optimal_time, task.score(16.0)
        ('field (0, 0) to (8, 0)', 8.0, 0.5)
    """
    start, goal = scenario.poses_on(grid)
    if not speed > 0.0:
        raise ValueError(f"speed must be positive, got {speed}")
    if scenario.optimal_length == 0.0:
        raise ValueError(f"the start and the goal of a problem must differ, got {scenario.start} for both")
    optimal_time = scenario.optimal_length * grid.resolution / speed
    limit = max(SLOWEST * optimal_time, SHORTEST_LIMIT)
    stem = scenario.map.replace("\\", "/").rpartition("/")[2].removesuffix(".map")
    return Task(
        f"{stem} {scenario.start} to {scenario.goal}" if name is None else name,
        grid,
        start,
        (goal.x, goal.y),
        optimal_time=optimal_time,
        tolerance=TOLERANCE * grid.resolution,
        time_limit=limit,
        parameters={"velocity_limits": [speed, speed, 4.0], "apply_noise": False, **_outline(grid, parameters or {})},
        quickest=1.0,
        # No time within the limit is clipped. The clock looks at the robot every 0.1 s.
        slowest=(limit + 1.0) / optimal_time,
    )


def _outline(grid: OccupancyGrid, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the parameters, with the radius of the robot unless they have an outline."""
    has_outline = any(key.rpartition(":")[2] in ("robot_radius", "footprint") for key in parameters)
    return dict(parameters) if has_outline else {"robot_radius": RADIUS * grid.resolution, **parameters}
