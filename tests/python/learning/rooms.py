"""Worlds and tasks that the tests of the environments share."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.learning import NavigationEnv


def room(width: float = 4.0, height: float = 3.0) -> mrs.OccupancyGrid:
    """An empty room with cells of 0.1 m; its walls are one cell thick."""
    cells = np.zeros((round(height * 10), round(width * 10)), np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-1.0, 2.0, 0.5))


def task(**changes: Any) -> dict[str, Any]:
    """Arguments of an environment in which episodes are short: two small rooms, and noise."""
    arguments = {
        "worlds": [room(), room(5.0, 4.0)],
        "scanner": mrs.LaserScanner(fov=math.tau, beam_count=9, max_range=4.0),
        "noise": mrs.BeamModel(sigma_hit=0.05),
        "goal_radius": 0.45,
        "goal_distances": (0.5, 1.5),
        "time_limit": 3.0,
    }
    return {**arguments, **changes}


def environment() -> NavigationEnv:
    """An environment for worker processes, which find this file but not the tests."""
    return NavigationEnv(**task())


def actions(count: int, steps: int, axes: int = 2) -> np.ndarray:
    """Random actions (steps, count, axes) that drive ahead."""
    drawn = np.random.default_rng(7).uniform(-1.0, 1.0, (steps, count, axes)).astype(np.float32)
    drawn[:, :, 0] = np.abs(drawn[:, :, 0])
    return drawn


def assert_same(one: Any, other: Any) -> None:
    """Two nested dicts or tuples of arrays are the same, with the same dtypes and bytes."""
    assert type(one) is type(other)
    if isinstance(one, dict):
        assert sorted(one) == sorted(other)
        for key in one:
            assert_same(one[key], other[key])
    elif isinstance(one, tuple) or (isinstance(one, np.ndarray) and one.dtype == object):
        assert len(one) == len(other)
        for first, second in zip(one, other, strict=True):
            assert_same(first, second)
    elif isinstance(one, np.ndarray):
        assert one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    else:
        assert one == other
