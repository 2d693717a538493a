"""A client of the Foxglove WebSocket protocol, as a user's program would be: https://github.com/foxglove/ws-protocol."""

from __future__ import annotations

import json
import struct
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from websockets.sync.client import ClientConnection, connect

PATIENCE = 20.0
"""Wall time to wait for what must come [s]."""


class Client:
    """A connected client. What it receives is in `texts`, `messages`, `times` and `responses`.

    Args:
        socket: The connection.
        turn: Lets the server take its turn. It is called while the client waits.
    """

    def __init__(self, socket: ClientConnection, turn: Callable[[], object]) -> None:
        self._socket, self._turn = socket, turn
        self.texts: list[dict[str, Any]] = []
        self.messages: list[tuple[int, int, bytes]] = []
        """Number of the subscription, time [ns] and data."""
        self.times: list[int] = []
        self._channels: dict[str, dict[str, Any]] = {}
        self._services: dict[str, dict[str, Any]] = {}
        self.responses: list[tuple[int, int, str, bytes]] = []
        """Number of the service and of the call, encoding and data."""

    def send(self, op: str, **fields: Any) -> None:
        self._socket.send(json.dumps({"op": op, **fields}))

    def publish(self, channel: int, data: bytes) -> None:
        self._socket.send(struct.pack("<BI", 1, channel) + data)

    def call(self, service: int, call: int, data: bytes, encoding: bytes = b"cdr") -> None:
        self._socket.send(struct.pack("<BIII", 2, service, call, len(encoding)) + encoding + data)

    def wait(self, condition: Callable[[], Any]) -> Any:
        """Receives until a condition holds, and returns its value."""
        end = time.monotonic() + PATIENCE
        while not (found := condition()):
            assert time.monotonic() < end, f"nothing of the kind in {str(self.texts)[-500:]}, {len(self.messages)} messages"
            self._turn()
            self._receive()
        return found

    def text(self, op: str, **fields: Any) -> dict[str, Any]:
        """Waits for a text with these fields, and returns it. Only texts after the last one found count."""

        def find() -> dict[str, Any] | None:
            for index, each in enumerate(self.texts):
                if each["op"] == op and all(each.get(name) == value for name, value in fields.items()):
                    del self.texts[: index + 1]
                    return each
            return None

        return self.wait(find)

    def channels(self, *topics: str) -> dict[str, dict[str, Any]]:
        """Waits until some topics are offered, and returns all channels by topic."""
        return self.wait(lambda: {*topics} <= {*self._channels} and self._channels)

    def services(self, *names: str) -> dict[str, dict[str, Any]]:
        """Waits until some services are offered, and returns all services by name."""
        return self.wait(lambda: {*names} <= {*self._services} and self._services)

    def subscribe(self, subscription: int, topic: str) -> dict[str, Any]:
        """Subscribes to a topic, and returns its channel."""
        channel = self.channels(topic)[topic]
        self.send("subscribe", subscriptions=[{"id": subscription, "channelId": channel["id"]}])
        return channel

    def data(self, subscription: int, count: int = 1) -> list[tuple[int, bytes]]:
        """Waits for messages of a subscription, and returns all with their times [ns]."""

        def find() -> list[tuple[int, bytes]]:
            found = [(time_ns, data) for number, time_ns, data in self.messages if number == subscription]
            return found if len(found) >= count else []

        return self.wait(find)

    def _receive(self) -> None:
        while True:
            try:
                received = self._socket.recv(timeout=0.01)
            except TimeoutError:
                return
            if isinstance(received, str):
                text = json.loads(received)
                self.texts.append(text)
                self._channels |= {each["topic"]: each for each in text.get("channels", ())}
                self._services |= {each["name"]: each for each in text.get("services", ())}
            elif received[0] == 1:
                subscription, time_ns = struct.unpack_from("<IQ", received, 1)
                self.messages.append((subscription, time_ns, received[13:]))
            elif received[0] == 2:
                self.times.append(struct.unpack_from("<Q", received, 1)[0])
            else:
                assert received[0] == 3
                service, call, length = struct.unpack_from("<III", received, 1)
                self.responses.append((service, call, received[13 : 13 + length].decode(), received[13 + length :]))


@contextmanager
def connected(url: str, turn: Callable[[], object]) -> Iterator[Client]:
    """Connects a client to a server."""
    with connect(url, subprotocols=["foxglove.sdk.v1"], max_size=None) as socket:
        yield Client(socket, turn)
