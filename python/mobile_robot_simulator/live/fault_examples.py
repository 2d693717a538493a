"""Fault examples: a fault of each kind, for the topics and robots of a simulation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..bus.topic import absolute

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation


def fault_examples(simulation: Simulation) -> list[str]:
    """Returns faults as texts, as `--fault` takes them, for the first robot of a simulation."""
    if not simulation.robots:
        return []
    name, robot = next(iter(simulation.robots.items()))
    scan, odometry = absolute(robot.laser.parameters.laser_topic), absolute(robot.robot.parameters.odometry_topic)
    of = f", robot={name!r}" if name else ""
    return [
        f"Drop({scan!r}, probability=0.3)",
        f"Blackout({scan!r})",
        f"BlockedSector(-0.3, 0.3, distance=0.5, topic={scan!r})",
        f"StuckRanges({scan!r})",
        f"Delay({odometry!r}, 0.5)",
        f"Duplicate({odometry!r})",
        f"Reorder({scan!r})",
        f"Slip(0.5{of})",
        f"Push(0.2, 1.57{of})",
        f"OdometryDrift([0.1, 0.1, 0.1, 0.1, 0.0, 0.0]{of})",
        f"Outage('laser'{of})",
        "ClockJump(1.0)",
    ]
