"""Scenarios: worlds that a robot can be in, each as plain data, and spaces of them to search."""

from .disturbances import Disturbance, Drift, Pushes, Slips
from .ranges import Dimension, FaultRange, Free, Moving, Range
from .space import Space
from .world import MovingDisc, World
from .world_map import WorldMap, floor_plans

__all__ = [
    "Dimension",
    "Disturbance",
    "Drift",
    "FaultRange",
    "Free",
    "Moving",
    "MovingDisc",
    "Pushes",
    "Range",
    "Slips",
    "Space",
    "World",
    "WorldMap",
    "floor_plans",
]
