"""Server: serves the pages of all live views of a process, in one thread of its own. NiceGUI allows one app per process."""

from __future__ import annotations

import asyncio
import gzip
import json
import os
import secrets
import socket
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial

import uvicorn
from fastapi import FastAPI, Request, Response, WebSocket, WebSocketDisconnect
from nicegui import context, ui

from .._core import OccupancyGrid
from .hub import Hub, Viewer
from .page import LivePage

LOCAL = ("127.0.0.1", "localhost", "::1")
"""Names of this machine for itself. Only with these, no token is needed."""

NEEDS_TOKEN = "The address needs the token that was printed when the view was opened."
NOT_LOCAL = "This view only answers to localhost and 127.0.0.1. Open it with another host to reach it from elsewhere."


@dataclass
class Place:
    """Where the server shows one simulation.

    Attributes:
        hub: Passes frames and inputs.
        grid: Returns the map.
        token: What the address must contain; empty if it need not.
        server: Listens on the port of the place.
        names: Identifiers of the pages that were served.
    """

    hub: Hub
    grid: Callable[[], OccupancyGrid]
    token: str
    server: uvicorn.Server
    names: set[str] = field(default_factory=set)

    def refusal(self, request: Request, token: str) -> Response | None:
        """Returns the answer to a request for a page that must not have it, else None."""
        if self.token:
            is_right = secrets.compare_digest(token.encode(), self.token.encode())
            return None if is_right else Response(NEEDS_TOKEN, status_code=403)
        # Otherwise a site could give its own name the address of this machine, and its scripts could read the page.
        return None if request.url.hostname in LOCAL else Response(NOT_LOCAL, status_code=403)


class Server:
    """The server of a process. Use `the_server()`."""

    def __init__(self) -> None:
        self._places: dict[int, Place] = {}
        self._app = app = FastAPI(openapi_url=None)
        app.add_api_route("/live/map", self._map)
        app.add_api_websocket_route("/live/socket", self._talk)
        ui.page("/")(self._page)
        ui.run_with(app, title="mobile-robot-simulator", dark=None, tailwind=False, show_welcome_message=False)
        self._loop = asyncio.new_event_loop()
        started = threading.Event()
        threading.Thread(target=self._run, args=(started,), daemon=True, name="live").start()
        started.wait()

    def show(self, hub: Hub, grid: Callable[[], OccupancyGrid], host: str, port: int) -> tuple[str, int]:
        """Shows a simulation at a port.

        Args:
            hub: Passes frames and inputs.
            grid: Returns the map.
            host: Address to listen on.
            port: Port; 0 chooses a free one.

        Returns:
            The address of the page, and its port.

        Raises:
            OSError: The address cannot be used.
            ValueError: The port is not in 0..65535.
        """
        if not 0 <= port < 2**16:
            raise ValueError(f"the port must be in 0..65535, got {port}")
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            listening = socket.create_server((host, port), family=family)
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno and error.errno > 0 else str(error)
            message = f"cannot listen on {host}, port {port}: {reason}; port 0 chooses a free one"
            raise OSError(error.errno, message) from None
        token = "" if host in LOCAL else secrets.token_urlsafe(16)
        config = uvicorn.Config(
            self._app, lifespan="off", log_level="error", ws_max_size=2**16, ws_per_message_deflate=False, access_log=False
        )
        port = listening.getsockname()[1]
        self._places[port] = place = Place(hub, grid, token, uvicorn.Server(config))
        asyncio.run_coroutine_threadsafe(place.server.serve(sockets=[listening]), self._loop)
        shown = f"[{host}]" if ":" in host else socket.gethostname() if host in ("0.0.0.0", "") else host
        return f"http://{shown}:{port}/" + (f"?token={token}" if token else ""), port

    def close(self, port: int) -> None:
        """Ends showing the simulation at a port."""
        place = self._places.pop(port, None)
        if place is not None:
            place.server.should_exit = True

    def _run(self, started: threading.Event) -> None:
        asyncio.set_event_loop(self._loop)

        async def serve() -> None:
            async with self._app.router.lifespan_context(self._app):
                started.set()
                await asyncio.Event().wait()

        self._loop.run_until_complete(serve())

    def _page(self, request: Request, token: str = "") -> Response | None:
        place = self._places.get(request.scope["server"][1])
        if place is None:
            return Response("The view is closed.", status_code=404)
        if (refusal := place.refusal(request, token)) is not None:
            return refusal
        ui.dark_mode(None)
        place.names.add(name := context.client.id)
        LivePage(name)
        return None

    def _map(self, request: Request, viewer: str = "") -> Response:
        """Returns the cells as int8, row 0 first, compressed."""
        place = self._places.get(request.scope["server"][1])
        if place is None or viewer not in place.names:
            return Response(status_code=403)
        cells = gzip.compress(place.grid().cells.tobytes(), 1)
        return Response(cells, media_type="application/octet-stream", headers={"Content-Encoding": "gzip"})

    async def _talk(self, websocket: WebSocket, viewer: str = "") -> None:
        """Sends frames to a page and takes its inputs. Only a page that this server made knows its identifier."""
        place = self._places.get(websocket.scope["server"][1])
        await websocket.accept()
        if place is None or viewer not in place.names:
            await websocket.close(4403)  # the page loads itself again
            return
        joined = place.hub.join(viewer)
        sender = asyncio.create_task(_send(place.hub, websocket, joined))
        try:
            while True:
                data = json.loads(await websocket.receive_text())
                kind = data.get("kind") if isinstance(data, dict) else None
                if kind == "drawn":
                    joined.waiting -= 1
                    joined.wake.set()
                elif kind == "take_controls":
                    place.hub.take_controls(viewer)
                else:
                    identity = data.pop("id", None) if isinstance(data, dict) else None
                    place.hub.submit(viewer, data).add_done_callback(partial(place.hub.answer, joined, identity))
        except (WebSocketDisconnect, ValueError):
            pass
        finally:
            sender.cancel()
            place.hub.leave(joined)


async def _send(hub: Hub, websocket: WebSocket, viewer: Viewer) -> None:
    with suppress(WebSocketDisconnect, RuntimeError):
        while True:
            await viewer.wake.wait()
            viewer.wake.clear()
            if (message := hub.message_for(viewer)) is not None:
                viewer.waiting += 1
                await websocket.send_text(message)


@cache
def the_server() -> Server:
    """Returns the server of this process, and starts it at the first call."""
    return Server()
