"""Pace: how much simulated time is due at a wall time."""

from __future__ import annotations

from collections import deque

from ..instant import NANOSECONDS

LONGEST_TURN = 0.1
"""Longest wall time that one turn makes up for [s]. If the machine is slower than that, time falls behind."""

GRAIN_NS = 1_000_000
"""Times at which the simulation stops for inputs are multiples of this [ns], so that scripts are short."""

_RATE_WINDOW = 2.0
"""Wall time over which the real-time factor is measured [s]."""


class Pace:
    """Turns wall time into simulated time.

    Args:
        speed: Simulated seconds per second of wall time.
        paused: Start with the time stopped.

    Attributes:
        speed: Simulated seconds per second of wall time that are wanted.
    """

    def __init__(self, speed: float, *, paused: bool = False) -> None:
        self.speed, self._paused = speed, paused
        self._last_wall: float | None = None
        self._owed_ns = 0.0
        self._rates: deque[tuple[float, int]] = deque()

    @property
    def paused(self) -> bool:
        """True while time stands still."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._paused, self._owed_ns = paused, 0.0

    def due_ns(self, wall: float) -> int:
        """Returns the simulated time that is due since the last call [ns]: whole grains, the rest stays owed.

        Args:
            wall: Current wall time [s], as from `time.monotonic`.
        """
        passed = min(LONGEST_TURN, wall - self._last_wall) if self._last_wall is not None else 0.0
        self._last_wall = wall
        if self._paused:
            return 0
        self._owed_ns += passed * self.speed * NANOSECONDS
        due_ns = int(self._owed_ns // GRAIN_NS) * GRAIN_NS
        self._owed_ns -= due_ns
        return due_ns

    def forget(self) -> None:
        """Forgets what `note` has noted, because the time jumps."""
        self._rates.clear()

    def note(self, wall: float, now_ns: int) -> None:
        """Notes the simulated time at a wall time, to measure the rate."""
        if self._rates and now_ns < self._rates[-1][1]:
            self._rates.clear()  # the simulation went back to a saved state
        self._rates.append((wall, now_ns))
        while self._rates[0][0] < wall - _RATE_WINDOW:
            self._rates.popleft()

    @property
    def rate(self) -> float:
        """Real-time factor: simulated time per wall time over the last seconds."""
        if len(self._rates) < 2:
            return 0.0
        (wall, time_ns), (last_wall, last_ns) = self._rates[0], self._rates[-1]
        return (last_ns - time_ns) / NANOSECONDS / max(1e-9, last_wall - wall)
