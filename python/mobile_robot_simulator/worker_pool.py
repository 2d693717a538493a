"""WorkerPool: processes that work on tasks, and tell which task it was when one of them dies."""

from __future__ import annotations

import multiprocessing
import pickle
import signal
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import Any, Generic, TypeVar

__all__ = ["WorkerDied", "WorkerPool", "how_it_ended"]

Task = TypeVar("Task")
Result = TypeVar("Result")

PATIENCE = 2.0
"""Time in which a process must end after it was asked to, before it is killed [s]."""


class WorkerDied(ChildProcessError):
    """A process ended before its work was done.

    Attributes:
        exit_code: Its exit code; the number of a signal, negative, if that ended it.
        index: Index of its task among those of the call of `WorkerPool.run`; None if it had none.
    """

    def __init__(self, exit_code: int, index: int | None, when: str) -> None:
        super().__init__(f"a process {how_it_ended(exit_code)} {when}")
        self.exit_code, self.index = exit_code, index


@dataclass
class _Worker:
    """A process, and what it works on."""

    process: BaseProcess
    connection: Connection
    is_ready: bool = False
    call: int = 0
    """Number of the call of `run` that its task belongs to."""

    index: int | None = None
    """Index of its task; None if it has none."""

    has_begun: bool = False
    """True if it has taken its task from the connection."""


class WorkerPool(Generic[Task, Result]):
    """Processes that apply a function to tasks.

    A pool of the standard library cannot tell which task ended a process, and ends with the same error for all of them.

    Args:
        work: The function. It is pickled, as are the tasks and the results.
        count: Number of processes, at least 1.

    Raises:
        ValueError: The function cannot be pickled.
    """

    def __init__(self, work: Callable[[Task], Result], count: int) -> None:
        try:
            data = pickle.dumps(work)
        except Exception as error:  # The objects that are pickled can raise anything.
            raise ValueError(
                f"with several processes, controllers and requirements must be functions or classes of a module: {error}"
            ) from error
        self._calls = 0
        self._workers: list[_Worker] = []
        context = multiprocessing.get_context("spawn")
        for _ in range(count):
            ours, theirs = context.Pipe()
            process = context.Process(target=_serve, args=(theirs, data))
            process.start()
            theirs.close()
            self._workers.append(_Worker(process, ours))

    def close(self, *, at_once: bool = False) -> None:
        """Ends the processes.

        Args:
            at_once: End them without waiting for tasks that they work on.
        """
        for worker in self._workers:
            worker.connection.close()
            if at_once:
                worker.process.terminate()
        for worker in self._workers:
            if at_once:
                _end(worker.process)
            worker.process.join()
        self._workers.clear()

    def run(self, tasks: Sequence[Task]) -> Iterator[Result]:
        """Yields the results of tasks, in order.

        Args:
            tasks: The tasks.

        Raises:
            WorkerDied: A process ended before its task was done. All earlier tasks are done, so that it does not depend on
                timing which of several such tasks it is.
            Exception: Any error that the function raises.
        """
        self._calls += 1
        waiting, results, deaths = deque(range(len(tasks))), dict[int, Result](), dict[int, WorkerDied]()
        for wanted in range(len(tasks)):
            while True:
                for worker in self._workers:
                    if waiting and worker.is_ready and worker.index is None:
                        self._send(worker, waiting.popleft(), tasks)
                if wanted in results:
                    break
                if wanted in deaths or (deaths and not self._workers):
                    raise deaths[min(deaths)]
                for worker in self._with_news():
                    try:
                        index, result = self._receive(worker)
                    except WorkerDied as died:
                        if died.index is None:
                            raise
                        deaths[died.index] = died
                        # The others go on with the tasks before this one.
                        waiting = deque(number for number in waiting if number < died.index)
                        worker.connection.close()
                        self._workers.remove(worker)
                        continue
                    if index is not None:
                        results[index] = result
            yield results.pop(wanted)

    def _send(self, worker: _Worker, index: int, tasks: Sequence[Task]) -> None:
        try:
            worker.connection.send(tasks[index])
        except OSError:
            raise self._died(worker) from None
        worker.call, worker.index, worker.has_begun = self._calls, index, False

    def _with_news(self) -> list[_Worker]:
        # A process that the worker has started can keep the connection open, so its own end is waited for too.
        handles = {handle: worker for worker in self._workers for handle in (worker.connection, worker.process.sentinel)}
        found = wait(list(handles))
        return list({id(handles[handle]): handles[handle] for handle in found}.values())  # type: ignore[index]

    def _receive(self, worker: _Worker) -> tuple[int | None, Any]:
        """Returns the index of a task and its result, or None if it is no task of this call."""
        try:
            if not worker.connection.poll():
                raise EOFError
            message = worker.connection.recv()
        except (EOFError, OSError):
            raise self._died(worker) from None
        if message is None:
            worker.is_ready, worker.has_begun = True, worker.is_ready
            return None, None
        index, worker.index = worker.index, None
        if worker.call != self._calls:  # The caller did not take all results of an earlier call.
            return None, None
        result, error, trace = message
        if error is not None:
            raise error from _Remote(trace)
        return index, result

    def _died(self, worker: _Worker) -> WorkerDied:
        exit_code = _end(worker.process)
        index = worker.index if worker.call == self._calls and worker.has_begun else None
        when = "while it waited for work" if index is None else "before its task was done"
        if not worker.is_ready:
            when = 'before it began to work; a script that uses several processes needs if __name__ == "__main__":'
        return WorkerDied(exit_code, index, when)


def _end(process: BaseProcess) -> int:
    """Waits until a process has ended, and kills it if that takes too long. Returns its exit code."""
    end = time.monotonic() + PATIENCE
    # A process that has closed its files seems to have ended, and `join` would then wait for it without a limit.
    while process.exitcode is None and time.monotonic() < end:
        time.sleep(0.005)
    if process.exitcode is None:
        process.kill()
        process.join()
    assert process.exitcode is not None
    return process.exitcode


def how_it_ended(exit_code: int) -> str:
    """Returns how a process ended, such as "was killed by SIGKILL".

    Args:
        exit_code: Its exit code, as of `multiprocessing.Process`.
    """
    if exit_code >= 0:
        return f"ended with exit code {exit_code}"
    try:
        name = signal.Signals(-exit_code).name
    except ValueError:
        name = f"signal {-exit_code}"
    return f"was killed by {name}" + (", as when memory is used up" if name == "SIGKILL" else "")


class _Remote(Exception):
    """The traceback of an error in another process."""

    def __str__(self) -> str:
        return f"\n{self.args[0]}"


def _serve(connection: Connection, data: bytes) -> None:
    """Works in a process of its own until the other end of the connection is closed."""
    # Ctrl-C reaches all processes of a terminal. The first one ends the others.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        work, failed = pickle.loads(data), None
    except Exception as error:
        work, failed = None, _reply_of(error)
    try:
        connection.send(None)
        while True:
            task = connection.recv()
            connection.send(None)
            try:
                reply = failed or (work(task), None, "")
            except Exception as error:
                reply = _reply_of(error)
            connection.send(reply)
    except (EOFError, OSError):
        return


def _reply_of(error: Exception) -> tuple[None, Exception, str]:
    text = "".join(traceback.format_exception(error))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return None, RuntimeError(f"{type(error).__name__}: {error}"), text
    return None, error, text
