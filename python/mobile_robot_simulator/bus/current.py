"""The bus in use: the one whose callback runs, or on which a node is being created."""

from __future__ import annotations

from contextvars import ContextVar
from typing import Protocol


class Times(Protocol):
    """What the clock of a bus needs from it.

    Attributes:
        time_ns: Simulated time [ns].
        clock_offset_ns: Time on the nodes' clocks minus simulated time [ns].
    """

    time_ns: int
    clock_offset_ns: int

    @property
    def clock_ns(self) -> int:
        """Time on the nodes' clocks [ns]."""

    @property
    def is_running(self) -> bool:
        """True during a run, so a callback has made the call."""

    def run_until(self, time_ns: int) -> None:
        """Runs all events up to and including a time, then sets the simulated time to it."""


_current: ContextVar[Times | None] = ContextVar("current_bus", default=None)


set_current, reset_current = _current.set, _current.reset
"""What `using` does at its beginning and at its end. `Bus.run_until` calls them directly, because it runs very often."""


def current_bus() -> Times | None:
    """Returns the bus in use, or None outside of callbacks and of constructors that `Simulation.spawn` runs."""
    return _current.get()


class using:
    """Makes a bus the one in use in a `with` block.

    Args:
        bus: The bus.
    """

    __slots__ = ("_bus", "_token")

    def __init__(self, bus: Times) -> None:
        self._bus = bus

    def __enter__(self) -> None:
        self._token = set_current(self._bus)

    def __exit__(self, *_: object) -> None:
        reset_current(self._token)
