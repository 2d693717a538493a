"""Checks and conversions of the arguments of spaces and worlds. Errors name arguments as the caller gave them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from types import UnionType
from typing import Any, TypeVar

from .._core import Pose
from ..quoting import quoted
from ..simulation.arguments import to_pose

__all__ = ["check_kinds", "items_of", "to_goal", "to_place"]

T = TypeVar("T")


def check_kinds(needed: str, kind: type[Any] | UnionType, /, **values: object) -> None:
    """Checks the types of arguments.

    Args:
        needed: What they must be, for the error.
        kind: The type.
        **values: The arguments, each under its name.

    Raises:
        TypeError: One has another type.
    """
    for name, value in values.items():
        if not isinstance(value, kind):
            raise TypeError(f"{name} must be {needed}, got {quoted(value)}")


def items_of(name: str, needed: str, kind: type[T], values: Iterable[T]) -> tuple[T, ...]:
    """Returns the items of an argument as a tuple.

    Args:
        name: Name of the argument.
        needed: What each item must be, for the error.
        kind: The type of each item.
        values: The argument.

    Raises:
        TypeError: It is not iterable, or an item has another type.
    """
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise TypeError(f"{name} must be a sequence of {needed}, got {quoted(values)}")
    items = tuple(values)
    for number, item in enumerate(items):
        if not isinstance(item, kind):
            raise TypeError(f"{name}[{number}] must be a {needed}, got {quoted(item)}")
    return items


def to_place(start: Any) -> tuple[float, float, float]:
    """Returns the pose of a start as three finite numbers (x, y, yaw) [m, m, rad].

    Args:
        start: A `Pose`, or three numbers.

    Raises:
        TypeError: It is not a pose.
        ValueError: It is not three numbers, or one is not finite.
    """
    if isinstance(start, tuple) and [type(number) for number in start] == [float] * 3 and all(map(math.isfinite, start)):
        return start
    try:
        pose = to_pose(start, "start")
    except ValueError as error:
        raise ValueError(f"start must be three finite numbers (x, y, yaw), got {quoted(start)}") from error
    return pose.x, pose.y, pose.yaw


def to_goal(goal: Any) -> tuple[float, float]:
    """Returns the position of a goal as two finite numbers (x, y) [m].

    Args:
        goal: Two numbers.

    Raises:
        TypeError: It is not a sequence of numbers.
        ValueError: It is not two numbers, or one is not finite.
    """
    needed = "goal must be two finite numbers (x, y)"
    try:
        numbers = None if isinstance(goal, str | Pose) else tuple(map(float, goal))
    except (TypeError, ValueError):
        numbers = None
    if numbers is None:
        raise TypeError(f"{needed}, got {quoted(goal)}")
    if len(numbers) != 2 or not all(map(math.isfinite, numbers)):
        raise ValueError(f"{needed}, got {quoted(goal)}")
    return numbers[0], numbers[1]
