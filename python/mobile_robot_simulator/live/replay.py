"""Replay: a recording that runs at the pace of the wall clock, forwards from any time."""

from __future__ import annotations

from bisect import bisect_right
from typing import Any

from ..instant import NANOSECONDS
from ..logs.playback import Playback
from . import inputs
from .pace import Pace
from .trail import Trail

SAMPLES = 5000
"""Largest number of times at which a path is sampled, beside its end."""

FINEST_NS = NANOSECONDS // 20
"""Shortest time between two samples of a path [ns]."""


class Way:
    """The path of a robot through a whole recording, of which the part until now is shown.

    Args:
        playback: The recording.
        robot: Name of the robot.
    """

    def __init__(self, playback: Playback, robot: str) -> None:
        self._all, self._times = Trail(), list[int]()
        self._shown, self._count = Trail(), 0
        step_ns = max(FINEST_NS, -(-(playback.end_ns - playback.begin_ns) // SAMPLES))
        for time_ns in (*range(playback.begin_ns, playback.end_ns, step_ns), playback.end_ns):
            if (played := playback.robot_at(robot, time_ns)) is not None:
                self._all.add(played.pose, played.believed)
                self._times += [time_ns] * (len(self._all.points) - len(self._times))

    @property
    def points(self) -> list[tuple[float, float, float, float] | None]:
        """All points of the path, as in `Trail`."""
        return self._all.points

    def until(self, time_ns: int) -> Trail:
        """Returns the part until a time [ns]. It is the same object in all calls, and changes with them."""
        count = bisect_right(self._times, time_ns)
        if count < self._count:
            self._shown.clear()
            self._count = 0
        self._shown.points += self._all.points[self._count : count]
        self._count = count
        return self._shown


class Replay:
    """A recording under the control of viewers, who can stop it, choose its speed and go to any time.

    Args:
        playback: The recording.
        paused: Start with the time stopped.

    Attributes:
        playback: The recording.
        pace: Whether time runs, and how fast.
        ways: Paths of the robots by name.
        notes: What all viewers should be told. Whoever tells them, clears it.
    """

    def __init__(self, playback: Playback, *, paused: bool = False) -> None:
        self.playback, self.pace = playback, Pace(1.0, paused=paused)
        self.ways = {name: Way(playback, name) for name in playback.robots}
        self.notes: list[str] = []
        self._passed_ns = 0

    @property
    def now_ns(self) -> int:
        """Time on the clock of the recording [ns]."""
        return self.playback.begin_ns + self._passed_ns

    @property
    def time(self) -> float:
        """Time since the beginning of the recording [s]."""
        return self._passed_ns / NANOSECONDS

    @property
    def duration(self) -> float:
        """Duration of the recording [s]."""
        return (self.playback.end_ns - self.playback.begin_ns) / NANOSECONDS

    def turn(self, wall: float) -> None:
        """Goes on to a wall time [s], as from `time.monotonic`. At the end of the recording, time stops."""
        self._go_to(self._passed_ns + self.pace.due_ns(wall))
        self.pace.note(wall, self.now_ns)
        if self.now_ns == self.playback.end_ns:
            self.pace.paused = True

    def do(self, wanted: inputs.Input) -> Any:
        """Does what a viewer wants.

        Raises:
            ValueError: It is not possible with a recording. Nothing changes.
        """
        if isinstance(wanted, inputs.Seek):
            self._jump(round(wanted.time * NANOSECONDS))
        elif isinstance(wanted, inputs.Speed):
            self.pace.speed = wanted.factor
        elif isinstance(wanted, inputs.Step):
            self.pace.paused = True
            self._jump(self._passed_ns + round(wanted.seconds * NANOSECONDS))
        elif isinstance(wanted, inputs.Pause):
            if not wanted.paused and self.now_ns == self.playback.end_ns:
                self._jump(0)  # once more
            self.pace.paused = wanted.paused
        elif isinstance(wanted, inputs.Reset):
            self._jump(0)
        else:
            raise ValueError("this is a recording: it can be played, but what happened in it cannot be changed")

    def close(self) -> None:
        """Has no effect, because a recording needs no end."""

    def _jump(self, passed_ns: int) -> None:
        self._go_to(passed_ns)
        self.pace.forget()

    def _go_to(self, passed_ns: int) -> None:
        self._passed_ns = max(0, min(passed_ns, self.playback.end_ns - self.playback.begin_ns))
