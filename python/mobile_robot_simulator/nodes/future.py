"""Future: the response of a service call, available later."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..handle import Handle

if TYPE_CHECKING:
    pass


class Future(Handle):
    """A service's answer, once it is there."""

    def __init__(self) -> None:
        self._done = False
        self._result: Any = None
        self._callbacks: list[Callable[[Future], None]] = []

    def done(self) -> bool:
        """Whether the answer is there."""
        return self._done

    def result(self) -> Any:
        """The answer, None before it is there."""
        return self._result

    def set_result(self, result: Any) -> None:
        """Give the answer, and call all callbacks."""
        self._done, self._result = True, result
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback(self)

    def add_done_callback(self, callback: Callable[[Future], None]) -> None:
        """Call back with the future once the answer is there, at once if it is."""
        if self._done:
            callback(self)
        else:
            self._callbacks.append(callback)

    def save(self) -> Any:
        """Whether it is done, and who waits."""
        return self._done, self._result, tuple(self._callbacks)

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        self._done, self._result, callbacks = state
        self._callbacks = list(callbacks)
