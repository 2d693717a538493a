"""Instants and durations of the simulated clock, with the interface of `rclpy.time.Time` and `rclpy.duration.Duration`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, overload

from . import messages
from .messages import Time

NANOSECONDS = 1_000_000_000
"""Nanoseconds per second."""


@dataclass(frozen=True, order=True, init=False)
class Duration:
    """A span of time, with the interface of `rclpy.duration.Duration`.

    Args:
        seconds: Length [s], rounded to nanoseconds.
        nanoseconds: Length [ns], added to `seconds`.
    """

    nanoseconds: int
    """Length [ns]."""

    def __init__(self, *, seconds: float = 0.0, nanoseconds: int = 0) -> None:
        object.__setattr__(self, "nanoseconds", round(seconds * NANOSECONDS) + int(nanoseconds))

    def to_msg(self) -> messages.Duration:
        """Returns the span as a message."""
        return messages.Duration.from_nanoseconds(self.nanoseconds)

    @classmethod
    def from_msg(cls, msg: messages.Duration) -> Duration:
        """Returns the span that a message holds.

        Args:
            msg: The message.
        """
        return cls(nanoseconds=msg.nanoseconds)

    def __reduce__(self) -> tuple[Any, ...]:
        return _duration, (self.nanoseconds,)


def _duration(nanoseconds: int) -> Duration:
    return Duration(nanoseconds=nanoseconds)


@dataclass(frozen=True, order=True, slots=True, init=False)
class Instant:
    """A point in simulated time, with the interface of `rclpy.time.Time`.

    Args:
        nanoseconds: Time [ns].
        seconds: Time [s], rounded to nanoseconds and added to `nanoseconds`.
        **_: Other arguments of `rclpy.time.Time`, such as `clock_type`, are ignored.
    """

    nanoseconds: int
    """Time [ns]."""

    def __init__(self, nanoseconds: int = 0, *, seconds: float = 0.0, **_: Any) -> None:
        _set_nanoseconds(self, nanoseconds + round(seconds * NANOSECONDS) if seconds else nanoseconds)

    def to_msg(self) -> Time:
        """Returns the time as a message."""
        return Time.from_nanoseconds(self.nanoseconds)

    @classmethod
    def from_msg(cls, msg: Time) -> Instant:
        """Returns the time that a message holds.

        Args:
            msg: The message.
        """
        return cls(msg.nanoseconds)

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Returns the whole seconds and the remaining nanoseconds."""
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


_set_nanoseconds = Instant.__dict__["nanoseconds"].__set__
"""Sets the field of a new `Instant`. Clocks make many, and this is twice as fast as `object.__setattr__`."""

_new_instant = partial(object.__new__, Instant)


def instant_at(nanoseconds: int) -> Instant:
    """Returns `Instant(nanoseconds)` in half the time, for clocks.

    Args:
        nanoseconds: Time [ns].
    """
    instant = _new_instant()
    _set_nanoseconds(instant, nanoseconds)
    return instant
