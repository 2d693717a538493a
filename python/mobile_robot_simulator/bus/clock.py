"""The clock that nodes on the bus read."""

from __future__ import annotations

from typing import Any

from ..handle import Handle
from ..instant import Duration, Instant, instant_at
from .current import Times, current_bus


class BusClock(Handle):
    """Shows the simulated time plus `Bus.clock_offset_ns`.

    Args:
        bus: Bus whose time the clock shows. None for the bus in use, now or at the first call.
        **_: Keywords of rclpy, such as `clock_type`, are ignored: all clocks on the bus show its time.
    """

    def __init__(self, bus: Times | None = None, **_: Any) -> None:
        self._found = bus or current_bus()

    def now(self) -> Instant:
        """Returns the current time of the clock.

        Raises:
            RuntimeError: The clock has no bus yet, because it was neither made nor called by a node.
        """
        bus = self._found or self._bus
        return instant_at(bus.time_ns + bus.clock_offset_ns)

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

    @property
    def _bus(self) -> Times:
        self._found = self._found or current_bus()
        if self._found is None:
            raise RuntimeError("the clock has no bus: make or call it in a node, or use node.get_clock()")
        return self._found
