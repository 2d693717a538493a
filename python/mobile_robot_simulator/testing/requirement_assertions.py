"""Assertions that a drive so far keeps a requirement of `mobile_robot_simulator.requirements`.

Example:
    >>> import numpy as np
    >>> import mobile_robot_simulator as mrs
    >>> from mobile_robot_simulator.requirements import clearance
    >>> from mobile_robot_simulator.testing import assert_always
    >>> cells = np.zeros((100, 100), np.int8)
    >>> cells[:, 50:] = 100
    >>> grid = mrs.OccupancyGrid(cells, resolution=0.1)
    >>> sim = mrs.Simulation(grid, start=(1.0, 5.0, 0.0), parameters={"robot_radius": 0.25, "velocity_timeout": 0.0})
    >>> sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5)))
    >>> sim.run_for(6.0)
    >>> assert_always(sim, clearance > 0.2)
    >>> sim.run_for(2.0)
    >>> assert_always(sim, clearance > 0.2)
    Traceback (most recent call last):
    AssertionError: the robot violated always(clearance > 0.2 m), at worst by 0.2
      worst: at (4.750, 5.000) at 7.500 s
      violated at 9 of 81 samples, first at 7.200 s
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..requirements.formula import Requirement, always, checked
from ..requirements.trace import PERIOD, Trace
from .assertions import fail, point_of

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation

__all__ = ["assert_always", "assert_holds"]


def assert_always(sim: Simulation, requirement: Requirement, *, robot: str | None = None, period: float = PERIOD) -> None:
    """Checks that a requirement has held at all times of the drive so far.

    Args:
        sim: The simulation.
        requirement: The requirement, such as `clearance > 0.2`.
        robot: Name of the robot; None for the first.
        period: Time between two samples of the drive [s].

    Raises:
        AssertionError: The requirement was violated. The message gives the place and time of the worst violation, and the
            time of the first.
        TypeError: It is not a requirement.
        ValueError: A signal needs something that the drive does not have, or `Trace` refuses an argument.
    """
    __tracebackhide__ = True
    named, trace = always(requirement), Trace(sim, robot=robot, period=period)
    margins = requirement.over_time(trace)
    worst, violated = int(np.argmin(margins)), margins <= 0.0
    if violated.any():
        row = np.array([trace.times[worst], *trace.poses[worst]])
        fail(
            sim,
            f"{sim.named(robot).title} violated {named}, at worst by {-margins[worst]:.4g}\n"
            f"  worst: {point_of(row)}\n"
            f"  violated at {int(violated.sum())} of {len(margins)} samples, first at {trace.times[violated][0]:.3f} s",
        )


def assert_holds(sim: Simulation, requirement: Requirement, *, robot: str | None = None, period: float = PERIOD) -> None:
    """Checks that a requirement holds for the drive so far, seen from its start.

    Args:
        sim: The simulation.
        requirement: The requirement, such as `eventually(goal_distance < 0.5, within=(0.0, 60.0))`.
        robot: Name of the robot; None for the first.
        period: Time between two samples of the drive [s].

    Raises:
        AssertionError: The requirement was violated. The message says by how much, and where the drive ended.
        TypeError: It is not a requirement.
        ValueError: A signal needs something that the drive does not have, or `Trace` refuses an argument.
    """
    __tracebackhide__ = True
    trace = Trace(sim, robot=robot, period=period)
    margin = checked(requirement).robustness(trace)
    if margin <= 0.0:
        row = np.array([trace.times[-1], *trace.poses[-1]])
        fail(sim, f"{sim.named(robot).title} violated {requirement} by {-margin:.4g}\n  end: {point_of(row)}")
