"""Signals: numbers over time that requirements compare with limits."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted
from ..simulation.arguments import check_numbers
from .formula import Comparison
from .trace import REACH, Trace

__all__ = [
    "Signal",
    "acceleration",
    "clearance",
    "distance_to",
    "goal_distance",
    "inside",
    "jerk",
    "speed",
    "time_to_contact",
    "turn_rate",
]


@dataclass(frozen=True)
class Signal:
    """A number over time. `signal > limit` and `signal < limit` are requirements.

    Args:
        name: Name in messages.
        unit: Unit of the values, such as "m/s".
        measure: Returns the value at each sample of a trace, (N,) float64. It must not be NaN. For searches with several
            processes it must be a function of a module.
        most: Upper limit of the values; limits of requirements must be below it.

    Example:
        >>> from mobile_robot_simulator.requirements import Signal
        >>> sideways = Signal("sideways", "m/s", lambda trace: abs(trace.velocities[:, 1]))
        >>> sideways < 0.1
        sideways < 0.1 m/s
    """

    name: str
    unit: str
    measure: Callable[[Trace], NDArray[np.float64]]
    most: float = math.inf

    def __repr__(self) -> str:
        return self.name

    def __gt__(self, limit: float) -> Comparison:
        return self._compared(limit, is_above=True)

    def __lt__(self, limit: float) -> Comparison:
        return self._compared(limit, is_above=False)

    def __bool__(self) -> bool:
        raise TypeError(f"signal {self.name} has no truth value; compare it with a limit: {self.name} > 0.2")

    def _compared(self, limit: float, *, is_above: bool) -> Comparison:
        check_numbers(limit=limit)
        if not math.isfinite(limit):
            raise ValueError(f"the limit of {self.name} must be finite, got {quoted(limit)}")
        if limit >= self.most:
            raise ValueError(
                f"{self.name} is measured up to {self.most:g} {self.unit}, so its limit must be less, got {limit}"
            )
        return Comparison(self.name, self.unit, self.measure, float(limit), is_above)


def distance_to(x: float, y: float) -> Signal:
    """Returns the signal of the distance from the robot's origin to a point of the map frame [m].

    Args:
        x: Position of the point along x [m].
        y: Position along y [m].

    Raises:
        TypeError: A coordinate is not a number.
        ValueError: A coordinate is not finite.
    """
    _check_finite(x=x, y=y)
    return Signal(f"distance_to({x:g}, {y:g})", "m", partial(_distances, x=x, y=y))


def inside(x_min: float, y_min: float, x_max: float, y_max: float) -> Signal:
    """Returns the signal of how far the robot's origin is inside a rectangle [m]; negative outside.

    It is the distance along x or y to the nearest side. Outside it is the larger one of the distances beyond a side along x
    and along y, negative.

    Args:
        x_min: Left side in the map frame [m].
        y_min: Lower side [m].
        x_max: Right side [m].
        y_max: Upper side [m].

    Raises:
        TypeError: A side is not a number.
        ValueError: A side is not finite, or the rectangle is empty.
    """
    _check_finite(x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max)
    if not (x_min < x_max and y_min < y_max):
        raise ValueError(f"the rectangle must not be empty, got x {x_min} to {x_max} and y {y_min} to {y_max}")

    return Signal(
        f"inside({x_min:g}, {y_min:g}, {x_max:g}, {y_max:g})",
        "m",
        partial(_depths, x_min=x_min, y_min=y_min, x_max=x_max, y_max=y_max),
    )


def _check_finite(**values: float) -> None:
    check_numbers(**values)
    for name, value in values.items():
        if not math.isfinite(value):
            raise ValueError(f"{name} must be finite, got {quoted(value)}")


def _distances(trace: Trace, x: float, y: float) -> NDArray[np.float64]:
    return np.hypot(trace.poses[:, 0] - x, trace.poses[:, 1] - y)


def _depths(trace: Trace, x_min: float, y_min: float, x_max: float, y_max: float) -> NDArray[np.float64]:
    x, y = trace.poses[:, 0], trace.poses[:, 1]
    return np.minimum(np.minimum(x - x_min, x_max - x), np.minimum(y - y_min, y_max - y))


def _goal_distances(trace: Trace) -> NDArray[np.float64]:
    if trace.goal is None:
        raise ValueError("goal_distance needs a goal: set Simulation.goal, or use distance_to(x, y)")
    return _distances(trace, trace.goal[0], trace.goal[1])


def _clearances(trace: Trace) -> NDArray[np.float64]:
    return trace.clearances


def _turn_rates(trace: Trace) -> NDArray[np.float64]:
    return np.abs(trace.velocities[:, 2])


def _times_to_contact(trace: Trace) -> NDArray[np.float64]:
    return trace.truth.times_to_contact(trace.times)


def _speeds(trace: Trace) -> NDArray[np.float64]:
    return np.hypot(trace.velocities[:, 0], trace.velocities[:, 1])


def _changes(values: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the rate at which each value has changed since the sample before; 0 for the first."""
    rates = np.zeros_like(values)
    rates[1:] = np.diff(values, axis=0) / np.diff(times).reshape(-1, *[1] * (values.ndim - 1))
    return rates


def _accelerations(trace: Trace) -> NDArray[np.float64]:
    rates = _changes(trace.velocities, trace.times)
    return np.hypot(rates[:, 0], rates[:, 1])


def _jerks(trace: Trace) -> NDArray[np.float64]:
    rates = _changes(_changes(trace.velocities, trace.times), trace.times)
    return np.hypot(rates[:, 0], rates[:, 1])


clearance = Signal("clearance", "m", _clearances, most=REACH)
"""Distance from the footprint to the nearest wall, obstacle or robot [m], at most 1.5 m. See `GroundTruth.clearances`."""

goal_distance = Signal("goal_distance", "m", _goal_distances)
"""Distance from the robot's origin to `Simulation.goal` [m]."""

speed = Signal("speed", "m/s", _speeds)
"""Linear speed [m/s]."""

turn_rate = Signal("turn_rate", "rad/s", _turn_rates)
"""Absolute turn rate [rad/s]."""

acceleration = Signal("acceleration", "m/s^2", _accelerations)
"""Absolute change of the linear velocity in the robot's frame since the sample before, per second [m/s^2]; first 0.

A jump of the velocity, of a robot without acceleration limits, counts as a change that takes one period of the trace.
"""

jerk = Signal("jerk", "m/s^3", _jerks)
"""Absolute change of the acceleration since the sample before, per second [m/s^3], as for `acceleration`; first 0."""

time_to_contact = Signal("time_to_contact", "s", _times_to_contact, most=10.0)
"""Time until the robot touches something if it keeps its velocity [s], at most 10 s. See `GroundTruth.times_to_contact`."""
