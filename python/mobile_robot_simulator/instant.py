"""Time as nodes on the bus see it: moments, durations and the clock, under rclpy's names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

from .messages import Time

if TYPE_CHECKING:
    pass

NANOSECONDS = 1_000_000_000


@dataclass(frozen=True, order=True, init=False)
class Duration:
    """A span of time."""

    nanoseconds: int

    def __init__(self, *, seconds: float = 0.0, nanoseconds: int = 0) -> None:
        object.__setattr__(self, "nanoseconds", round(seconds * NANOSECONDS) + int(nanoseconds))

    def __reduce__(self) -> tuple[Any, ...]:
        return _duration, (self.nanoseconds,)


def _duration(nanoseconds: int) -> Duration:
    return Duration(nanoseconds=nanoseconds)


@dataclass(frozen=True, order=True, slots=True, init=False)
class Instant:
    """A moment of the bus's clock."""

    nanoseconds: int

    def __init__(self, nanoseconds: int = 0, *, seconds: float = 0.0, **_: Any) -> None:
        object.__setattr__(self, "nanoseconds", nanoseconds + round(seconds * NANOSECONDS) if seconds else nanoseconds)

    def to_msg(self) -> Time:
        """The moment as a message."""
        return Time.from_nanoseconds(self.nanoseconds)

    @classmethod
    def from_msg(cls, msg: Time) -> Instant:
        """The moment that a message names."""
        return cls(msg.nanoseconds)

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Whole seconds, and the nanoseconds beyond them."""
        return divmod(self.nanoseconds, NANOSECONDS)

    def __add__(self, span: Duration) -> Instant:
        return Instant(self.nanoseconds + span.nanoseconds)

    @overload
    def __sub__(self, other: Instant) -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> Instant: ...
    def __sub__(self, other: Instant | Duration) -> Instant | Duration:
        left = self.nanoseconds - other.nanoseconds
        return Duration(nanoseconds=left) if isinstance(other, Instant) else Instant(left)
