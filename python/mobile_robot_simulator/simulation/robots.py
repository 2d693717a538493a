"""Robots of a simulation: each with its nodes, its truth, and its names in its namespace."""

from __future__ import annotations

from dataclasses import dataclass

from .._core import Pose
from ..handle import Handle
from ..nodes.laser import LaserScannerSimulator
from ..nodes.robot import MobileRobotSimulator
from .ground_truth import GroundTruth


@dataclass(frozen=True)
class SimulatedRobot(Handle):
    """A robot of a simulation."""

    name: str
    robot: MobileRobotSimulator
    laser: LaserScannerSimulator
    truth: GroundTruth

    @property
    def pose(self) -> Pose:
        """Where it is now, in the map frame."""
        return self.robot.pose
