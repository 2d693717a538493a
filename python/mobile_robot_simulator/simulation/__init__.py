"""Simulation: a map, robots, obstacles and faults on the in-process bus, in one object."""

from .ground_truth import GroundTruth
from .robots import SimulatedRobot
from .simulation import Simulation
from .snapshot import Snapshot

__all__ = ["GroundTruth", "SimulatedRobot", "Simulation", "Snapshot"]
