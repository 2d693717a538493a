"""Timers of the bus: periodic callbacks on simulated time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, SupportsFloat

from ..handle import Handle, check_callback
from ..instant import NANOSECONDS
from ..quoting import quoted


class TimerQueue(Protocol):
    """What a timer needs from the bus.

    Attributes:
        time_ns: Simulated time [ns].
        timers: All timers, in the order in which they were created.
    """

    time_ns: int
    timers: dict[BusTimer, None]

    def next_timer_order(self) -> int:
        """Returns the rank of a new timer, one more than the last. Timers that are due at the same time fire by rank."""

    def schedule_timer(self, time_ns: int, firing: Firing) -> None:
        """Fires a timer at a time [ns], after the messages of that time. Timers of one time fire by ascending rank."""


@dataclass(frozen=True)
class TimerSnapshot:
    """Saved state of a timer.

    Attributes:
        start_ns: Time from which the periods are counted [ns].
        fired: Number of times the timer has fired since `start_ns`.
        cancelled: True if the timer is cancelled.
        due_ns: Time at which the timer fires next, unless it is cancelled [ns].
    """

    start_ns: int
    fired: int
    cancelled: bool
    due_ns: int


class BusTimer(Handle):
    """Calls a callback at multiples of a period after the timer's start.

    Each multiple is rounded to nanoseconds separately, so rounding errors do not add up.

    Args:
        queue: The bus.
        period: Period [s].
        callback: Called without arguments each time the timer fires.

    Attributes:
        callback: The callback.

    Raises:
        ValueError: The period is below 1 ns or not finite.
        TypeError: The period is not a number, or the callback is not callable.
    """

    def __init__(self, queue: TimerQueue, period: float, callback: Callable[[], None]) -> None:
        if not isinstance(period, SupportsFloat):
            raise TypeError(f"a timer's period must be a number of seconds, got {quoted(period)}")
        if not 1 <= period * NANOSECONDS < math.inf:
            raise ValueError(f"a timer's period must be at least 1 ns and finite, got {period} s")
        check_callback(callback)
        self._queue, self._period, self.callback = queue, period, callback
        self._firing, self._due_ns = (queue.next_timer_order(), self), 0
        queue.timers[self] = None
        self.reset()

    @property
    def timer_period_ns(self) -> int:
        """Period, rounded to nanoseconds [ns]."""
        return round(self._period * NANOSECONDS)

    def cancel(self) -> None:
        """Stops the timer until `reset` is called."""
        self._cancelled = True

    def is_canceled(self) -> bool:
        """Returns True if the timer is cancelled."""
        return self._cancelled

    def reset(self) -> None:
        """Restarts the timer, even if it is cancelled. It fires one period from now and then periodically."""
        self._start_ns, self._fired, self._cancelled = self._queue.time_ns, 0, False
        self._schedule()

    def time_until_next_call(self) -> int | None:
        """Returns the time until the timer fires [ns], or None if it is cancelled."""
        return None if self._cancelled else self._due_ns - self._queue.time_ns

    def save(self) -> TimerSnapshot:
        """Returns the state that `restore` takes."""
        return TimerSnapshot(self._start_ns, self._fired, self._cancelled, self._due_ns)

    def restore(self, state: TimerSnapshot) -> None:
        """Puts the timer back into a saved state. The bus restores the events that fire it."""
        self._start_ns, self._fired = state.start_ns, state.fired
        self._cancelled, self._due_ns = state.cancelled, state.due_ns

    def _schedule(self) -> None:
        due_ns = self._start_ns + round((self._fired + 1) * self._period * NANOSECONDS)
        if due_ns != self._due_ns:
            self._due_ns = due_ns
            self._queue.schedule_timer(due_ns, self._firing)

    def fire(self) -> None:
        """Calls the callback if it is time. Only the bus calls this."""
        # The event may be stale: `reset` changes the due time but leaves the old event in the queue.
        if self._cancelled or self._queue.time_ns != self._due_ns:
            return
        self._fired += 1
        self._schedule()
        self.callback()


Firing = tuple[int, BusTimer]
"""Rank of a timer, and the timer."""
