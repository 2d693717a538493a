"""Faults to order: small seeded objects that go wrong in a simulation, each time in the same way.

Added with `Simulation.add_fault`. What each does, and when, goes over /faults (std_msgs/String), so that a recording shows
it; messages are recorded as they went out after all faults. Faults of one topic act in the order in which they were added.
Times are simulated seconds; a fault acts from `start` until before `end`.
"""

from __future__ import annotations

import copy
import math
import random
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from operator import index
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from .bus import Bus, absolute
from .clock import NANOSECONDS
from .handles import Handle
from .messages import LaserScan, Message, String
from .robot_node import noise_of

if TYPE_CHECKING:
    from .robots import SimulatedRobot
    from .simulation import Simulation

TOPIC = "/faults"

F = TypeVar("F", bound="Fault")

Copies = list[tuple[int, Message]] | None


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

    def add_to(self, simulation: Simulation, bus: Bus) -> None:
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
    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        """Find what there is to act on, and plan when."""

    def _note(self, text: str) -> None:
        """Tell the recording."""
        assert self._bus is not None
        self._bus.publish(self._topic, String(text))

    def _plan(self, bus: Bus, time: float, act: Callable[[], None]) -> None:
        """Have something happen at a time, at once if it has passed, never if it is infinite."""
        if time < math.inf:
            bus.schedule(max(bus.time_ns, _nanoseconds(time)), act)


class MessageFault(Fault):
    """Something that goes wrong with the messages of a topic, each with a probability."""

    needs: type[Message] = Message
    """What the topic must carry."""

    def __init__(
        self, topic: str, *, probability: float = 1.0, start: float = 0.0, end: float = math.inf, seed: int = 0
    ) -> None:
        super().__init__(start=start, end=end, seed=seed)
        if not 0.0 <= probability <= 1.0:
            raise ValueError(f"the probability must be in 0..1, got {probability}")
        self.topic, self.probability = absolute(topic), probability

    @abstractmethod
    def change(self, message: Message) -> Copies:
        """What goes out instead of a message, and how much later [ns]; None for the message as it is."""

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        simulation.latest(self.topic)
        carried = next(topic.msg_type for topic in bus.topics() if topic.name == self.topic)
        if not issubclass(carried, self.needs):
            raise TypeError(
                f"{type(self).__name__} needs a topic of {self.needs.__name__}, {self.topic} carries {carried.__name__}"
            )
        bus.filters.append(self._filter)

    def _filter(self, topic: str, message: Message) -> Copies:
        if topic != self.topic or not self.acts:
            return None
        if self.probability < 1.0 and self._random.random() >= self.probability:
            return self.pass_by(message)
        return self.change(message)

    def pass_by(self, message: Message) -> Copies:
        """What goes out instead of a message that chance spares."""
        return None


class Drop(MessageFault):
    """Messages that are lost."""

    def change(self, message: Message) -> Copies:
        """Nothing goes out."""
        self._note(f"drop {self.topic}")
        return []


class Delay(MessageFault):
    """Messages that come late by `seconds`, and by up to `jitter` more, drawn evenly; they may overtake one another."""

    def __init__(self, topic: str, seconds: float, *, jitter: float = 0.0, **options: Any) -> None:
        super().__init__(topic, **options)
        check_at_least_0(seconds=seconds, jitter=jitter)
        self.seconds, self.jitter = seconds, jitter

    def change(self, message: Message) -> Copies:
        """The message goes out later."""
        delay_ns = round((self.seconds + self.jitter * self._random.random()) * NANOSECONDS)
        self._note(f"delay {self.topic} by {delay_ns / NANOSECONDS:g} s")
        return [(delay_ns, message)]


