"""Disturbances: what the world can do to a robot while it drives, and no sensor shows."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from operator import index

from ..quoting import quoted
from ..simulation.arguments import check_integers
from .checks import check_kinds
from .ranges import FULL_TURN, FaultRange, Range, check_unit

__all__ = ["Disturbance", "Drift", "Pushes", "Slips"]

SECONDS, SPEED, SHARE, ALPHA = Range(0.5, 3.0, "s"), Range(0.05, 0.3, "m/s"), Range(0.1, 0.5), Range(0.0, 0.02)


@dataclass(frozen=True)
class Disturbance(ABC):
    """A kind of disturbance that a world can have several times. Each becomes one of the faults of the world."""

    at_most: int
    at_least: int = 0

    def __post_init__(self) -> None:
        """Checks the numbers."""
        check_integers(0, at_most=self.at_most, at_least=self.at_least)
        if not index(self.at_least) <= index(self.at_most) <= 1000:
            raise ValueError(f"at_most must be {self.at_least} to 1000, got {quoted(self.at_most)}")
        self.fault(1.0)

    @abstractmethod
    def fault(self, duration: float, seed: int = 0) -> FaultRange:
        """Returns the range of one of them.

        Args:
            duration: Longest duration of the drive [s].
            seed: Seed of the fault, if it needs one.
        """

    @property
    def is_seeded(self) -> bool:
        """True if the fault needs a seed."""
        return False


@dataclass(frozen=True)
class _Passing(Disturbance):
    """A disturbance that begins and ends during the drive."""

    start: Range | None = None
    duration: Range = SECONDS

    def __post_init__(self) -> None:
        check_kinds("a scenarios.Range or None", Range | None, start=self.start)
        check_kinds("a scenarios.Range", Range, duration=self.duration)
        super().__post_init__()

    def _start(self, duration: float) -> Range:
        return Range(0.0, duration, "s") if self.start is None else self.start


@dataclass(frozen=True)
class Pushes(_Passing):
    """Pushes of the robot, as by wind, a slope or a person; see `faults.Push`.

    Args:
        at_most: Largest number of pushes; there can be fewer, down to `at_least`.
        at_least: Smallest number.
        start: When each begins [s]; None for any time of the drive.
        duration: How long each lasts [s].
        speed: Speed of each, added to the velocity of the robot [m/s].
        direction: Direction of each in the map frame [rad].

    Raises:
        ValueError: A range has values that `faults.Push` refuses, or `at_least` is larger than `at_most`.
        TypeError: An argument has a wrong type.

    Example:
        >>> from mobile_robot_simulator.scenarios import Pushes, Range, Space
        >>> pushes = Pushes(1, speed=Range(0.1, 0.4, "m/s"))
        >>> space = Space(start=(2.0, 2.0, 0.0), goal=None, disturbances=[pushes], is_noisy=False)
        >>> [dimension.name for dimension in space.dimensions[:2]]
        ['disturbance 1 Push', 'disturbance 1 Push 1 start']
        >>> space.world([0.9, 0.5, 0.5, 0.5, 0.2]).faults
        ('Push(start=15.0, speed=0.25, direction=0.0, end=16.0)',)
    """

    speed: Range = SPEED
    direction: Range = FULL_TURN

    def __post_init__(self) -> None:
        """Checks the arguments."""
        check_kinds("a scenarios.Range", Range, speed=self.speed, direction=self.direction)
        check_unit("m/s", speed=self.speed)
        check_unit("rad", direction=self.direction)
        super().__post_init__()

    def fault(self, duration: float, seed: int = 0) -> FaultRange:
        """Returns the range of one push."""
        arguments = {"start": self._start(duration), "speed": self.speed, "direction": self.direction}
        return FaultRange("Push", arguments, self.duration)


@dataclass(frozen=True)
class Slips(_Passing):
    """Slipping wheels, as on ice or dust; see `faults.Slip`.

    Args:
        at_most: Largest number of slips; there can be fewer, down to `at_least`.
        at_least: Smallest number.
        start: When each begins [s]; None for any time of the drive.
        duration: How long each lasts [s].
        share: Share of the motion that is lost.

    Raises:
        ValueError: A range has values that `faults.Slip` refuses, or `at_least` is larger than `at_most`.
        TypeError: An argument has a wrong type.
    """

    share: Range = SHARE

    def __post_init__(self) -> None:
        """Checks the arguments."""
        check_kinds("a scenarios.Range", Range, share=self.share)
        check_unit("", share=self.share)
        super().__post_init__()

    def fault(self, duration: float, seed: int = 0) -> FaultRange:
        """Returns the range of one slip."""
        return FaultRange("Slip", {"start": self._start(duration), "share": self.share}, self.duration)


@dataclass(frozen=True)
class Drift(Disturbance):
    """Odometry that drifts during the whole drive; see `faults.OdometryDrift`. A space has at most one `Drift`.

    Args:
        at_most: 1, or 0 for worlds without drift.
        at_least: 1 if all worlds have it.
        alphas: The six noise parameters alpha1 to alpha6 of the odometry. Each is a number, or a `Range` of numbers.

    Raises:
        ValueError: There are not six numbers, `faults.OdometryDrift` refuses them, or `at_most` is larger than 1.
        TypeError: An argument has a wrong type.
    """

    at_most: int = 1
    alphas: Sequence[float | Range] = (ALPHA, ALPHA, ALPHA, ALPHA, 0.0, 0.0)

    def __post_init__(self) -> None:
        """Checks the arguments."""
        check_integers(0, at_most=self.at_most)
        if self.at_most > 1:
            raise ValueError(
                f"at_most must be 0 or 1, because drifts of one robot cannot overlap, got {quoted(self.at_most)}"
            )
        super().__post_init__()

    def fault(self, duration: float, seed: int = 0) -> FaultRange:
        """Returns the range of the drift."""
        return FaultRange("OdometryDrift", {"alphas": self.alphas, **({"seed": seed} if seed else {})})

    @property
    def is_seeded(self) -> bool:
        """True: drift is random."""
        return True
