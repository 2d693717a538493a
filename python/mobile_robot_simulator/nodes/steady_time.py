"""SteadyTime: the time of a world, which follows a clock but does not jump with it."""

from __future__ import annotations

from .interface import Clock

MAX_STEP_NS = 3_600_000_000_000
"""A clock that moves on by more than this between two readings has jumped [ns]."""


class SteadyTime:
    """Time that passes as on a clock, except when the clock jumps: then no time passes.

    The clock of ROS jumps back when a recording is played again, and forward when the first time arrives on /clock.
    Motion must neither end nor be repeated because of that.

    Args:
        clock: Clock to follow.

    Example:
        >>> from mobile_robot_simulator.instant import Instant
        >>> class Watch:
        ...     seconds = 5
        ...     def now(self):
        ...         return Instant(self.seconds * 1_000_000_000)
        >>> watch = Watch()
        >>> time = SteadyTime(watch)
        >>> for watch.seconds in (6, 1, 2):
        ...     print(time())
        6000000000
        6000000000
        7000000000
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._last_ns = self._now_ns = clock.now().nanoseconds

    def __call__(self) -> int:
        """Returns the time [ns]. It never decreases."""
        last_ns, self._last_ns = self._last_ns, self._clock.now().nanoseconds
        elapsed_ns = self._last_ns - last_ns
        if 0 <= elapsed_ns <= MAX_STEP_NS:
            self._now_ns += elapsed_ns
        return self._now_ns
