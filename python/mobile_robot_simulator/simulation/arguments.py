"""Checks and conversions of arguments that users pass: numbers, durations and poses."""

from __future__ import annotations

import math
from numbers import Real

from .._core import Pose
from ..instant import NANOSECONDS
from ..physics.obstacles import PoseLike
from ..quoting import quoted


def check_at_least_0(**values: float) -> None:
    """Checks that numbers are finite and not negative.

    Args:
        **values: Numbers, each under the name that the error message uses.

    Raises:
        ValueError: A number is negative, infinite or NaN.
    """
    for name, value in values.items():
        if not 0.0 <= value < math.inf:
            raise ValueError(f"{name} must be finite and at least 0, got {quoted(value)}")


def to_nanoseconds(seconds: float, what: str) -> int:
    """Returns a duration in nanoseconds, rounded to the nearest.

    Args:
        seconds: Duration [s].
        what: Name of the duration in the error message.

    Raises:
        TypeError: It is not a number.
        ValueError: The duration is negative, infinite or NaN.
    """
    if not isinstance(seconds, Real):
        raise TypeError(f"{what} must be a number of seconds, got {quoted(seconds)}")
    if not 0.0 <= seconds < math.inf:
        raise ValueError(f"{what} must be finite and at least 0 s, got {quoted(seconds)}")
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
    if isinstance(pose, Pose):
        return pose
    try:
        numbers = None if isinstance(pose, str) else [float(number) for number in pose]
    except (TypeError, ValueError):
        numbers = None
    if numbers is None or len(numbers) != 3:
        kind = TypeError if numbers is None else ValueError
        raise kind(f"{what} must be three numbers (x, y, yaw), got {quoted(pose)}")
    return Pose(*numbers)
