"""LiveView: a simulation in the browser."""

from __future__ import annotations

import asyncio
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ..messages import Message
from ..recording.format import Format
from .frames import FrameMaker
from .journal import Journal
from .page_view import TURN, PageView
from .session import Session

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation


class LiveView(PageView):
    """A simulation in the browser. Use `Simulation.show`, or the command `live`.

    Only the thread that opened the view touches the simulation: in `run`, in the runs of a script that `follow` watches, and
    in the event loop of a notebook.

    Args:
        simulation: The simulation.
        host: Address to listen on. With another one than 127.0.0.1 or localhost, the address of the page contains a token.
        port: Port; 0 chooses a free one.
        folder: Folder in which recordings are made.
        format: Format of the recordings.
        overwrite: Replace recordings of the same name.
        title: Name of the map, on the page.
        source: Python statements that create the simulation `sim`, for “Copy as Python”. Empty if only the caller knows.
        paused: Start with the time stopped.

    Attributes:
        session: The simulation under the control of viewers.
        url: Address of the page.

    Raises:
        OSError: The address cannot be used.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        host: str = "127.0.0.1",
        port: int = 0,
        folder: str | Path = "live",
        format: Format = "mcap",
        overwrite: bool = False,
        title: str = "",
        source: str = "",
        paused: bool = False,
    ) -> None:
        journal = Journal(source, round(simulation.time * 1e9))
        self.session = Session(simulation, journal, Path(folder), format=format, overwrite=overwrite, paused=paused)
        self._is_followed = False
        self._last_look = 0.0
        self._allowed_ns = 0
        self._task: asyncio.Task[None] | None = None
        super().__init__(self.session, FrameMaker(self.session, title), host, port)

    def run(self, seconds: float = float("inf")) -> None:
        """Runs the simulation under the control of the page, until Ctrl-C or for a time.

        Args:
            seconds: Wall time [s].
        """
        is_watching, self.session.is_watching = self.session.is_watching, False
        super().run(seconds)
        self.session.is_watching = is_watching

    def follow(self) -> None:
        """Shows what a script does with the simulation, at the speed that the page asks for.

        While a page has paused the simulation, the script waits. In a notebook, the page can also run the simulation, while
        no cell runs.
        """
        if self._is_followed:
            return
        self._is_followed = self.session.is_watching = True
        self.session.simulation.record(self._watch)
        try:
            loop = asyncio.get_running_loop()
        except RuntimeError:
            return
        self._task = loop.create_task(self._turn_between_cells())

    def close(self) -> None:
        """Closes the page, stops the robots that a viewer drives, and ends a recording."""
        if self._is_closed:
            return
        if self._task is not None:
            self._task.cancel()
        if self._is_followed:
            with suppress(ValueError):  # the simulation is closed
                self.session.simulation.stop_recording(self._watch)
        super().close()

    async def _turn_between_cells(self) -> None:
        while not self._is_closed:
            self.session.is_watching = False
            self._take_inputs(0.0)
            self._turn()
            self.session.is_watching = True
            await asyncio.sleep(TURN)

    # --- runs of a script ---

    def _watch(self, topic: str, message: Message, time_ns: int) -> None:
        """Is called with each message while a script runs the simulation: takes inputs, shows frames and keeps the pace."""
        if self._is_turning or self._is_closed:
            return
        self._is_turning = True  # commands are messages too
        try:
            self._keep_pace()
        finally:
            self._is_turning = False

    def _keep_pace(self) -> None:
        session, pace = self.session, self.session.pace
        now = time.monotonic()
        if now - self._last_look > 0.5:  # the script did something else meanwhile
            pace.due_ns(now)
            self._allowed_ns = session.now_ns
        while True:
            if now - self._last_look >= TURN:
                self._last_look = now
                self._take_inputs(now)
                session.pilots.end_held(now)
                self._allowed_ns += pace.due_ns(now) + session.steps_ns
                session.steps_ns = 0
                session.note_time(now)
                self._show()
            session.pilots.send_due()
            if session.now_ns <= self._allowed_ns or (pace.paused and not self._hub.has_viewers):
                return
            time.sleep(TURN / 4)
            now = time.monotonic()
