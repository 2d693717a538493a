"""PacedClock: simulated time on the wall's clock, at a speed that changes without a jump."""

from __future__ import annotations

import time
from collections.abc import Callable

from ..instant import Instant


class PacedClock:
    """The wall's time until the speed is changed, and from there on so many times as fast.

    wall: nanoseconds on the wall's clock.
    """

    def __init__(self, wall: Callable[[], int] = time.time_ns) -> None:
        self._wall = wall
        start = wall()
        # Replaced as one, so that a reader in another thread never sees half a change.
        self._pace = (start, start, 1.0)
        self.listeners: list[Callable[[], None]] = []
        """Called after each change of speed."""

    @property
    def speed(self) -> float:
        """Simulated seconds per second on the wall."""
        return self._pace[2]

    def now(self) -> Instant:
        """The simulated time."""
        return Instant(self._at(self._wall()))

    def set_speed(self, speed: float) -> None:
        """Go so many times as fast as the wall from this moment on."""
        if speed == self.speed:
            return
        wall = self._wall()
        self._pace = (self._at(wall), wall, speed)
        for listener in tuple(self.listeners):
            listener()

    def _at(self, wall: int) -> int:
        start, wall_start, speed = self._pace
        return start + round((wall - wall_start) * speed)
