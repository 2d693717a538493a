"""The clock that nodes on the bus read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..handle import Handle
from ..instant import Instant

if TYPE_CHECKING:
    from .bus import Bus


class BusClock(Handle):
    """Shows the simulated time plus `Bus.clock_offset_ns`.

    Args:
        bus: Bus whose time the clock shows.
    """

    def __init__(self, bus: Bus) -> None:
        self._bus = bus

    def now(self) -> Instant:
        """Returns the current time of the clock."""
        return Instant(self._bus.clock_ns)
