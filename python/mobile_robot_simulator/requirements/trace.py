"""Trace: the true course of one drive, sampled at equal times."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted
from ..simulation.ground_truth import GroundTruth
from ..simulation.simulation import Simulation

__all__ = ["PERIOD", "Trace"]

PERIOD = 0.1
"""Default time between two samples [s]."""

TOUCHING = 1e-6
"""Distance before a wall or an obstacle at which `advance` stops a robot [m]."""

REACH = 1.5
"""Upper limit of clearances [m]. In empty space, their cost grows with its square."""

MAX_SAMPLES = 1_000_000


class Trace:
    """The true course of a robot in a simulation, from when it was added until now, as samples.

    The first sample is at the start and the last at the present; the others are `period` apart. What happens only between
    two samples is not seen, as with `assert_clearance`.

    Args:
        sim: The simulation. It must not run on while the trace is in use.
        robot: Name of the robot; None for the first.
        period: Time between two samples [s].

    Attributes:
        period: Time between two samples [s].
        truth: Ground truth of the robot.
        goal: The goal of the simulation, (x, y) or (x, y, yaw) in the map frame, or None.
        times: (N,) float64, simulated times of the samples [s], increasing.

    Raises:
        ValueError: There is no such robot, the period is not positive and finite, or there would be too many samples.
    """

    def __init__(self, sim: Simulation, *, robot: str | None = None, period: float = PERIOD) -> None:
        if not 0.0 < period < math.inf:
            raise ValueError(f"the period must be positive and finite, got {quoted(period)} s")
        self.period = period
        self.truth: GroundTruth = sim.named(robot).truth
        self.goal = sim.goal
        start, end = self.truth.start, sim.time
        count = math.floor((end - start) / period + 1e-6) + 1
        if count > MAX_SAMPLES:
            raise ValueError(
                f"a trace must have at most {MAX_SAMPLES} samples, got {end - start:g} s in steps of {period:g} s"
            )
        times = np.minimum(start + np.arange(count) * period, end)
        self.times: NDArray[np.float64] = times if end - times[-1] < 1e-6 * period else np.append(times, end)

    @cached_property
    def poses(self) -> NDArray[np.float64]:
        """(N, 3) float64, poses x, y [m], yaw [rad] in the map frame."""
        return self.truth.poses_at(self.times)

    @cached_property
    def velocities(self) -> NDArray[np.float64]:
        """(N, 3) float64, velocities vx, vy [m/s], wz [rad/s] in the robot's frame."""
        return self.truth.velocities_at(self.times)

    @cached_property
    def clearances(self) -> NDArray[np.float64]:
        """(N,) float64, distances from the footprint to the nearest wall, obstacle or robot [m], at most `REACH`.

        A distance is 0 while the robot touches something, and in the first sample after a contact began.
        """
        clearances = self.truth.clearances(np.column_stack((self.times, self.poses)), REACH)
        clearances[clearances <= TOUCHING] = 0.0
        began = np.searchsorted(self.times, self.truth.contact_times)
        clearances[began[began < len(clearances)]] = 0.0
        return clearances
