"""Namespaces: the topics, frames and seeds of a named robot."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any

from .parameters import NODES
from .scanners import split

TOPICS = (
    "velocity_topic",
    "ackermann_topic",
    "odometry_topic",
    "laser_topic",
    "joint_states_topic",
    "ground_truth_topic",
    "contact_topic",
    "stalled_topic",
)
"""Parameters that hold topic names; they get the prefix `/<robot>/`."""

SHARED = ("map_service", "map_topic")
"""Parameters that hold the names of what all robots share; they get no prefix."""

FRAME_PREFIX = "frame_prefix"
"""Parameter that holds the prefix of all frames; it becomes `<robot>/`, followed by the given value."""

SEEDS = ("seed", "odometry_seed")
"""Parameters that hold seeds; each robot gets its own."""

OUTLINES = ("robot_radius", "footprint")
"""Parameters that hold the robot's outline."""

RADIUS = 0.2
"""Radius [m] of a named robot without an outline of its own, so that robots see each other."""


def of_namespace(name: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the parameters of a robot with topics, frames and seeds of its own.

    Topics get the robot's name as a prefix. The rest is as in `of_robot`.

    Args:
        name: Name of the robot. If empty, the values are returned unchanged.
        values: Parameter values by name, with or without the prefix `<node>:`.
    """
    own = of_robot(name, values)
    if name:
        for key, value in _given(values).items():
            parameter = _parameter(key)
            if parameter in TOPICS:
                own[key] = value and f"/{name}/{value.lstrip('/')}"
            elif parameter in SHARED:
                own[key] = value and f"/{value.lstrip('/')}"
    return own


def of_robot(name: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the parameters of a robot with frames and seeds of its own, for nodes in a namespace.

    Frames get the robot's name as a prefix. Seeds are derived from the given seed and the name, so that the noise of a
    robot does not depend on which other robots exist. A robot without an outline gets the radius `RADIUS`.

    Args:
        name: Name of the robot. If empty, the values are returned unchanged.
        values: Parameter values by name, with or without the prefix `<node>:`.
    """
    own = dict(values)
    if not name:
        return own
    for key, value in _given(values).items():
        parameter = _parameter(key)
        if parameter == FRAME_PREFIX:
            own[key] = f"{name}/{value}"
        elif parameter in SEEDS:
            own[key] = random.Random(f"{value}/{name}").getrandbits(63)
    if not any(key.rpartition(":")[2] in OUTLINES for key in values):
        own["robot_radius"] = RADIUS
    return own


def _parameter(key: str) -> str:
    """Returns the name of a parameter without the node or the scanner that it is for."""
    return split(key)[1].rpartition(":")[2]


def _given(values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the values, and the defaults of all other parameters."""
    return {**{key: info.default for model in NODES for key, info in model.model_fields.items()}, **values}
