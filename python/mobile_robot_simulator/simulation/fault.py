"""Fault: a seeded disturbance of a simulation, active for a limited time."""

from __future__ import annotations

import copy
import math
import random
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import index
from typing import Protocol, SupportsIndex, TypeVar

from ..handle import Handle
from ..instant import NANOSECONDS
from ..messages import Message, String
from ..nodes.interface import M, Publisher
from ..nodes.laser import LaserScannerSimulator
from ..nodes.message_filters import Filter
from ..nodes.robot import MobileRobotSimulator
from ..quoting import quoted
from .arguments import check_numbers
from .topics import HasTopics

F = TypeVar("F", bound="Fault")

TOPIC = "faults"
"""Topic on which faults report their actions (std_msgs/String)."""


class Startable(Protocol):
    """A node that can be stopped and started again."""

    def start(self) -> None:
        """Starts or resumes the node."""

    def stop(self) -> None:
        """Stops the node."""


class FaultTopic(Protocol):
    """A topic on which a fault can act."""

    @property
    def name(self) -> str:
        """Full name."""

    @property
    def msg_type(self) -> type[Message]:
        """Class of the messages."""


class FaultBus(HasTopics[FaultTopic], Protocol):
    """The time and the topics that faults use: those of the bus, or of a process on ROS."""

    @property
    def time_ns(self) -> int:
        """Simulated time [ns]."""

    @property
    def filters(self) -> list[Filter]:
        """Functions that can replace, delay or drop a message, in the order in which they apply."""

    def schedule(self, time_ns: int, action: Callable[[], None]) -> None:
        """Runs an action at a simulated time [ns]."""

    def publisher(self, name: str, msg_type: type[M]) -> Publisher[M]:
        """Returns a publisher on a topic."""


class FaultRobot(Protocol):
    """The parts of a robot that faults use."""

    @property
    def robot(self) -> MobileRobotSimulator:
        """The node that moves it."""

    @property
    def scanners(self) -> Mapping[str, LaserScannerSimulator]:
        """The nodes of its laser scanners."""


class FaultTarget(Protocol):
    """The parts of a simulation, or of a process on ROS, that faults use."""

    @property
    def faults(self) -> Sequence[Fault]:
        """All faults of the simulation, in the order in which they were added."""

    @property
    def map_server(self) -> Startable:
        """The node that serves the map."""

    def named(self, name: str | None) -> FaultRobot:
        """Returns the robot with this name, or the first robot if the name is None."""


@dataclass(frozen=True)
class FaultSnapshot:
    """A saved fault.

    Attributes:
        fault: The fault itself.
        attributes: Its attributes by name. Random generators are copied, other values are shared.
    """

    fault: Fault
    attributes: dict[str, object]


