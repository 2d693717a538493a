"""Executor: runs the callbacks of all nodes in a ROS process one at a time, so that a node can be written for one thread."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from typing import Any, TypeVar

from ..instant import NANOSECONDS
from ..nodes.interface import Clock
from .paced_clock import PacedClock

Returned = TypeVar("Returned")

POLL_PERIOD = 0.002
"""Largest time between two readings of a clock that ROS controls [s]. Such a clock may change its speed or jump."""

LONGEST_WAIT = 3600.0
"""Largest time for which the executor sleeps [s]. Python cannot wait for centuries, as a very low rate would ask for."""


class Executor:
    """Runs callbacks one at a time, so that all of them form one mutually exclusive callback group.

    Timer callbacks run on a thread of the executor. All other callbacks run on the thread that calls them, which belongs to
    rospy or rclpy. That thread waits until the previous callback has returned.

    An exception in a callback shuts the executor down, and `wait` raises it.
    """

    def __init__(self) -> None:
        self._callback_lock = threading.RLock()
        self._timers_changed = threading.Condition(threading.Lock())
        self._has_ended = threading.Event()
        self._is_signalled = False
        self._error: BaseException | None = None
        self._timers: list[ExecutorTimer] = []
        threading.Thread(target=self._run_timers, name="timers", daemon=True).start()

    def serialized(self, callback: Callable[..., Returned]) -> Callable[..., Returned]:
        """Returns a function that calls the callback while no other serialized callback runs.

        Calls may nest: a serialized callback may call another one.

        Args:
            callback: Any function. An exception that it raises goes to its caller, and also shuts the executor down.
        """

        def call(*arguments: Any) -> Returned:
            with self._callback_lock:
                try:
                    return callback(*arguments)
                except BaseException as error:
                    self.shutdown(error)
                    raise

        return call

    def create_timer(self, clock: Clock, period: float, callback: Callable[[], None]) -> ExecutorTimer:
        """Calls the callback at every multiple of `period` on the clock, serialized.

        Args:
            clock: Clock that the timer follows.
            period: Time between two calls on that clock [s].
            callback: Function to call.
        """
        timer = ExecutorTimer(clock, period, self.serialized(callback))
        with self._timers_changed:
            self._timers.append(timer)
            self._timers_changed.notify()
        return timer

    def destroy_timer(self, timer: ExecutorTimer) -> None:
        """Cancels a timer and removes it."""
        timer.cancel()
        with self._timers_changed:
            self._timers.remove(timer)

    def wake(self) -> None:
        """Recomputes when timers are due. Must be called after a `PacedClock` has changed its speed."""
        with self._timers_changed:
            self._timers_changed.notify()

    def shutdown(self, error: BaseException | None = None) -> None:
        """Makes `wait` return, or raise the error if one is given. After several errors, `wait` raises the first."""
        self._error = self._error or error
        self._has_ended.set()

    @contextmanager
    def until_signalled(self) -> Iterator[None]:
        """Ends the block on SIGINT (Ctrl-C) or SIGTERM. After the block, both signals are ignored.

        Must be used on the main thread, because it installs signal handlers. A signal raises KeyboardInterrupt in the block.
        It also makes `wait` return at once: rospy and rclpy catch every exception in places, so a KeyboardInterrupt that is
        raised before `wait` can get lost.
        """

        def end(*_: object) -> None:
            # Not `shutdown`: its event has a lock, which this thread may hold while the handler runs.
            self._is_signalled = True
            raise KeyboardInterrupt

        try:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, end)
            yield
        except KeyboardInterrupt:
            pass
        finally:
            for number in (signal.SIGINT, signal.SIGTERM):
                signal.signal(number, signal.SIG_IGN)
            self.shutdown()

    def wait(self) -> None:
        """Blocks until `shutdown`, or until a signal in `until_signalled`.

        Raises:
            BaseException: The exception of a callback.
        """
        if not self._is_signalled:
            self._has_ended.wait()
        if self._error is not None:
            raise self._error

    def _run_timers(self) -> None:
        try:
            while not self._has_ended.is_set():
                with self._timers_changed:
                    waits = [(timer.due_in(), timer) for timer in self._timers]
                    due = [timer for due_in, timer in waits if due_in <= 0.0]
                    if not due:
                        self._timers_changed.wait(min([LONGEST_WAIT, *(due_in for due_in, _ in waits)]))
                        continue
                for timer in due:
                    timer.fire()
        except Exception as error:
            # Without this thread no timer fires any more, so the process must end.
            self.shutdown(error)


class ExecutorTimer:
    """Timer that fires at each multiple of its period on a clock. If it has missed several multiples, it fires only once.

    Timers are due at the same time whenever their multiples coincide. For example, periods of 10 ms and 20 ms coincide every
    20 ms. The executor's thread then wakes up once and runs all of them, in the order of their creation. This saves time,
    because at the rates of the nodes, waking up costs more than the callbacks.

    Args:
        clock: Clock that the timer follows.
        period: Period on that clock [s].
        callback: Function to call.
    """

    def __init__(self, clock: Clock, period: float, callback: Callable[[], None]) -> None:
        self._clock, self._callback = clock, callback
        # A ratio of integers, so that the multiples of 1/30 s include every full second, at any time of the clock.
        self._period = Fraction(period).limit_denominator(NANOSECONDS) * NANOSECONDS
        self._is_cancelled = False
        self._next = self._first_multiple_after(self._now())

    def cancel(self) -> None:
        """Never fires again."""
        self._is_cancelled = True

    def due_in(self) -> float:
        """Returns the wall time until the timer is due [s]. If ROS controls the clock: at most `POLL_PERIOD`."""
        now = self._now()
        left = self._next - now
        if left > self._period:
            # The clock has jumped back.
            self._next = self._first_multiple_after(now)
            left = self._next - now
        if isinstance(self._clock, PacedClock):
            return left / self._clock.speed / NANOSECONDS
        return 0.0 if left <= 0 else min(left / NANOSECONDS, POLL_PERIOD)

    def fire(self) -> None:
        """Calls the callback, unless the timer was cancelled."""
        self._next = self._first_multiple_after(self._now())
        if not self._is_cancelled:
            self._callback()

    def _first_multiple_after(self, now: int) -> int:
        return round((now // self._period + 1) * self._period)

    def _now(self) -> int:
        return self._clock.now().nanoseconds
