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
    """A named service.

    Attributes:
        name: Absolute name.
        srv_type: Service class with `Request` and `Response`.
        handler: Answers requests. None if no node offers the service.

    """

    name: str
    srv_type: Any
    handler: ServiceHandler | None = None


@dataclass(eq=False)
class BusClient(Handle):
    """Calls a service.

    Attributes:
        send: Sends a request to a service and returns the future of the response (`Bus.call`).
        service: Service that is called.

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
            The future of the response. The response arrives at the same simulated moment, after the current callback has
            returned. If no node offers the service then, the future never completes.

        Raises:
            TypeError: The request is not of the service's request type.

        """
        if not isinstance(request, self.service.srv_type.Request):
            expected = self.service.srv_type.Request.__name__
            raise TypeError(f"{self.service.name} takes a {expected}, got {type(request).__name__}")
        return self.send(self.service, copied(request))

    def call(self, request: Any) -> Any:
        """Always fails: a callback that waits for a response would wait forever.

        Raises:
            RuntimeError: Always.

        """
        raise RuntimeError(f"a callback must not wait for {self.service.name}: use call_async and add_done_callback")