class Fault(Handle, ABC):
    """A disturbance that acts on one simulation from `start` until just before `end`.

    Args:
        start: Time at which the fault begins [s].
        end: Time at which the fault ends [s]; infinity if it never ends.
        seed: Seed of the fault's random numbers. The same seed always gives the same disturbance.

    Attributes:
        start: Time at which the fault begins [s].
        end: Time at which the fault ends [s].
        seed: Seed of the fault's random numbers.
        is_stopped: True after `stop`.

    Raises:
        ValueError: `start` is negative or not finite, or `end` is not after `start`.
        TypeError: A time is not a number, or the seed is not an integer.
    """

    def __init__(self, *, start: float = 0.0, end: float = math.inf, seed: int = 0) -> None:
        check_numbers(start=start, end=end)
        if not isinstance(seed, SupportsIndex):
            raise TypeError(f"seed must be an integer, got {quoted(seed)}")
        if not (0.0 <= start < math.inf and start < end):
            raise ValueError(f"a fault must start at 0 s or later and end after that, got start {start} and end {end}")
        self.start, self.end, self.seed = start, end, index(seed)
        # According to its documentation, random.Random gives the same numbers on every platform.
        self._random = random.Random(self.seed)
        self._bus: FaultBus | None = None
        self.is_stopped = False

    def __repr__(self) -> str:
        shown = self._arguments()
        if self.start > 0.0:
            shown.append(f"start={self.start:g} s")
        if math.isfinite(self.end):
            shown.append(f"end={self.end:g} s")
        if self.seed:
            shown.append(f"seed={self.seed}")
        return f"{type(self).__name__}({', '.join(shown)})"

    def add_to(self, simulation: FaultTarget, bus: FaultBus) -> None:
        """Connects the fault to a simulation, on which it then acts. `Simulation.add_fault` calls this.

        Args:
            simulation: The simulation to act on, or the process on ROS.
            bus: Its time and its topics.

        Raises:
            ValueError: The fault was added before, or names a topic or robot that does not exist.
            TypeError: The topic carries messages of a type that the fault cannot change.
        """
        if self._bus is not None:
            raise ValueError(f"{type(self).__name__} was added before: a fault acts on one simulation, and only once")
        self._prepare(simulation, bus)
        self._bus = bus
        self._publisher = bus.publisher(TOPIC, String)

    def stop(self) -> None:
        """Ends the fault now, before its `end`. Has no effect if it has ended.

        Raises:
            ValueError: The fault is not part of a simulation.
        """
        if self._bus is None:
            raise ValueError(f"{self!r} acts on no simulation, so it cannot be stopped")
        if not self.is_stopped and self._bus.time_ns < _end_nanoseconds(self.end):
            acted, self.is_stopped = self.acts, True
            if acted:
                self._finish()

    def save(self) -> FaultSnapshot:
        """Returns the state that `restore` takes."""
        return FaultSnapshot(self, _with_own_generators(vars(self)))

    def restore(self, state: FaultSnapshot) -> None:
        """Puts the fault back into a saved state. The state can be restored again."""
        vars(self).clear()
        vars(self).update(_with_own_generators(state.attributes))

    def forget(self) -> None:
        """Detaches the fault from its simulation, so that it can be added again."""
        self._bus = None

    @property
    def acts(self) -> bool:
        """True if the fault was added, the current time is at least `start` and less than `end`, and it was not stopped."""
        if self._bus is None or self.is_stopped or self._bus.time_ns < _nanoseconds(self.start):
            return False
        return self._bus.time_ns < _end_nanoseconds(self.end)

    @abstractmethod
    def _prepare(self, simulation: FaultTarget, bus: FaultBus) -> None:
        """Finds the topic or robot that the fault acts on, and schedules the fault's actions."""

    def _finish(self) -> None:
        """Undoes what the fault does, when it ends or is stopped. A fault of messages has nothing to undo."""

    def _arguments(self) -> list[str]:
        """Returns the arguments of the subclass as `repr` shows them. The times and the seed follow them."""
        return []

    def _note(self, text: str) -> None:
        """Publishes a text on `/faults`, so that recordings show the fault's actions."""
        self._publisher.publish(String(text))

    def _plan(self, bus: FaultBus, time: float, act: Callable[[], None]) -> None:
        """Schedules an action at a time [s], unless the fault is stopped before.

        If the time has passed, it runs now; if the time is infinite, never.
        """

        def act_unless_stopped() -> None:
            if not self.is_stopped:
                act()

        if time < math.inf:
            bus.schedule(max(bus.time_ns, _nanoseconds(time)), act_unless_stopped)


class FaultList:
    """The faults of one simulation, in the order in which they were added."""

    def __init__(self) -> None:
        self._faults: list[Fault] = []

    @property
    def all(self) -> tuple[Fault, ...]:
        """All faults."""
        return tuple(self._faults)

    def add(self, fault: F, simulation: FaultTarget, bus: FaultBus) -> F:
        """Adds a fault to the simulation. Returns the fault.

        Raises:
            TypeError: It is not a fault, or the topic carries messages of a type that the fault cannot change.
            ValueError: The fault was added before, or names a topic or robot that does not exist.
        """
        if not isinstance(fault, Fault):
            raise TypeError(f"a fault must be an object of a class in faults, got {type(fault).__name__}")
        fault.add_to(simulation, bus)
        self._faults.append(fault)
        return fault

    def save(self) -> tuple[FaultSnapshot, ...]:
        """Returns the state that `restore` takes."""
        return tuple(fault.save() for fault in self._faults)

    def restore(self, states: tuple[FaultSnapshot, ...]) -> None:
        """Puts all faults back into a saved state. Faults added later are detached and can be added again."""
        for fault in self._faults:
            fault.forget()
        self._faults = [state.fault for state in states]
        for state in states:
            state.fault.restore(state)


def _with_own_generators(attributes: dict[str, object]) -> dict[str, object]:
    """Returns the attributes with random generators copied, so that drawing from a copy does not change the original."""
    return {name: copy.copy(value) if isinstance(value, random.Random) else value for name, value in attributes.items()}


def _nanoseconds(time: float) -> int:
    return round(time * NANOSECONDS)


def _end_nanoseconds(time: float) -> float:
    return math.inf if math.isinf(time) else _nanoseconds(time)
