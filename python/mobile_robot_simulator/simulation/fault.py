"""Fault: something that goes wrong in a simulation for a while."""

from __future__ import annotations

import copy
import math
import random
from abc import ABC, abstractmethod
from collections.abc import Callable
from operator import index
from typing import Any

from ..bus.bus import Bus
from ..handle import Handle
from ..instant import NANOSECONDS
from ..messages import String

TOPIC = "/faults"


def check_at_least_0(**values: float) -> None:
    """Refuse what is negative or not finite, by its name."""
    for name, value in values.items():
        if not 0.0 <= value < math.inf:
            raise ValueError(f"{name} must be finite and at least 0, got {value}")


class Fault(Handle, ABC):
    """Something that goes wrong for a while.

    start, end: when [s]. seed: names what is drawn.
    raises: ValueError for times that are none, or an end before the start; TypeError for a seed that is no whole number.
    """

    def __init__(self, *, start: float = 0.0, end: float = math.inf, seed: int = 0) -> None:
        if not (0.0 <= start < math.inf and start < end):
            raise ValueError(f"a fault must start at 0 s or later and end after that, got start {start} and end {end}")
        self.start, self.end = start, end
        self._random = random.Random(index(seed))  # documented to give the same numbers everywhere
        self._bus: Bus | None = None

    def add_to(self, simulation: Any, bus: Bus) -> None:
        """Begin to act on a simulation. raises: ValueError if it acts on one already, or for what the simulation has not."""
        if self._bus is not None:
            raise ValueError(f"{type(self).__name__} is added already: a fault acts on one simulation, once")
        self._prepare(simulation, bus)
        self._bus = bus
        self._topic = bus.topic(TOPIC, String)

    def save(self) -> Any:
        """All that `restore` needs."""
        return {name: copy.copy(value) if isinstance(value, random.Random) else value for name, value in vars(self).items()}

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        vars(self).clear()
        vars(self).update(
            {name: copy.copy(value) if isinstance(value, random.Random) else value for name, value in state.items()}
        )

    def forget(self) -> None:
        """Be as if never added: what it planned is gone from the bus."""
        self._bus = None

    @property
    def acts(self) -> bool:
        """Whether it acts now."""
        if self._bus is None or self._bus.time_ns < _nanoseconds(self.start):
            return False
        return math.isinf(self.end) or self._bus.time_ns < _nanoseconds(self.end)

    @abstractmethod
    def _prepare(self, simulation: Any, bus: Bus) -> None:
        """Find what there is to act on, and plan when."""

    def _note(self, text: str) -> None:
        """Tell the recording."""
        assert self._bus is not None
        self._bus.publish(self._topic, String(text))

    def _plan(self, bus: Bus, time: float, act: Callable[[], None]) -> None:
        """Have something happen at a time, at once if it has passed, never if it is infinite."""
        if time < math.inf:
            bus.schedule(max(bus.time_ns, _nanoseconds(time)), act)


def _nanoseconds(time: float) -> int:
    return round(time * NANOSECONDS)
