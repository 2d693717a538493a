"""Ranges: what may differ between the worlds of a space, with units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..faults.reading import FAULTS, read_fault
from ..parameters import unknown_name
from ..quoting import quoted
from ..simulation.arguments import check_at_least_0, check_integers, check_numbers
from .checks import check_kinds

__all__ = ["Dimension", "FaultRange", "Free", "Moving", "Range"]

DIGITS = 3
"""Digits after the point to which drawn numbers are rounded, so that worlds are easy to read."""


class Dimension(NamedTuple):
    """One number that is drawn for a world."""

    name: str
    """What it is, such as "obstacle 1 radius"."""

    low: float
    """Smallest value."""

    high: float
    """Largest value."""

    unit: str
    """Unit; empty for counts, indices and shares."""


@dataclass(frozen=True)
class Range:
    """A number between two limits, rounded to 3 digits after the point.

    Args:
        low: Smallest value. Tests shrink towards 0 if it is in the range, else towards this limit.
        high: Largest value.
        unit: Unit of both, which must be that of what the range is for; empty if it is not said. Nothing is converted.

    Raises:
        ValueError: A limit is not finite, or the smaller one is larger than the other.
        TypeError: A limit is not a number.
    """

    low: float
    high: float
    unit: str = ""

    def __post_init__(self) -> None:
        """Checks the limits and the unit."""
        check_numbers(low=self.low, high=self.high)
        check_kinds("a text", str, unit=self.unit)
        if not -math.inf < self.low <= self.high < math.inf:
            raise ValueError(f"a range must have two finite limits, the smaller first, got {self.low} and {self.high}")


def check_unit(unit: str, /, **ranges: object) -> None:
    """Checks that ranges have a unit, or do not say theirs.

    Args:
        unit: The unit; empty for numbers without one.
        **ranges: The arguments, each under its name. What is not a range is passed over.

    Raises:
        ValueError: A range has another unit.
    """
    for name, limits in ranges.items():
        if isinstance(limits, Range) and limits.unit not in ("", unit):
            needed = f"be in {unit}" if unit else "have no unit"
            raise ValueError(f"{name} must {needed}, got {limits.unit}")


FULL_TURN = Range(-3.141, 3.141, "rad")


@dataclass(frozen=True)
class Free:
    """A position in free space, on a lattice of 0.25 m.

    Args:
        radius: Radius of the free space around it [m].
        yaw: Heading; used for starts only.

    Raises:
        ValueError: The radius is negative or not finite, or the heading is not in rad.
        TypeError: The radius is not a number, or the heading is not a `Range`.
    """

    radius: float = 0.5
    yaw: Range = FULL_TURN

    def __post_init__(self) -> None:
        """Checks the radius and the heading."""
        check_at_least_0(radius=self.radius)
        check_kinds("a scenarios.Range", Range, yaw=self.yaw)
        check_unit("rad", yaw=self.yaw)


@dataclass(frozen=True)
class Moving:
    """Obstacles: discs anywhere in free space that stand or move in straight lines.

    Args:
        at_most: Largest number of obstacles; there can be fewer, down to `at_least`.
        at_least: Smallest number. An obstacle that would be too near to the start is left out, so there can be fewer still.
        radius: Radius of each [m].
        speed: Speed of each [m/s].
        from_start: Smallest distance from the start to the edge of an obstacle [m].

    Raises:
        ValueError: A number is negative, a range has another unit, or `at_least` is larger than `at_most`.
        TypeError: An argument has a wrong type.
    """

    at_most: int
    at_least: int = 0
    radius: Range = Range(0.1, 0.3, "m")
    speed: Range = Range(0.0, 0.0, "m/s")
    from_start: float = 0.6

    def __post_init__(self) -> None:
        """Checks the numbers."""
        check_integers(0, at_most=self.at_most, at_least=self.at_least)
        check_kinds("a scenarios.Range", Range, radius=self.radius, speed=self.speed)
        check_unit("m", radius=self.radius)
        check_unit("m/s", speed=self.speed)
        check_at_least_0(at_least=self.at_least, from_start=self.from_start, radius=self.radius.low, speed=self.speed.low)
        if not self.at_least <= self.at_most <= 1000:
            raise ValueError(f"at_most must be {self.at_least} to 1000, got {quoted(self.at_most)}")


@dataclass(frozen=True)
class FaultRange:
    """A fault that a world can have: a class of `mobile_robot_simulator.faults` and its arguments.

    Args:
        kind: Name of the class, such as "Blackout".
        arguments: Arguments by name. Each is a value, a `Range` of values, or a sequence of both.
        duration: Range from which `end` follows: `start` + duration [s]. None: no `end`.
        chance: Share of the worlds that have the fault.

    Raises:
        ValueError: The class is unknown, it refuses the arguments, a time is not in s, or the share is not in 0..1.
        TypeError: An argument has a wrong type.

    Example:
        >>> from mobile_robot_simulator.scenarios import FaultRange, Range
        >>> fault = FaultRange("Blackout", {"topic": "/scan", "start": Range(0, 20, "s")}, duration=Range(1, 5, "s"))
    """

    kind: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    duration: Range | None = None
    chance: float = 0.5

    def __post_init__(self) -> None:
        """Checks the class, its arguments and the share."""
        check_kinds("the name of a fault such as 'Drop'", str, kind=self.kind)
        if self.kind not in FAULTS:
            raise ValueError(unknown_name(self.kind, FAULTS, kind="fault"))
        check_kinds("a mapping from names to values", Mapping, arguments=self.arguments)
        check_kinds("a scenarios.Range or None", Range | None, duration=self.duration)
        check_unit("s", duration=self.duration, start=self.arguments.get("start"), end=self.arguments.get("end"))
        check_numbers(chance=self.chance)
        if not 0.0 <= self.chance <= 1.0:
            raise ValueError(f"chance must be in 0..1, got {quoted(self.chance)}")
        for end in ("low", "high"):
            self._read(end)

    def _read(self, end: str) -> None:
        """Checks the fault with one end of each range."""
        read_fault(self.text(lambda _, limits: getattr(limits, end)))

    def text(self, number: Callable[[str, Range], float]) -> str:
        """Returns a fault as a text that `--fault` takes.

        Args:
            number: Returns the value of an argument from its name and its range.
        """
        arguments = {key: _drawn(key, value, number) for key, value in self.arguments.items()}
        if self.duration is not None:
            arguments["end"] = round(arguments.get("start", 0.0) + number("duration", self.duration), DIGITS)
        return f"{self.kind}({', '.join(f'{key}={value!r}' for key, value in arguments.items())})"


def _drawn(name: str, value: object, number: Callable[[str, Range], float]) -> Any:
    """Returns the value of an argument, with a number for each range in it."""
    if isinstance(value, Range):
        return number(name, value)
    if isinstance(value, list | tuple):
        return tuple(_drawn(f"{name} {index}", item, number) for index, item in enumerate(value, 1))
    return _plain(value)


def _plain(value: object) -> object:
    """Returns a number of NumPy as one of Python."""
    return value.item() if isinstance(value, np.generic) else value
