"""Waiting: runs the bus while the constructor of a node waits, and ends a wait that would never end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ..handle import Handle
from ..instant import NANOSECONDS
from ..nodes.future import Future

LONGEST_WAIT = 300.0
"""Simulated time that waits in a row can take together, before they count as endless [s]."""

MOST_TRIES = 100
"""Number of times that a caller can ask for the same thing at one simulated time, before it counts as an endless loop."""


class Runner(Protocol):
    """What `Waiting` needs from the bus.

    Attributes:
        time_ns: Simulated time [ns].
    """

    time_ns: int

    @property
    def is_running(self) -> bool:
        """True during a run, so a callback has made the call."""

    def next_ns(self) -> int | None:
        """Returns the time of the next event [ns], or None if there is none."""

    def run_until(self, time_ns: int) -> None:
        """Runs all events up to and including a time, then sets the simulated time to it."""


class Waiting(Handle):
    """Waits on a bus.

    Outside a run, as in the constructor of a node, a wait runs the bus. In a callback, simulated time stands still, so there
    is nothing to wait for.

    Args:
        bus: The bus.
    """

    def __init__(self, bus: Runner) -> None:
        self._bus = bus
        self._ended_ns = -1
        self._waited_ns = 0
        self._tried_ns = -1
        self._tries: dict[object, int] = {}

    def wait(self, condition: Callable[[], object], timeout: float | None, what: str, hint: str) -> bool:
        """Runs the bus until a condition holds.

        Args:
            condition: Function that returns a true value if there is nothing more to wait for.
            timeout: Longest simulated time to wait [s]. None or a negative number: no limit but `LONGEST_WAIT`.
            what: What the wait is for, for error messages.
            hint: What to do instead of a wait that never ends, for error messages.

        Returns:
            True if the condition holds. In a callback, and with a timeout of 0, the answer is that of now.

        Raises:
            RuntimeError: A callback waits without a timeout, or waits again and again at the same simulated time. Or waits
                in a row took `LONGEST_WAIT` together.
        """
        if condition():
            return True
        unlimited = timeout is None or timeout < 0
        if self._bus.is_running:
            if unlimited:
                raise RuntimeError(f"a callback must not wait for {what}, because simulated time stands still: {hint}")
            self.count_try(what, what, hint)
            return False
        start_ns = self._bus.time_ns
        if start_ns != self._ended_ns:
            self._waited_ns = 0
        left_ns = round(LONGEST_WAIT * NANOSECONDS) - self._waited_ns
        span_ns = left_ns if timeout is None or timeout < 0 else min(round(timeout * NANOSECONDS), left_ns)
        held = self._run(condition, start_ns + span_ns)
        self._ended_ns = self._bus.time_ns
        self._waited_ns += self._ended_ns - start_ns
        if self._ended_ns == start_ns:
            self.count_try(what, what, hint)
        if not held and span_ns == left_ns:
            raise RuntimeError(f"waited for {what} for {LONGEST_WAIT:g} s of simulated time: {hint}")
        return held

    def count_try(self, key: object, what: str, hint: str) -> None:
        """Counts that something was missing.

        Args:
            key: What is counted.
            what: Its name, for the error message.
            hint: What to do instead, for the error message.

        Raises:
            RuntimeError: It was missing `MOST_TRIES` times at the same simulated time.
        """
        if self._bus.time_ns != self._tried_ns:
            self._tried_ns = self._bus.time_ns
            self._tries.clear()
        self._tries[key] = self._tries.get(key, 0) + 1
        if self._tries[key] > MOST_TRIES:
            self._tries.clear()
            raise RuntimeError(f"asked for {what} {MOST_TRIES} times while simulated time stands still: {hint}")

    def _run(self, condition: Callable[[], object], end_ns: int) -> bool:
        while not condition():
            next_ns = self._bus.next_ns()
            if self._bus.time_ns >= end_ns and next_ns != end_ns:
                return False
            self._bus.run_until(end_ns if next_ns is None else min(next_ns, end_ns))
        return True


class Response(Future):
    """The future of a service call or of an action goal. It notices a loop that asks whether it is done.

    Args:
        waiting: Counts how often it is asked.
        what: What the future brings, for error messages.
    """

    def __init__(self, waiting: Waiting, what: str) -> None:
        super().__init__()
        self._waiting, self._what = waiting, what

    def done(self) -> bool:
        """Returns True once the response has arrived or the call has failed.

        Raises:
            RuntimeError: It was asked `MOST_TRIES` times at the same simulated time, so a loop waits for it.
        """
        if not super().done():
            self._waiting.count_try(self, self._what, "use add_done_callback or await instead of a loop")
        return super().done()
