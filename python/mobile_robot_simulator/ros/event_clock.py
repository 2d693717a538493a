"""EventClock: a clock that stands still during a callback, at the time of the event that the callback handles."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from operator import itemgetter

from ..instant import NANOSECONDS, Instant
from ..nodes.interface import Clock
from ..nodes.steady_time import MAX_STEP_NS
from .paced_clock import PacedClock

POLL_PERIOD = 0.002
"""Largest time between two readings of a clock that ROS controls [s]. Such a clock may change its speed or jump."""


class EventClock:
    """Clock that goes from event to event, as simulated time does on the in-process bus.

    An event is a multiple of a timer's period, or the start of another callback. Between two calls of `advance` the time
    stands still, so everything that one callback computes is valid at one time. Timers read exactly the multiple at which
    they were due, although they are called a little later. Hence nodes stamp the same times if their rates have common
    multiples, in one process and across processes.

    The time decreases only if the source jumps back.

    Args:
        source: Clock to follow.

    Attributes:
        source: Clock to follow.
        timers: Timers that follow this clock, in the order of their creation.
    """

    def __init__(self, source: Clock) -> None:
        self.source = source
        self.timers: list[EventTimer | EventAlarm] = []
        self._event_ns = self._read()

    def now(self) -> Instant:
        """Returns the time of the current event."""
        return Instant(self._event_ns)

    def advance(self) -> None:
        """Fires all timers that are due, in the order of their times, and then goes on to the present of the source.

        Timers that are due at the same time fire in the order of their creation. A timer that has missed several multiples
        fires only once, at the latest one.
        """
        now_ns = self._read()
        due = [(timer.last_multiple(now_ns), timer) for timer in tuple(self.timers) if timer.is_due(now_ns)]
        for self._event_ns, timer in sorted(due, key=itemgetter(0)):
            timer.fire(now_ns)
        self._event_ns = now_ns

    def due_in(self) -> float:
        """Returns the wall time until a timer may be due [s], infinite without timers.

        If ROS controls the clock, the time is at most `POLL_PERIOD`.
        """
        if not self.timers:
            return math.inf
        now_ns = self._read()
        left = min(timer.time_left(now_ns) for timer in self.timers) / NANOSECONDS
        return left / self.source.speed if isinstance(self.source, PacedClock) else min(left, POLL_PERIOD)

    def create_timer(self, period: float, callback: Callable[[], None]) -> EventTimer:
        """Creates a timer that fires at every multiple of `period` [s] from now on."""
        timer = EventTimer(self, period, callback, self._read())
        self.timers.append(timer)
        return timer

    def create_alarm(self, delay_ns: int, callback: Callable[[], None]) -> EventAlarm:
        """Creates an alarm that goes off once, after a delay [ns]."""
        alarm = EventAlarm(self, self._read() + delay_ns, callback, self._read())
        self.timers.append(alarm)
        return alarm

    def _read(self) -> int:
        return self.source.now().nanoseconds


class EventTimer:
    """Timer that fires at each multiple of its period on a clock. If it has missed several multiples, it fires only once.

    Args:
        clock: Clock that the timer follows.
        period: Period on that clock [s].
        callback: Function to call.
        now_ns: Time of the clock's source [ns].

    Attributes:
        clock: Clock that the timer follows.
    """

    def __init__(self, clock: EventClock, period: float, callback: Callable[[], None], now_ns: int) -> None:
        self.clock, self._callback = clock, callback
        # A ratio of integers, so that the multiples of 1/30 s include every full second, at any time of the clock.
        self._period = Fraction(period).limit_denominator(NANOSECONDS) * NANOSECONDS
        self._is_cancelled = False
        self._next_ns = self.next_multiple(now_ns)

    def cancel(self) -> None:
        """Never fires again."""
        self._is_cancelled = True

    def time_left(self, now_ns: int) -> int:
        """Returns the time until the timer is due [ns], 0 if it is due or if the clock has jumped back."""
        return 0 if self._is_ahead(now_ns) else max(0, self._next_ns - now_ns)

    def is_due(self, now_ns: int) -> bool:
        """Returns True if the timer must fire now. After a jump back of the clock, the next multiple becomes due."""
        if self._is_ahead(now_ns):
            self._next_ns = self.next_multiple(now_ns)
        return self._next_ns <= now_ns

    def fire(self, now_ns: int) -> None:
        """Calls the callback, unless the timer was cancelled. The timer is due again at the next multiple."""
        self._next_ns = self.next_multiple(now_ns)
        if not self._is_cancelled:
            self._callback()

    def last_multiple(self, now_ns: int) -> int:
        """Returns the last multiple up to a time, rounded up to nanoseconds."""
        return math.ceil(now_ns // self._period * self._period)

    def next_multiple(self, now_ns: int) -> int:
        """Returns the first multiple after a time, rounded up to nanoseconds."""
        return math.ceil((now_ns // self._period + 1) * self._period)

    def _is_ahead(self, now_ns: int) -> bool:
        # Rounding can add up to 1 ns to the period.
        return self._next_ns - now_ns > self._period + 1


class EventAlarm:
    """Alarm that goes off once. If the clock jumps back to before the alarm was set, it goes off at once.

    Args:
        clock: Clock that the alarm follows.
        time_ns: Time at which it goes off [ns].
        callback: Function to call.
        now_ns: Time of the clock's source [ns].

    Attributes:
        clock: Clock that the alarm follows.
    """

    def __init__(self, clock: EventClock, time_ns: int, callback: Callable[[], None], now_ns: int) -> None:
        self.clock, self._callback = clock, callback
        self._time_ns, self._set_ns = time_ns, now_ns
        self._is_over = False

    def cancel(self) -> None:
        """Never goes off."""
        self._is_over = True

    def time_left(self, now_ns: int) -> int:
        """Returns the time until the alarm goes off [ns]."""
        return 0 if now_ns < self._set_ns else max(0, self._time_ns - now_ns)

    def is_due(self, now_ns: int) -> bool:
        """Returns True if the alarm must go off now."""
        return not self.time_left(now_ns)

    def last_multiple(self, now_ns: int) -> int:
        """Returns the time at which the alarm was due; the present if the clock has jumped meanwhile."""
        return self._time_ns if 0 <= now_ns - self._time_ns <= MAX_STEP_NS else now_ns

    def fire(self, now_ns: int) -> None:
        """Calls the callback, unless the alarm was cancelled or has gone off before."""
        if not self._is_over:
            self._is_over = True
            self._callback()
