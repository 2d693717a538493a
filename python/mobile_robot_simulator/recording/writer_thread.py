"""WriterThread: a thread in which Ctrl-C cannot interrupt a write."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from queue import SimpleQueue
from typing import TypeAlias

_Job: TypeAlias = tuple[Callable[[], None], list[BaseException | None], threading.Lock]


class WriterThread:
    """A thread that runs functions one after another, each to completion.

    Python raises KeyboardInterrupt in the main thread only, so work in this thread never leaves half a record behind. The
    implementation uses bare locks and queues: `concurrent.futures` and `threading.Event` can keep a lock forever when
    Ctrl-C interrupts a wait at a bad moment.
    """

    def __init__(self) -> None:
        self._queue: SimpleQueue[_Job | None] = SimpleQueue()
        threading.Thread(target=_run_jobs, args=[self._queue], name="recorder", daemon=True).start()

    def run(self, work: Callable[[], None]) -> None:
        """Runs a function in the thread, waits until it ends, and raises its error. Ctrl-C is raised only after that."""
        ended = threading.Lock()
        ended.acquire()
        outcome: list[BaseException | None] = []
        self._queue.put((work, outcome, ended))
        try:
            ended.acquire()
        finally:
            while not outcome:
                time.sleep(0.001)
        if outcome[0] is not None:
            raise outcome[0]

    def stop(self) -> None:
        """Ends the thread after all functions passed to `run` so far."""
        self._queue.put(None)


def _run_jobs(queue: SimpleQueue[_Job | None]) -> None:
    for work, outcome, ended in iter(queue.get, None):
        try:
            work()
            outcome.append(None)
        except BaseException as error:
            outcome.append(error)
        ended.release()
