"""Faults of messages: lost, late, repeated, out of order, changed."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bus.bus import Bus
from ..bus.topic import absolute
from ..instant import NANOSECONDS
from ..messages import LaserScan, Message
from ..simulation.fault import Fault, check_at_least_0
from ..simulation.simulation import Simulation

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation


Copies = list[tuple[int, Message]] | None


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
