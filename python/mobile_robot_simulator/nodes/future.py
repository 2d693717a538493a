"""Future: the response of a service call, available later."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

from ..handle import Handle, check_callback


@dataclass(frozen=True)
class FutureSnapshot:
    """Saved state of a future: whether it is done, its result or exception, and the callbacks that wait for it."""

    done: bool
    result: Any
    exception: Exception | None
    callbacks: tuple[Callable[[Future], None], ...]


class Future(Handle):
    """The response of a service call, available later. If the call has failed, the exception replaces the response.

    A coroutine can await it.

    Args:
        **_: Arguments of `rclpy.task.Future`, such as `executor`, are ignored.
    """

    def __init__(self, **_: Any) -> None:
        self._done = False
        self._result: Any = None
        self._exception: Exception | None = None
        self._callbacks: list[Callable[[Future], None]] = []

    def done(self) -> bool:
        """Returns True once the response has arrived or the call has failed."""
        return self._done

    def result(self) -> Any:
        """Returns the response, or None before it has arrived.

        Raises:
            Exception: The call has failed.
        """
        if self._exception is not None:
            raise self._exception
        return self._result

    def exception(self) -> Exception | None:
        """Returns why the call has failed, or None if it has not."""
        return self._exception

    def set_result(self, result: Any) -> None:
        """Sets the response and calls the waiting callbacks."""
        self._end(result, None)

    def set_exception(self, exception: Exception) -> None:
        """Sets why the call has failed and calls the waiting callbacks."""
        self._end(None, exception)

    def add_done_callback(self, callback: Callable[[Future], None]) -> None:
        """Calls the callback with this future when it is done, or now if it is already done.

        Raises:
            TypeError: The callback is not callable, or it is a coroutine function: await the future there instead.
        """
        check_callback(callback)
        if inspect.iscoroutinefunction(callback):
            raise TypeError(f"a done callback must not be async, got {callback.__qualname__}: await the future instead")
        if self._done:
            callback(self)
        else:
            self._callbacks.append(callback)

    def __await__(self) -> Generator[Future, None, Any]:
        """Pauses a coroutine until this future is done. Returns the response, or raises why the call has failed."""
        if not self._done:
            yield self
        return self.result()

    def save(self) -> FutureSnapshot:
        """Returns the state that `restore` takes."""
        return FutureSnapshot(self._done, self._result, self._exception, tuple(self._callbacks))

    def restore(self, state: FutureSnapshot) -> None:
        """Puts the future back into a saved state."""
        self._done, self._result, self._exception = state.done, state.result, state.exception
        self._callbacks = list(state.callbacks)

    def _end(self, result: Any, exception: Exception | None) -> None:
        self._done, self._result, self._exception = True, result, exception
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback(self)
