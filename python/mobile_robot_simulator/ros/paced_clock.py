"""PacedClock: simulated time that runs at a multiple of wall time."""

from __future__ import annotations

import time
from collections.abc import Callable

from ..instant import Instant


class PacedClock:
    """Clock that starts at the current wall time and then runs `speed` times as fast as wall time. `speed` starts at 1.

    A change of speed never makes the time jump. One thread may read the clock while another changes its speed.

    Args:
        wall: Returns the wall time [ns].

    Example:
        >>> clock = PacedClock()
        >>> clock.set_speed(10.0)  # From now on, 0.1 s of wall time is 1 s of simulated time.
    """

    def __init__(self, wall: Callable[[], int] = time.time_ns) -> None:
        self._wall = wall
        start = wall()
        # Simulated time [ns], wall time [ns] and speed at the last change. One tuple, so that no thread reads half a change.
        self._pace = (start, start, 1.0)

    @property
    def speed(self) -> float:
        """Simulated seconds per second of wall time."""
        return self._pace[2]

    def now(self) -> Instant:
        """Returns the simulated time."""
        return Instant(self._at(self._wall()))

    def set_speed(self, speed: float) -> None:
        """Runs the clock `speed` times as fast as wall time from now on.

        Afterwards, `Executor.wake` must be called, so that timers follow the new speed.

        Args:
            speed: Simulated seconds per second of wall time, positive.
        """
        if speed != self.speed:
            wall = self._wall()
            self._pace = (self._at(wall), wall, speed)

    def _at(self, wall: int) -> int:
        start, wall_start, speed = self._pace
        return start + round((wall - wall_start) * speed)
