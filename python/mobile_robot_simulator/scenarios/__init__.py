"""Scenarios: worlds that a robot can be in, each as plain data, and spaces of them to search."""

from .ranges import Dimension, FaultRange, Free, Moving, Range
from .space import Space
from .world import MovingDisc, World
from .world_map import WorldMap, floor_plans

__all__ = [
    "Dimension",
    "FaultRange",
    "Free",
    "Moving",
    "MovingDisc",
    "Range",
    "Space",
    "World",
    "WorldMap",
    "floor_plans",
]
