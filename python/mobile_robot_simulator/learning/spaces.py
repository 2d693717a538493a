"""The spaces of observations and actions of a task."""

from __future__ import annotations

import math

import numpy as np
from gymnasium import spaces

from .task import NavigationTask


def observation_space(task: NavigationTask) -> spaces.Dict:
    """Returns the space of the observations of one environment.

    - `goal`: distance [m] and bearing [rad] of the goal as seen from the robot.
    - `ranges`: the scan [m].
    - `velocity`: velocity of the robot in its own frame, with the axes of the actions [m/s, rad/s].
    """
    # A start is no farther away than this, and a robot no faster.
    speed = math.hypot(*task.max_velocity[:-1])
    farthest = task.goal_distances[1] + speed * task.duration * (task.step_limit + 1)
    most = np.array(task.max_velocity, np.float32)
    return spaces.Dict(
        {
            "goal": spaces.Box(np.array([0.0, -math.pi], np.float32), np.array([farthest, math.pi], np.float32)),
            "ranges": spaces.Box(0.0, task.laser.max_range, (task.laser.beam_count,), np.float32),
            "velocity": spaces.Box(-most, most),
        }
    )


def action_space(task: NavigationTask) -> spaces.Box:
    """Returns the space of the actions of one environment: a share of the largest velocity along each axis, -1 to 1."""
    return spaces.Box(-1.0, 1.0, (len(task.max_velocity),), np.float32)
