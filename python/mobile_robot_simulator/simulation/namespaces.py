"""Parameters of a robot in its namespace."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any

from ..parameters import NODES

TOPICS = ("velocity_topic", "odometry_topic", "laser_topic")


RADIUS = 0.2
"""Radius [m] of robots that see one another, if they are given no footprint."""


SEEDS = ("seed", "odometry_seed")


FRAMES = ("base_link_frame", "odom_frame_id", "laser_frame_id")


def of_namespace(name: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters of the robot of a name: its topics and frames are its own, and so is its noise; it has a footprint.

    The seed is drawn from the simulation's and the name, so that a robot's noise does not depend on what others there are.
    """
    if not name:
        return dict(values)
    defaults = {key: info.default for model in NODES for key, info in model.model_fields.items()}
    given = {**defaults, **values}
    own = dict(values)
    for key, value in given.items():
        if key.rpartition(":")[2] in TOPICS:
            own[key] = f"/{name}/{value.lstrip('/')}"
        elif key.rpartition(":")[2] in FRAMES:
            own[key] = f"{name}/{value.lstrip('/')}"
        elif key.rpartition(":")[2] in SEEDS:
            own[key] = random.Random(f"{value}/{name}").getrandbits(63)
    if not any(key.rpartition(":")[2] in ("robot_radius", "footprint") for key in values):
        own["robot_radius"] = RADIUS
    return own
