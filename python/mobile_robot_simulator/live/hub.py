"""Hub: passes frames from a session to the pages of its viewers, and their inputs back. It joins two threads."""

from __future__ import annotations

import asyncio
import json
import queue
import threading
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any

from .inputs import ONLY_LOOKS, Input, read_input
from .parts import Frame

MOST_WAITING = 1000
"""Inputs that can wait for the simulation. More are refused."""

AHEAD = 2
"""Frames that a page may be sent before it has drawn the first of them. A slow page gets fewer frames, not older ones."""


@dataclass
class Viewer:
    """One open page.

    Attributes:
        name: Its identifier, which nobody else knows.
        loop: Event loop of the server.
        wake: Set if there is something to send.
        waiting: Frames that were sent and not yet drawn.
        sent: Parts that the page has.
        trails: Epoch and number of the points that the page has, by robot.
        notes: Texts to show.
        answers: Results of the page's inputs, each with what the page calls the input.
    """

    name: str
    loop: asyncio.AbstractEventLoop
    wake: asyncio.Event = field(default_factory=asyncio.Event)
    waiting: int = 0
    sent: dict[str, bytes] = field(default_factory=dict)
    trails: dict[str, tuple[int, int]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    answers: list[dict[str, Any]] = field(default_factory=list)

    def take(self, frame: Frame, holder: str | None, viewers: int) -> str | None:
        """Returns the message that brings the page to a frame, or None if nothing has changed.

        Args:
            frame: The frame.
            holder: Name of the viewer who holds the controls, or None.
            viewers: Number of viewers.
        """
        parts = dict(frame.parts)
        controls = {"count": viewers, "holds": holder == self.name, "free": holder is None}
        parts["viewers"] = json.dumps(controls).encode()
        changed = {name: part for name, part in parts.items() if self.sent.get(name) != part}
        gone = [name for name in self.sent if name not in parts]
        texts = [f'"{name}":{part.decode()}' for name, part in changed.items()]
        texts += [f'"{name}":null' for name in gone]
        texts += self._new_points(frame)
        self.sent = parts
        if self.notes:
            notes, self.notes = self.notes, []
            texts.append(f'"notes":{json.dumps(notes)}')
        if self.answers:
            answers, self.answers = self.answers, []
            texts.append(f'"answers":{json.dumps(answers)}')
        return "{" + ",".join(texts) + "}" if texts else None

    def _new_points(self, frame: Frame) -> list[str]:
        texts = []
        for robot, trail in frame.trails.items():
            epoch, count = self.trails.get(robot, (-1, 0))
            first = count if epoch == trail.epoch else 0
            points = trail.points[first:]
            if points or epoch != trail.epoch:
                rows = ",".join("null" if row is None else f"[{row[0]},{row[1]},{row[2]},{row[3]}]" for row in points)
                texts.append(f'"trail:{robot}":{{"first":{first},"points":[{rows}]}}')
                self.trails[robot] = trail.epoch, first + len(points)
        return texts


class Hub:
    """Viewers of one session. The session's thread calls `show` and `next_input`; the server's thread calls the rest."""

    def __init__(self) -> None:
        self.frame: Frame | None = None
        self._lock = threading.Lock()
        self._viewers: dict[str, Viewer] = {}
        self._holder: str | None = None
        self._inputs: queue.Queue[tuple[Input, Future[Any]]] = queue.Queue(MOST_WAITING)
        self._closed = False

    # --- the session's side ---

    @property
    def has_viewers(self) -> bool:
        """True if a page is open."""
        return bool(self._viewers)

    def show(self, frame: Frame) -> None:
        """Shows a frame to all viewers."""
        self.frame = frame
        self._wake_all()

    def tell_all(self, text: str) -> None:
        """Shows a text to all viewers."""
        with self._lock:
            viewers = list(self._viewers.values())
        for viewer in viewers:
            viewer.notes.append(text)
        self._wake_all()

    def next_input(self, timeout: float) -> tuple[Input, Future[Any]] | None:
        """Returns the next input and where its result goes, or None after a time without one [s]."""
        try:
            return self._inputs.get(timeout=max(0.0, timeout)) if timeout > 0.0 else self._inputs.get_nowait()
        except queue.Empty:
            return None

    def close(self) -> None:
        """Refuses all inputs from now on, also those that wait."""
        self._closed = True
        while (waiting := self.next_input(0.0)) is not None:
            waiting[1].set_exception(ValueError("the view is closed"))
        self._wake_all()

    # --- the server's side ---

    def join(self, name: str) -> Viewer:
        """Adds a page that has connected, in the thread of the server's event loop."""
        viewer = Viewer(name, asyncio.get_running_loop())
        with self._lock:
            self._viewers[name] = viewer
        self._wake_all()
        return viewer

    def leave(self, viewer: Viewer) -> None:
        """Removes a page. If it held the controls, nobody holds them. Its last command times out."""
        with self._lock:
            if self._viewers.get(viewer.name) is not viewer:
                return  # the same page has connected again
            del self._viewers[viewer.name]
            if self._holder == viewer.name:
                self._holder = None
        self._wake_all()

    def take_controls(self, name: str) -> None:
        """Gives the controls to a viewer. The last command of the one before times out."""
        with self._lock:
            self._holder = name
        self._wake_all()

    def submit(self, name: str, data: object) -> Future[Any]:
        """Passes an input to the simulation. The first viewer that does something gets the controls.

        Args:
            name: The viewer.
            data: The input, as decoded JSON.

        Returns:
            The result. It is set in the session's thread; it can be an exception that `Session.do` raises.
        """
        try:
            wanted = read_input(data)
            if not isinstance(wanted, ONLY_LOOKS):
                with self._lock:
                    if self._holder not in (None, name):
                        raise ValueError("another viewer holds the controls; press “Take the controls”")
                    self._holder = name
        except ValueError as error:
            refused: Future[Any] = Future()
            refused.set_exception(error)
            return refused
        return self._put(wanted)

    def answer(self, viewer: Viewer, identity: object, result: Future[Any]) -> None:
        """Sends the result of an input to its page. Can be called in any thread.

        Args:
            viewer: The page.
            identity: What the page calls the input.
            result: The result.
        """
        error = result.exception()
        outcome = {"value": result.result()} if error is None else {"error": str(error)}
        viewer.answers.append({"id": identity, **outcome})
        viewer.loop.call_soon_threadsafe(viewer.wake.set)

    @property
    def is_closed(self) -> bool:
        """True after `close`."""
        return self._closed

    def message_for(self, viewer: Viewer) -> str | None:
        """Returns what to send to a page now, or None if there is nothing or the page is behind."""
        if self.frame is None or viewer.waiting >= AHEAD:
            return None
        return viewer.take(self.frame, self._holder, len(self._viewers))

    def _put(self, wanted: Input) -> Future[Any]:
        result: Future[Any] = Future()
        if self._closed:
            result.set_exception(ValueError("the view is closed"))
            return result
        try:
            self._inputs.put_nowait((wanted, result))
        except queue.Full:
            result.set_exception(ValueError("the simulation does not run now, so it takes no more inputs"))
        return result

    def _wake_all(self) -> None:
        with self._lock:
            viewers = list(self._viewers.values())
        for viewer in viewers:
            viewer.loop.call_soon_threadsafe(viewer.wake.set)
