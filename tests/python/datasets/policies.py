"""Policies of drives. Here, because a plan names the module of its policy."""

from __future__ import annotations

import math

from mobile_robot_simulator.benchmarks import Observation


class TowardsGoal:
    """Turns to the goal, and drives slowly."""

    def __call__(self, observation: Observation) -> tuple[float, float]:
        x, y = observation.goal
        assert len(observation.scan.ranges) == 31
        return 0.3, max(-1.0, min(1.0, 2.0 * math.atan2(y, x)))


def wrong() -> object:
    return lambda observation: (math.nan, 0.0)


class Recorder:
    """Turns slowly, and keeps the goals that it sees."""

    goals: list[tuple[float, float]]

    def __init__(self) -> None:
        Recorder.goals = []

    def __call__(self, observation: Observation) -> tuple[float, float]:
        Recorder.goals.append(observation.goal)
        return 0.2, 0.1 * len(Recorder.goals)
