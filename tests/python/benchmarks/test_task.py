"""task: the score by its formula, and numbers that are none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.benchmarks import Task

GRID = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)


def task(**changes: Any) -> Task:
    return Task(**{"name": "t", "grid": GRID, "start": mrs.Pose(1, 1), "goal": (8.0, 8.0), "optimal_time": 5.0, **changes})


@pytest.mark.parametrize(("time", "score"), [(0.0, 0.5), (10.0, 0.5), (16.0, 5 / 16), (40.0, 0.125), (99.0, 0.125)])
def test_the_score_of_the_challenge(time: float, score: float) -> None:
    assert task().score(time) == score


def test_the_score_of_the_report_of_2022() -> None:
    assert [task(quickest=4.0).score(time) for time in (10.0, 20.0, 30.0)] == [0.25, 0.25, 5 / 30]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"optimal_time": 0.0}, "optimal_time must be positive and finite, got 0.0"),
        ({"tolerance": -1.0}, "tolerance must be positive and finite, got -1.0"),
        ({"time_limit": float("nan")}, "time_limit must be positive and finite, got nan"),
        ({"quickest": 9.0}, "quickest must be at most slowest, got 9.0 and 8.0"),
        ({"goal": (1.0, float("inf"))}, r"goal must be two finite numbers \(x, y\), got \(1.0, inf\)"),
    ],
)
def test_numbers_that_are_none_are_errors(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        task(**changes)
