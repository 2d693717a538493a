"""Loop: where the callbacks of all nodes in a ROS process take turns, so that each node may be written for one thread."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from typing import Any, TypeVar

from ..instant import NANOSECONDS
from ..nodes.interface import Clock
from .paced_clock import PacedClock

Returned = TypeVar("Returned")


POLLED_EVERY = 0.002
"""How often a clock is looked at that others set [s]."""


class Loop:
    """Runs callbacks one at a time: those of timers on a thread of its own, others on whichever thread they come in.

    What a callback raises ends the process: `wait` raises it.
    """

    def __init__(self) -> None:
        self._turn = threading.RLock()
        self._changed = threading.Condition(threading.Lock())
        self._ended = threading.Event()
        self._error: BaseException | None = None
        self._timers: list[Timer] = []
        threading.Thread(target=self._run_timers, name="timers", daemon=True).start()

    def in_turn(self, callback: Callable[..., Returned]) -> Callable[..., Returned]:
        """The callback, waiting for its turn whenever it is called."""

        def call(*arguments: Any) -> Returned:
            with self._turn:
                try:
                    return callback(*arguments)
                except BaseException as error:
                    self.end(error)
                    raise

        return call

    def create_timer(self, clock: Clock, period: float, callback: Callable[[], None]) -> Timer:
        """Have the callback called at the clock's multiples of a period."""
        timer = Timer(clock, round(period * NANOSECONDS), self.in_turn(callback))
        with self._changed:
            self._timers.append(timer)
            self._changed.notify()
        return timer

    def destroy_timer(self, timer: Timer) -> None:
        """Take a timer away."""
        timer.cancel()
        with self._changed:
            self._timers.remove(timer)

    def notify(self) -> None:
        """Reckon anew when timers are due: a clock has changed its speed."""
        with self._changed:
            self._changed.notify()

    def end(self, error: BaseException | None = None) -> None:
        """Have `wait` return, or raise the error."""
        self._error = self._error or error
        self._ended.set()

    def wait(self) -> None:
        """Wait until the end, or until Ctrl-C or a request to terminate, of which later ones are passed over.

        raises: what a callback raised.
        """
        try:
            signal.signal(signal.SIGTERM, signal.default_int_handler)
            signal.signal(signal.SIGINT, signal.default_int_handler)
            self._ended.wait()
        except KeyboardInterrupt:
            self._ended.set()
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if self._error is not None:
            raise self._error

    def _run_timers(self) -> None:
        while not self._ended.is_set():
            with self._changed:
                waits = [(timer.due_in(), timer) for timer in self._timers]
                due = [timer for due_in, timer in waits if due_in <= 0.0]
                if not due:
                    self._changed.wait(min((due_in for due_in, _ in waits), default=None))
                    continue
            try:
                for timer in due:
                    timer.fire()
            except Exception:
                # `wait` raises it.
                return


class Timer:
    """Fires at the clock's multiples of its period; those that it is too late for are left out.

    So timers of related periods fire together, the first made first, and the thread wakes once for all: at these rates,
    waking costs more than what is then done.
    """

    def __init__(self, clock: Clock, period_ns: int, callback: Callable[[], None]) -> None:
        self._clock, self._period, self._callback = clock, period_ns, callback
        self._cancelled = False
        self._next = self._after(self._now())

    def cancel(self) -> None:
        """Never fire again."""
        self._cancelled = True

    def due_in(self) -> float:
        """Seconds until it is time to fire, or to look again where the clock is set by others."""
        now = self._now()
        left = self._next - now
        if left > self._period:
            # Time went back.
            self._next = self._after(now)
            left = self._next - now
        if isinstance(self._clock, PacedClock):
            return left / self._clock.speed / NANOSECONDS
        return 0.0 if left <= 0 else min(left / NANOSECONDS, POLLED_EVERY)

    def fire(self) -> None:
        """Call back, unless it was cancelled."""
        self._next = self._after(self._now())
        if not self._cancelled:
            self._callback()

    def _after(self, now: int) -> int:
        return (now // self._period + 1) * self._period

    def _now(self) -> int:
        return self._clock.now().nanoseconds
