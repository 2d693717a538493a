"""Executor: runs the callbacks of all nodes in a ROS process one at a time, so that a node can be written for one thread."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from ..nodes.interface import Clock
from .event_clock import EventAlarm, EventClock, EventTimer
from .paced_clock import PacedClock

Returned = TypeVar("Returned")

LONGEST_WAIT = 3600.0
"""Largest time for which the executor sleeps [s]. Python cannot wait for centuries, as a very low rate would ask for."""


class Executor:
    """Runs callbacks one at a time, so that all of them form one mutually exclusive callback group.

    Callbacks run on the thread that calls them, which belongs to rospy or rclpy. That thread waits until the previous
    callback has returned. Before each callback, all timers that are due fire. A thread of the executor fires them when no
    callback comes. So all events are handled in the order of their times, and clocks show the time of the event (see
    `EventClock`).

    An exception in a callback shuts the executor down, and `wait` raises it.

    Attributes:
        wall_clock: Wall time.
    """

    def __init__(self) -> None:
        self._callback_lock = threading.RLock()
        self._timers_changed = threading.Condition(threading.Lock())
        self._has_ended = threading.Event()
        self._is_signalled = False
        self._error: BaseException | None = None
        self._is_in_callback = False
        self._clocks: tuple[EventClock, ...] = ()
        self.wall_clock = self.follow(PacedClock())
        threading.Thread(target=self._run_timers, name="timers", daemon=True).start()

    def serialized(self, callback: Callable[..., Returned]) -> Callable[..., Returned]:
        """Returns a function that calls the callback while no other serialized callback runs.

        Calls may nest: a serialized callback may call another one.

        Args:
            callback: Any function. An exception that it raises goes to its caller, and also shuts the executor down.
        """

        def call(*arguments: Any) -> Returned:
            with self.event():
                return callback(*arguments)

        return call

    @contextmanager
    def event(self) -> Iterator[None]:
        """In this block no other thread runs a callback. All timers that are due have fired before. Blocks may be nested."""
        with self._callback_lock:
            is_outermost, self._is_in_callback = not self._is_in_callback, True
            try:
                if is_outermost and not self._has_ended.is_set():
                    for clock in self._clocks:
                        clock.advance()
                yield
            except BaseException as error:
                self.shutdown(error)
                raise
            finally:
                self._is_in_callback = not is_outermost

    def follow(self, source: Clock) -> EventClock:
        """Returns a clock that follows `source` from event to event. Only callbacks of this executor may read it."""
        clock = EventClock(source)
        # The wall clock stays the last one. Its timers watch the other clocks, so these must show the present.
        self._clocks = (clock, *self._clocks)
        return clock

    def create_timer(self, clock: EventClock, period: float, callback: Callable[[], None]) -> EventTimer:
        """Calls the callback at every multiple of `period` on the clock, serialized.

        Args:
            clock: Clock that the timer follows, from `follow`.
            period: Time between two calls on that clock [s].
            callback: Function to call.
        """
        with self._timers_changed:
            timer = clock.create_timer(period, callback)
            self._timers_changed.notify()
        return timer

    def create_alarm(self, clock: EventClock, delay_ns: int, callback: Callable[[], None]) -> None:
        """Calls the callback once, after a delay on the clock, serialized.

        Args:
            clock: Clock that the delay is measured on, from `follow`.
            delay_ns: The delay [ns].
            callback: Function to call.
        """

        def go_off() -> None:
            self.destroy_timer(alarm)
            callback()

        with self._timers_changed:
            alarm = clock.create_alarm(delay_ns, go_off)
            self._timers_changed.notify()

    def destroy_timer(self, timer: EventTimer | EventAlarm) -> None:
        """Cancels a timer and removes it."""
        timer.cancel()
        with self._timers_changed:
            timer.clock.timers.remove(timer)

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
        fire_due_timers = self.serialized(lambda: None)
        try:
            while not self._has_ended.is_set():
                with self._timers_changed:
                    due_in = min(clock.due_in() for clock in self._clocks)
                    if due_in > 0.0:
                        self._timers_changed.wait(min(LONGEST_WAIT, due_in))
                        continue
                fire_due_timers()
        except Exception as error:
            # Without this thread no timer fires any more, so the process must end.
            self.shutdown(error)
