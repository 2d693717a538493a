"""Checks and conversions of arguments that users pass: numbers, durations and poses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from operator import index
from typing import SupportsIndex

from .._core import Pose
from ..instant import NANOSECONDS
from ..physics.obstacles import PoseLike
from ..physics.velocity_profile import Velocity
from ..quoting import quoted

MAX_VELOCITY = 1e3
"""Limit of each component of a velocity [m/s, rad/s]."""

LONGEST = 2**62 / NANOSECONDS
"""Longest duration, 146 years [s]. The core counts nanoseconds in 64 bits."""


def check_numbers(**values: float) -> None:
    """Checks that arguments are numbers.

    Args:
        **values: Numbers, each under the name that the error message uses.

    Raises:
        TypeError: One is not a number.
    """
    for name, value in values.items():
        if not isinstance(value, Real):
            raise TypeError(f"{name} must be a number, got {quoted(value)}")


def check_integers(least: int, /, **values: object) -> None:
    """Checks that arguments are integers that are not too small.

    Args:
        least: Smallest value that is allowed.
        **values: Integers, each under the name that the error message uses.

    Raises:
        TypeError: One is not an integer.
        ValueError: One is smaller.
    """
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, SupportsIndex):
            raise TypeError(f"{name} must be an integer, got {quoted(value)}")
        if index(value) < least:
            raise ValueError(f"{name} must be at least {least}, got {quoted(value)}")


def check_at_least_0(**values: float) -> None:
    """Checks that numbers are finite and not negative.

    Args:
        **values: Numbers, each under the name that the error message uses.

    Raises:
        TypeError: One is not a number.
        ValueError: A number is negative, infinite or NaN.
    """
    check_numbers(**values)
    for name, value in values.items():
        if not 0.0 <= value < math.inf:
            raise ValueError(f"{name} must be finite and at least 0, got {quoted(value)}")


def check_parameters(values: object) -> None:
    """Checks that parameters are given as a mapping, or not at all.

    Args:
        values: The parameters, or None.

    Raises:
        TypeError: They are something else.
    """
    if not isinstance(values, Mapping | None):
        raise TypeError(f"parameters must be a mapping from names to values, got {quoted(values)}")


def to_nanoseconds(seconds: float, what: str) -> int:
    """Returns a duration in nanoseconds, rounded to the nearest.

    Args:
        seconds: Duration [s].
        what: Name of the duration in the error message.

    Raises:
        TypeError: It is not a number.
        ValueError: The duration is negative, infinite, NaN or longer than `LONGEST`.
    """
    if type(seconds) is not float and not isinstance(seconds, Real):  # the second one takes longer
        raise TypeError(f"{what} must be a number of seconds, got {quoted(seconds)}")
    if not 0.0 <= seconds < math.inf:
        raise ValueError(f"{what} must be finite and at least 0 s, got {quoted(seconds)}")
    if seconds > LONGEST:
        raise ValueError(f"{what} must be at most {LONGEST:.4g} s, got {quoted(seconds)}")
    return round(seconds * NANOSECONDS)


def to_pose(pose: PoseLike, what: str) -> Pose:
    """Converts a pose to a `Pose`.

    Args:
        pose: A `Pose`, or x [m], y [m] and yaw [rad].
        what: Name of the pose in the error message.

    Raises:
        TypeError: It is not a sequence of numbers.
        ValueError: It is not three numbers, or one is not finite.
    """
    return pose if isinstance(pose, Pose) else Pose(*_three_numbers(pose, f"{what} must be three numbers (x, y, yaw)"))


def to_velocity(velocity: Sequence[float], what: str) -> Velocity:
    """Converts a velocity (vx [m/s], vy [m/s], wz [rad/s]) to a tuple of floats.

    Args:
        velocity: The velocity.
        what: Name of the velocity in the error message.

    Raises:
        TypeError: It is not a sequence of numbers.
        ValueError: It is not three numbers, or one is not finite or larger than `MAX_VELOCITY`.
    """
    needed = f"{what} must be three numbers (vx, vy, wz) of at most {MAX_VELOCITY:g}"
    vx, vy, wz = _three_numbers(velocity, needed)
    if not all(abs(number) <= MAX_VELOCITY for number in (vx, vy, wz)):
        raise ValueError(f"{needed}, got {quoted(velocity)}")
    return vx, vy, wz


def _three_numbers(values: object, needed: str) -> tuple[float, ...]:
    try:
        numbers = None if isinstance(values, str) else tuple(float(number) for number in values)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        numbers = None
    if numbers is None or len(numbers) != 3:
        kind = TypeError if numbers is None else ValueError
        raise kind(f"{needed}, got {quoted(values)}")
    return numbers
