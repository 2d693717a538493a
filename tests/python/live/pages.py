"""A page of a live view without a browser: a plain WebSocket in a thread of its own."""

from __future__ import annotations

import asyncio
import json
import re
import threading
import time
import urllib.error
import urllib.request
from urllib.parse import urlsplit

import websockets


def fetch(url: str, **headers: str) -> tuple[int, str]:
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=20) as answer:
            return answer.status, answer.read().decode(errors="replace")
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def viewer_of(url: str) -> str:
    """Returns the identifier that the server gave a page."""
    found = re.search(r'viewer\\?["\': ]+([0-9a-f-]{36})', fetch(url)[1])
    assert found, "the page names no viewer"
    return found[1]


class Page:
    """A page in a thread of its own: sends inputs and keeps what arrives."""

    def __init__(self, url: str) -> None:
        self.address = f"ws://{urlsplit(url).netloc}/live/socket?viewer={viewer_of(url)}"
        self.parts: dict[str, object] = {}
        self.answers: list[dict[str, object]] = []
        self._wanted: list[dict[str, object]] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._talk()), daemon=True)
        self._thread.start()
        self.wait(lambda: "now" in self.parts)

    async def _talk(self) -> None:
        async with websockets.connect(self.address, max_size=None, proxy=None) as socket:
            while not self._ended.is_set():
                while self._wanted:
                    await socket.send(json.dumps(self._wanted.pop(0)))
                try:
                    message = json.loads(await asyncio.wait_for(socket.recv(), 0.02))
                except TimeoutError:
                    continue
                except asyncio.TimeoutError:
                    continue
                self.answers += message.pop("answers", [])
                self.parts.update(message)
                await socket.send('{"kind": "drawn"}')

    def send(self, kind: str, **values: object) -> None:
        self._wanted.append({"kind": kind, "id": 1, **values})

    def wait(self, condition, seconds: float = 20.0) -> None:
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, "it did not happen"
            time.sleep(0.01)

    def close(self) -> None:
        self._ended.set()
        self._thread.join(5.0)


def background(call) -> threading.Thread:
    thread = threading.Thread(target=call, daemon=True)
    thread.start()
    return thread
