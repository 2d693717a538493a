"""Services of the bus and the clients that call them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..handle import Handle
from ..messages import copied
from ..nodes.future import Future
from .waiting import Waiting

ServiceHandler = Callable[[Any, Any], Any]
"""Takes the request and an empty response, and returns the response."""


@dataclass(eq=False)
class BusService(Handle):
    """A service: its name, its type and the callback that answers requests.

    Attributes:
        name: Absolute name.
        srv_type: Service class with `Request` and `Response`.
        handler: Callback that answers requests. None if no node offers the service.
    """

    name: str
    srv_type: Any
    handler: ServiceHandler | None = None


@dataclass(eq=False)
class BusClient(Handle):
    """Calls a service.

    Attributes:
        send: Function that sends a request to a service and returns a future for the response (`Bus.call`).
        service: Service to call.
        waiting: Waits on the bus.
    """

    send: Callable[[BusService, Any], Future]
    service: BusService
    waiting: Waiting

    @property
    def srv_name(self) -> str:
        """Absolute name of the service."""
        return self.service.name

    def service_is_ready(self) -> bool:
        """Returns True if a node offers the service."""
        return self.service.handler is not None

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Waits until a node offers the service.

        In the constructor of a node, the simulation runs while it waits. A callback does not wait, because simulated time
        stands still there.

        Args:
            timeout_sec: Longest simulated time to wait [s]. None for no limit.

        Returns:
            True if a node offers the service.

        Raises:
            RuntimeError: The wait would never end: 300 s in a row without the service, 100 tries in the same callback, or a
                callback without a timeout.
        """
        hint = "spawn the node that offers it before this one"
        return self.waiting.wait(self.service_is_ready, timeout_sec, f"service {self.service.name}", hint)

    def call_async(self, request: Any) -> Future:
        """Calls the service with a copy of the request.

        Returns:
            A future for the response. The response arrives at the same simulated time, after the current callback has
            returned. If no node offers the service at that moment, the future never completes.

        Raises:
            TypeError: The request is not an instance of the service's `Request`.
        """
        if not isinstance(request, self.service.srv_type.Request):
            expected = self.service.srv_type.Request.__name__
            raise TypeError(f"{self.service.name} takes a {expected}, got {type(request).__name__}")
        return self.send(self.service, copied(request))

    def call(self, request: Any) -> Any:
        """Always raises an error, because a callback that waits for a response would wait forever.

        Raises:
            RuntimeError: Always.
        """
        raise RuntimeError(f"a callback must not wait for {self.service.name}: use call_async and add_done_callback")