class Duplicate(MessageFault):
    """Messages that come twice, the second time `after` seconds later."""

    def __init__(self, topic: str, *, after: float = 0.0, **options: Any) -> None:
        super().__init__(topic, **options)
        check_at_least_0(after=after)
        self.after = after

    def change(self, message: Message) -> Copies:
        """The message goes out twice."""
        self._note(f"duplicate {self.topic}")
        return [(0, message), (round(self.after * NANOSECONDS), message)]


class Reorder(MessageFault):
    """Messages that come after the next one. One that no other follows is lost."""

    def __init__(self, topic: str, **options: Any) -> None:
        super().__init__(topic, **options)
        self._held: Message | None = None

    def change(self, message: Message) -> Copies:
        """The message waits for the next."""
        if self._held is not None:
            return self.pass_by(message)
        self._note(f"reorder {self.topic}")
        self._held = message
        return []

    def pass_by(self, message: Message) -> Copies:
        """The message goes out, and the one that waited after it."""
        held, self._held = self._held, None
        return None if held is None else [(0, message), (0, held)]


class Blackout(Drop):
    """A sensor that says nothing for a while."""

    def __init__(self, topic: str = "/scan", *, start: float = 0.0, end: float = math.inf) -> None:
        super().__init__(topic, start=start, end=end)

    def change(self, message: Message) -> Copies:
        """Nothing goes out."""
        self._note(f"blackout of {self.topic}")
        return []


class StuckRanges(MessageFault):
    """A scanner whose ranges stay what they were when it began, under stamps that go on."""

    needs = LaserScan

    def __init__(self, topic: str = "/scan", **options: Any) -> None:
        super().__init__(topic, **options)
        self._first: LaserScan | None = None

    def change(self, message: Message) -> Copies:
        """The scan goes out with the ranges of the first."""
        assert isinstance(message, LaserScan)
        self._first = self._first or message
        self._note(f"ranges of {self.topic} stuck")
        return [(0, replace(message, ranges=self._first.ranges))]


class BlockedSector(MessageFault):
    """Something on the scanner: beams from one angle to another [rad, in the scanner's frame] see it at `distance` [m].

    Nearer than the scanner's least range they read -inf, as REP-117 has it.
    """

    needs = LaserScan

    def __init__(
        self, first_angle: float, last_angle: float, *, distance: float = 0.0, topic: str = "/scan", **options: Any
    ) -> None:
        super().__init__(topic, **options)
        if not first_angle < last_angle:
            raise ValueError(f"the last angle must be greater than the first, got {first_angle} and {last_angle}")
        check_at_least_0(distance=distance)
        self.first_angle, self.last_angle, self.distance = first_angle, last_angle, distance

    def change(self, message: Message) -> Copies:
        """The scan goes out with other ranges in the sector."""
        assert isinstance(message, LaserScan)
        angles = message.angle_min + np.arange(len(message.ranges)) * message.angle_increment
        blocked = (self.first_angle <= angles) & (angles <= self.last_angle)
        reading = self.distance if self.distance >= message.range_min else -math.inf
        self._note(f"{int(blocked.sum())} beams of {self.topic} blocked")
        ranges = np.where(blocked, np.minimum(message.ranges, np.float32(reading)), message.ranges).astype(np.float32)
        return [(0, replace(message, ranges=ranges))]


class Slip(Fault):
    """Wheels that slip: a robot moves by this share less than they turn, of which its odometry knows nothing.

    What several let pass at one time is multiplied.
    """

    def __init__(self, share: float, *, robot: str | None = None, **options: Any) -> None:
        super().__init__(**options)
        if not 0.0 <= share <= 1.0:
            raise ValueError(f"the share must be in 0..1, got {share}")
        self.share, self.robot = share, robot

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        robot = simulation.named(self.robot)
        for time in (self.start, self.end):
            self._plan(bus, time, partial(self._slip, simulation, robot))

    def _slip(self, simulation: Simulation, robot: SimulatedRobot) -> None:
        shares = [fault.share for fault in _acting(simulation, Slip) if simulation.named(fault.robot) is robot]
        share = shares[0] if len(shares) == 1 else 1.0 - math.prod(1.0 - share for share in shares)
        robot.robot.slip(share)
        self._note(f"{robot.name or 'the robot'} slips by {share:g}")


