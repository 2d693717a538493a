"""Task: a robot must reach a goal in a world, without contact and in time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .._core import OccupancyGrid, Pose
from ..simulation.simulation import Simulation

__all__ = ["Task"]


@dataclass(frozen=True)
class Task:
    """A navigation task and its score.

    The score is that of the BARN challenge: OT / clip(AT, `quickest` OT, `slowest` OT) if the robot arrives, else 0. OT is
    the optimal time, AT the time that the robot took.

    Args:
        name: Name in the table of results.
        grid: The world.
        start: Start pose in the map frame.
        goal: Goal (x, y) in the map frame [m].
        optimal_time: Time of the best robot [s].
        tolerance: The robot has arrived when its origin is at most so far from the goal [m].
        time_limit: Time after which the robot has failed [s], counted from when it has moved by 0.1 m.
        parameters: Parameters of the robot and its scanner.
        quickest: Times below this multiple of the optimal time do not increase the score.
        slowest: Times above this multiple do not decrease it.

    Raises:
        ValueError: A number is not positive or not finite, or `quickest` is above `slowest`.
    """

    name: str
    grid: OccupancyGrid
    start: Pose
    goal: tuple[float, float]
    optimal_time: float
    tolerance: float = 1.0
    time_limit: float = 100.0
    parameters: Mapping[str, Any] = field(default_factory=dict)
    quickest: float = 2.0
    slowest: float = 8.0

    def __post_init__(self) -> None:
        """Checks the numbers."""
        for name in ("optimal_time", "tolerance", "time_limit", "quickest", "slowest"):
            value = getattr(self, name)
            if not 0 < value < math.inf:
                raise ValueError(f"{name} must be positive and finite, got {value}")
        if self.quickest > self.slowest:
            raise ValueError(f"quickest must be at most slowest, got {self.quickest} and {self.slowest}")
        if len(self.goal) != 2 or not all(map(math.isfinite, self.goal)):
            raise ValueError(f"goal must be two finite numbers (x, y), got {self.goal}")

    def simulation(self, seed: int = 0) -> Simulation:
        """Returns a simulation at the start of the task.

        Args:
            seed: Seed of the noise.

        Raises:
            ValueError: A parameter is invalid, or the robot starts inside a wall.
        """
        simulation = Simulation(self.grid, parameters=self.parameters, seed=seed, start=self.start)
        simulation.goal = self.goal
        return simulation

    def score(self, time: float) -> float:
        """Returns the score of a robot that has arrived.

        Args:
            time: Time that it took [s].

        Example:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> from mobile_robot_simulator.benchmarks import Task
            >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
            >>> task = Task("open", grid, mrs.Pose(1, 1), (8.0, 8.0), optimal_time=5.0)
            >>> [task.score(time) for time in (1.0, 10.0, 20.0, 40.0, 90.0)]
            [0.5, 0.5, 0.25, 0.125, 0.125]
        """
        return self.optimal_time / min(max(time, self.quickest * self.optimal_time), self.slowest * self.optimal_time)
