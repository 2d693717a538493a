"""Tasks: coroutines on the bus, from callbacks that are defined with `async def`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Coroutine
from functools import partial, wraps
from typing import Any, Protocol

from ..nodes.future import Future
from ..quoting import quoted


class TaskQueue(Protocol):
    """What a task needs from the bus.

    Attributes:
        time_ns: Simulated time [ns].
        tasks: Tasks that have not ended, in the order in which they were started.
    """

    time_ns: int
    tasks: dict[BusTask, None]

    def schedule(self, time_ns: int, action: Callable[[], None], /) -> None:
        """Runs an action at a time [ns], in order with the messages of that time."""


class BusTask(Future):
    """A coroutine on the bus, and the future of what it returns.

    It starts at once. An `await` of a future pauses it until the future is done; it continues at that simulated time.

    If the coroutine raises an exception, those who wait for the task get it. If nobody waits, the run raises it.

    Args:
        queue: The bus.
        coroutine: The coroutine.
    """

    def __init__(self, queue: TaskQueue, coroutine: Coroutine[Any, Any, Any]) -> None:
        super().__init__()
        self._queue, self._coroutine = queue, coroutine
        queue.tasks[self] = None
        self._step()

    def __repr__(self) -> str:
        return str(getattr(self._coroutine, "__qualname__", self._coroutine))

    def close(self) -> None:
        """Ends the coroutine where it waits."""
        self._queue.tasks.pop(self, None)
        self._coroutine.close()

    def _step(self) -> None:
        if self not in self._queue.tasks:
            return
        try:
            awaited = self._coroutine.send(None)
        except StopIteration as end:
            self._queue.tasks.pop(self)
            self.set_result(end.value)
        except Exception as error:
            self._queue.tasks.pop(self, None)
            if not self._callbacks:
                raise
            self.set_exception(error)
        else:
            if isinstance(awaited, Future):
                awaited.add_done_callback(self._wake)
            elif awaited is None:
                self._wake(self)
            else:
                self.close()
                raise TypeError(
                    f"{self!r} must await futures of the node, such as that of call_async, got {quoted(awaited)}"
                )

    def _wake(self, _: Future) -> None:
        self._queue.schedule(self._queue.time_ns, self._step)


def plain_callback(queue: TaskQueue, callback: Callable[..., Any]) -> Callable[..., Any]:
    """Returns a callback that starts a task if the callback is defined with `async def`, or else the callback itself.

    Args:
        queue: The bus.
        callback: Function or coroutine function.
    """
    if not inspect.iscoroutinefunction(callback):
        return callback

    @wraps(callback.func if isinstance(callback, partial) else callback)
    def start(*arguments: Any) -> BusTask:
        return BusTask(queue, callback(*arguments))

    return start