class OdometryDrift(Fault):
    """Odometry that errs by the velocity motion model of Probabilistic Robotics, table 5.3, and says how far.

    alphas: alpha1 to alpha6. Instead of the parameter odometry_alphas; from the end on odometry is exact again, as seen from
    where the robot is by then. raises: ValueError when added, if another is to act on the robot at the same time.
    """

    def __init__(self, alphas: Sequence[float], *, robot: str | None = None, seed: int = 0, **options: Any) -> None:
        super().__init__(seed=seed, **options)
        if len(alphas) != 6:
            raise ValueError(f"alphas must be six numbers, got {len(alphas)}")
        self.noise, self.robot, self._seed = noise_of(alphas), robot, seed

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        robot = simulation.named(self.robot)
        for other in simulation.faults:
            same = isinstance(other, OdometryDrift) and simulation.named(other.robot) is robot
            if same and other.start < self.end and self.start < other.end:
                raise ValueError(
                    f"odometry can drift in one way at a time, and does from {other.start:g} s to {other.end:g} s already"
                )
        self._plan(bus, self.start, partial(self._drift, robot, drifts=True))
        self._plan(bus, self.end, partial(self._drift, robot, drifts=False))

    def _drift(self, robot: SimulatedRobot, *, drifts: bool) -> None:
        robot.robot.drift(self.noise if drifts else None, self._seed)
        self._note(f"odometry of {robot.name or 'the robot'} {'drifts' if drifts else 'is exact'}")


class ClockJump(Fault):
    """Clocks that jump by some seconds, either way: /clock, all stamps, and `get_clock()`. Robots move on evenly."""

    def __init__(self, seconds: float, *, at: float = 0.0) -> None:
        super().__init__(start=at)
        if not math.isfinite(seconds) or seconds == 0.0:
            raise ValueError(f"a jump must be finite and not 0 s, got {seconds}")
        self.seconds = seconds

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        self._plan(bus, self.start, partial(self._jump, bus))

    def _jump(self, bus: Bus) -> None:
        bus.clock_offset_ns += round(self.seconds * NANOSECONDS)
        self._note(f"the clock jumps by {self.seconds:g} s")


class Startable(Protocol):
    """A node that can be stopped and started."""

    def start(self) -> None:
        """Go on."""

    def stop(self) -> None:
        """Do nothing more."""


class Outage(Fault):
    """A node that stops and comes back: "robot", which stands still meanwhile, "laser" or "map_server".

    Of several that overlap, the last to end brings it back.
    """

    def __init__(self, node: str, *, robot: str | None = None, start: float = 0.0, end: float = math.inf) -> None:
        super().__init__(start=start, end=end)
        if node not in ("robot", "laser", "map_server"):
            raise ValueError(f"the node must be robot, laser or map_server, got {node!r}")
        self.node, self.robot = node, robot

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        robot = simulation.named(self.robot)
        nodes: dict[str, Startable] = {"robot": robot.robot, "laser": robot.laser, "map_server": simulation.map_server}
        self._node = nodes[self.node]
        self._plan(bus, self.start, self._stop)
        self._plan(bus, self.end, partial(self._come_back, simulation))

    def _stop(self) -> None:
        self._node.stop()
        self._note(f"{self.node} stops")

    def _come_back(self, simulation: Simulation) -> None:
        if any(fault._node is self._node for fault in _acting(simulation, Outage)):
            return
        self._node.start()
        self._note(f"{self.node} is back")


def _nanoseconds(time: float) -> int:
    return round(time * NANOSECONDS)


def _acting(simulation: Simulation, kind: type[F]) -> list[F]:
    """The faults of a kind that act now."""
    return [fault for fault in simulation.faults if isinstance(fault, kind) and fault.acts]
