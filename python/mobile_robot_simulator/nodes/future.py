"""Future: the response of a service call, available later."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..handle import Handle


@dataclass(frozen=True)
class FutureSnapshot:
    """Saved state of a future: whether it is done, its result, and the callbacks that wait for it."""

    done: bool
    result: Any
    callbacks: tuple[Callable[[Future], None], ...]


class Future(Handle):
    """The response of a service call, available later."""

    def __init__(self) -> None:
        self._done = False
        self._result: Any = None
        self._callbacks: list[Callable[[Future], None]] = []

    def done(self) -> bool:
        """Returns True once the response has arrived."""
        return self._done

    def result(self) -> Any:
        """Returns the response, or None before it has arrived."""
        return self._result

    def set_result(self, result: Any) -> None:
        """Sets the response and calls the waiting callbacks."""
        self._done, self._result = True, result
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback(self)

    def add_done_callback(self, callback: Callable[[Future], None]) -> None:
        """Calls the callback with this future when the response arrives, or now if it has already arrived."""
        if self._done:
            callback(self)
        else:
            self._callbacks.append(callback)

    def save(self) -> FutureSnapshot:
        """Returns the state that `restore` takes."""
        return FutureSnapshot(self._done, self._result, tuple(self._callbacks))

    def restore(self, state: FutureSnapshot) -> None:
        """Puts the future back into a saved state."""
        self._done, self._result, self._callbacks = state.done, state.result, list(state.callbacks)
