"""The clock that nodes on the bus read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..handle import Handle
from ..instant import Duration, Instant

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

    def sleep_for(self, rel_time: Duration, context: Any = None) -> bool:
        """Lets simulated time pass. The simulation runs meanwhile.

        Args:
            rel_time: How long.
            context: Ignored.

        Raises:
            RuntimeError: Called from a callback, where simulated time stands still.
        """
        return self.sleep_until(self.now() + rel_time)

    def sleep_until(self, until: Instant, context: Any = None) -> bool:
        """Lets simulated time pass until a time of this clock. Otherwise the same as `sleep_for`."""
        if self._bus.is_running:
            raise RuntimeError("a callback must not sleep, because simulated time stands still: use a timer")
        self._bus.run_until(max(self._bus.time_ns, until.nanoseconds - self._bus.clock_offset_ns))
        return True
