"""Services of the bus and the clients that call them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..handle import Handle
from ..messages import copied
from ..nodes.future import Future

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
    """

    send: Callable[[BusService, Any], Future]
    service: BusService

    def service_is_ready(self) -> bool:
        """Returns True if a node offers the service."""
        return self.service.handler is not None

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Returns True if a node offers the service. Does not wait: simulated time stands still during a callback."""
        return self.service_is_ready()

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
