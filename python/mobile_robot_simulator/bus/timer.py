"""Timer: what fires at multiples of its period, on the bus's clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..handle import Handle, check_callback
from ..instant import NANOSECONDS

if TYPE_CHECKING:
    from .bus import Bus


class Timer(Handle):
    """Fires at multiples of its period after its start: rounded to nanoseconds, without drift."""

    def __init__(self, bus: Bus, period: float, callback: Callable[[], None]) -> None:
        if not 1 <= period * NANOSECONDS < math.inf:
            raise ValueError(f"a timer's period must be at least a nanosecond, and finite, got {period} s")
        check_callback(callback)
        self._bus, self._period, self._callback = bus, period, callback
        self._order, self._due_ns = bus.next_timer_order(), 0
        bus.timers[self] = None
        self.reset()

    @property
    def timer_period_ns(self) -> int:
        """The period [ns]."""
        return round(self._period * NANOSECONDS)

    def cancel(self) -> None:
        """Fire no more, until `reset`."""
        self._cancelled = True

    def is_canceled(self) -> bool:
        """Whether the timer was cancelled."""
        return self._cancelled

    def reset(self) -> None:
        """Fire one period from now, and each period after; also if it was cancelled."""
        self._start_ns, self._fired, self._cancelled = self._bus.time_ns, 0, False
        self._wait()

    def time_until_next_call(self) -> int | None:
        """Nanoseconds until it fires, None if it was cancelled."""
        return None if self._cancelled else self._due_ns - self._bus.time_ns

    def save(self) -> Any:
        """When it fires next."""
        return self._start_ns, self._fired, self._cancelled, self._due_ns

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        self._start_ns, self._fired, self._cancelled, self._due_ns = state

    def _wait(self) -> None:
        due_ns = self._start_ns + round((self._fired + 1) * self._period * NANOSECONDS)
        if due_ns != self._due_ns:
            self._due_ns = due_ns
            self._bus.schedule_timer(due_ns, self._order, self._fire)

    def _fire(self) -> None:
        # An event that was planned before a reset comes at a time that is no longer due.
        if self._cancelled or self._bus.time_ns != self._due_ns:
            return
        self._fired += 1
        self._wait()
        self._callback()
