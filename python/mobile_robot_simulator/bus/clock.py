"""The bus's clock."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..instant import Instant

if TYPE_CHECKING:
    from .bus import Bus

from typing import TYPE_CHECKING


class Clock:
    """The clock that nodes on the bus read: the bus's time, and whatever it is off by."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus

    def __deepcopy__(self, memo: object) -> Clock:
        return self

    def now(self) -> Instant:
        """The moment it is."""
        return Instant(self._bus.clock_ns)
