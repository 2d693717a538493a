"""Services of the bus: who answers requests, who asks, and the answer to come."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .handles import Handle
from .messages import copied

if TYPE_CHECKING:
    from .bus import Bus


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


@dataclass(eq=False)
class Service(Handle):
    """A name that requests are sent to, and who answers them."""

    name: str
    srv_type: Any
    handler: Callable[[Any, Any], Any] | None = None


@dataclass(eq=False)
class Client(Handle):
    """Calls a service."""

    bus: Bus
    service: Service

    def service_is_ready(self) -> bool:
        """Whether anyone answers."""
        return self.service.handler is not None

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Whether anyone answers; time on the bus does not pass while somebody waits."""
        return self.service_is_ready()

    def call_async(self, request: Any) -> Future:
        """Ask; the answer comes at the same moment, after the caller has returned. If nobody answers, it never comes."""
        if not isinstance(request, self.service.srv_type.Request):
            expected = self.service.srv_type.Request.__name__
            raise TypeError(f"{self.service.name} takes a {expected}, got {type(request).__name__}")
        return self.bus.call(self.service, copied(request))

    def call(self, request: Any) -> Any:
        """Not on the bus, where a callback that waits would wait for ever. raises: RuntimeError."""
        raise RuntimeError(f"a callback must not wait for {self.service.name}: use call_async and add_done_callback")
