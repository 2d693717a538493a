"""Mailbox: work that other threads leave for the thread of the simulation."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeoutError
from typing import Any

MOST_WAITING = 1000
"""Pieces of work that can wait. More are refused."""

LONGEST_WAIT = 5.0
"""Wall time for which another thread waits for an answer [s]."""


class Mailbox:
    """Work for the thread of the simulation, the only one that may touch it."""

    def __init__(self) -> None:
        self._waiting: queue.Queue[tuple[Callable[[], Any], Future[Any]]] = queue.Queue(MOST_WAITING)
        self._lock = threading.Lock()
        self._closed = False

    def leave(self, work: Callable[[], Any]) -> Future[Any]:
        """Leaves work and does not wait. Returns a future for its result.

        Raises:
            RuntimeError: Too much work waits, or the mailbox is closed.
        """
        result: Future[Any] = Future()
        with self._lock:
            if self._closed:
                raise RuntimeError("the server has stopped")
            try:
                self._waiting.put_nowait((work, result))
            except queue.Full:
                raise RuntimeError(f"the simulation is busy: {MOST_WAITING} requests wait already") from None
        return result

    def ask(self, work: Callable[[], Any]) -> Any:
        """Leaves work, waits for its result and returns it. Raises its error.

        Raises:
            RuntimeError: There is no answer within `LONGEST_WAIT`, too much work waits, or the mailbox is closed.
        """
        result = self.leave(work)
        try:
            return result.result(LONGEST_WAIT)
        except FutureTimeoutError:
            if not result.cancel():
                return result.result()
            raise RuntimeError(f"the simulation did not answer within {LONGEST_WAIT:g} s") from None

    def empty(self) -> None:
        """Does all work that waits now, in the order in which it was left. For the thread of the simulation."""
        for _ in range(self._waiting.qsize()):
            try:
                work, result = self._waiting.get_nowait()
            except queue.Empty:
                return
            if not result.set_running_or_notify_cancel():
                continue
            try:
                result.set_result(work())
            except Exception as error:
                result.set_exception(error)

    def close(self) -> None:
        """Refuses the work that waits, and all that comes."""
        with self._lock:
            self._closed = True
        while True:
            try:
                _, result = self._waiting.get_nowait()
            except queue.Empty:
                return
            if result.set_running_or_notify_cancel():
                result.set_exception(RuntimeError("the server has stopped"))
