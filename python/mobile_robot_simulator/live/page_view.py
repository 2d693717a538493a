"""PageView: something in the browser that runs, and that viewers control."""

from __future__ import annotations

import time
import webbrowser
from typing import Any, Protocol, TypeVar

from .._core import OccupancyGrid
from .hub import Hub
from .inputs import Input
from .parts import Frame

try:
    from .server import the_server
except ImportError as error:
    raise ImportError("the live view needs NiceGUI: pip install 'mobile-robot-simulator[live]'") from error

V = TypeVar("V", bound="PageView")

TURN = 0.02
"""Longest wall time between two turns [s]."""

REFUSALS = (ValueError, TypeError, RuntimeError, OSError, ImportError)
"""Exceptions that refuse an input. The page shows them."""


class Controlled(Protocol):
    """What runs, such as a simulation or a recording.

    Attributes:
        notes: What all viewers should be told. Whoever tells them, clears it.
    """

    notes: list[str]

    def turn(self, wall: float) -> None:
        """Runs up to a wall time [s], as from `time.monotonic`."""

    def do(self, wanted: Input) -> Any:
        """Does what a viewer wants. Raises one of `REFUSALS` if it is not possible."""

    def close(self) -> None:
        """Ends what has to be ended."""


class Drawn(Protocol):
    """What a page shows."""

    @property
    def grid(self) -> OccupancyGrid:
        """The map of the last frame."""

    def make(self) -> Frame:
        """Returns the frame of the present."""


class PageView:
    """Something in the browser that runs, and that viewers control.

    Args:
        controlled: What runs.
        drawn: What the page shows.
        host: Address to listen on. With another one than 127.0.0.1 or localhost, the address of the page contains a token.
        port: Port; 0 chooses a free one.

    Attributes:
        url: Address of the page.

    Raises:
        OSError: The address cannot be used.
    """

    def __init__(self, controlled: Controlled, drawn: Drawn, host: str, port: int) -> None:
        self._controlled, self._drawn, self._hub = controlled, drawn, Hub()
        self._is_turning = self._is_closed = False
        self.url, self._port = the_server().show(self._hub, lambda: drawn.grid, host, port)
        self._show()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.url})"

    def _repr_html_(self) -> str:
        """Returns the page as a frame, for notebooks."""
        frame = f'<iframe src="{self.url}" width="100%" height="640" style="border:0"></iframe>'
        return f'{frame}<br><a href="{self.url}">{self.url}</a>'

    @property
    def is_closed(self) -> bool:
        """True after `close`."""
        return self._is_closed

    def open_browser(self) -> None:
        """Opens the page in the browser of this machine."""
        webbrowser.open_new_tab(self.url)

    def run(self, seconds: float = float("inf")) -> None:
        """Runs under the control of the page, until Ctrl-C or for a time.

        Args:
            seconds: Wall time [s].
        """
        end = time.monotonic() + seconds
        while not self._is_closed and (now := time.monotonic()) < end:
            self._take_inputs(min(end, now + TURN))
            self._turn()

    def close(self) -> None:
        """Closes the page. Closing twice has no effect."""
        if not self._is_closed:
            self._is_closed = True
            self._controlled.close()
            self._hub.close()
            the_server().close(self._port)

    def __enter__(self: V) -> V:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _turn(self) -> None:
        self._is_turning = True
        try:
            self._controlled.turn(time.monotonic())
        finally:
            self._is_turning = False
        self._show()

    def _take_inputs(self, deadline: float) -> None:
        """Takes inputs until a wall time [s]."""
        while (waiting := self._hub.next_input(deadline - time.monotonic())) is not None:
            wanted, result = waiting
            before, self._is_turning = self._is_turning, True
            try:
                result.set_result(self._controlled.do(wanted))
            except REFUSALS as error:
                result.set_exception(error)
            finally:
                self._is_turning = before

    def _show(self) -> None:
        for note in self._controlled.notes:
            self._hub.tell_all(note)
        self._controlled.notes.clear()
        if self._hub.has_viewers or self._hub.frame is None:
            self._hub.show(self._drawn.make())
