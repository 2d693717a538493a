"""Faults of messages: dropped, delayed, duplicated, reordered or changed."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import replace
from typing import Any

import numpy as np

from ..bus.topic import absolute
from ..instant import NANOSECONDS
from ..messages import LaserScan, Message
from ..quoting import quoted, quoted_angle
from ..simulation.arguments import check_at_least_0, check_numbers
from ..simulation.fault import TOPIC, Fault, FaultBus, FaultTarget
from ..simulation.topics import find_topic

Copies = list[tuple[int, Message]] | None
"""Messages to send instead of one message, each with its delay [ns]; None to send it unchanged."""


class MessageFault(Fault):
    """A fault that affects each message of a topic with a probability.

    Args:
        topic: Name of the topic. On ROS, a name without a leading slash is in the namespace of the process.
        probability: Probability that a message is affected, in 0..1.
        start: Time at which the fault begins [s].
        end: Time at which the fault ends [s].
        seed: Seed of the random numbers.

    Attributes:
        topic: Full name of the topic.
        probability: Probability that a message is affected.

    Raises:
        ValueError: The probability is not in 0..1, or the times are not valid for a `Fault`.
        TypeError: The probability is not a number.
    """

    needs: type[Message] = Message
    """Message class that the topic must have."""

    def __init__(
        self, topic: str, *, probability: float = 1.0, start: float = 0.0, end: float = math.inf, seed: int = 0
    ) -> None:
        super().__init__(start=start, end=end, seed=seed)
        check_numbers(probability=probability)
        if not 0.0 <= probability <= 1.0:
            raise ValueError(f"the probability must be in 0..1, got {quoted(probability)}")
        self.topic, self.probability, self._given_topic = absolute(topic), probability, topic

    @abstractmethod
    def change(self, message: Message) -> Copies:
        """Returns the messages to send instead of an affected message."""

    def pass_by(self, message: Message) -> Copies:
        """Returns the messages to send instead of an unaffected message, or None to send it unchanged."""
        return None

    def _prepare(self, simulation: FaultTarget, bus: FaultBus) -> None:
        found = find_topic(bus, self._given_topic)
        carried = found.msg_type
        if not issubclass(carried, self.needs):
            raise TypeError(
                f"{type(self).__name__} needs a topic of {self.needs.__name__}, {found.name} carries {carried.__name__}"
            )
        reports = bus.find_topic(TOPIC)
        if reports is not None and found.name == reports.name:
            raise ValueError(f"a fault cannot act on {found.name}, where faults report what they do")
        self.topic = found.name
        bus.filters.append(self._filter)

    def _filter(self, topic: str, message: Message) -> Copies:
        if topic != self.topic or not self.acts:
            return None
        if self.probability < 1.0 and self._random.random() >= self.probability:
            return self.pass_by(message)
        return self.change(message)

    def _arguments(self) -> list[str]:
        return [repr(self.topic)] + ([f"probability={self.probability:g}"] if self.probability < 1.0 else [])


class Drop(MessageFault):
    """Messages of a topic are lost."""

    def change(self, message: Message) -> Copies:
        """Sends nothing."""
        self._note(f"drop {self.topic}")
        return []


class Delay(MessageFault):
    """Messages of a topic arrive late, possibly in another order.

    Args:
        topic: Name of the topic.
        seconds: Shortest delay [s].
        jitter: Largest additional delay [s]. The additional delay is random, uniform in 0..jitter.
        **options: As for `MessageFault`.

    Raises:
        ValueError: `seconds` or `jitter` is negative or not finite.
    """

    def __init__(self, topic: str, seconds: float, *, jitter: float = 0.0, **options: Any) -> None:
        super().__init__(topic, **options)
        check_at_least_0(seconds=seconds, jitter=jitter)
        self.seconds, self.jitter = seconds, jitter

    def change(self, message: Message) -> Copies:
        """Sends the message later."""
        delay_ns = round((self.seconds + self.jitter * self._random.random()) * NANOSECONDS)
        self._note(f"delay {self.topic} by {delay_ns / NANOSECONDS:g} s")
        return [(delay_ns, message)]

    def _arguments(self) -> list[str]:
        topic, *others = super()._arguments()
        return [topic, f"{self.seconds:g} s", *([f"jitter={self.jitter:g} s"] if self.jitter else []), *others]


class Duplicate(MessageFault):
    """Messages of a topic arrive twice.

    Args:
        topic: Name of the topic.
        after: Delay of the second copy [s].
        **options: As for `MessageFault`.

    Raises:
        ValueError: `after` is negative or not finite.
    """

    def __init__(self, topic: str, *, after: float = 0.0, **options: Any) -> None:
        super().__init__(topic, **options)
        check_at_least_0(after=after)
        self.after = after

    def change(self, message: Message) -> Copies:
        """Sends the message twice."""
        self._note(f"duplicate {self.topic}")
        return [(0, message), (round(self.after * NANOSECONDS), message)]

    def _arguments(self) -> list[str]:
        return super()._arguments() + ([f"after={self.after:g} s"] if self.after else [])


class Reorder(MessageFault):
    """Messages of a topic arrive after the message that follows them. A message that none follows is lost.

    Args:
        topic: Name of the topic.
        **options: As for `MessageFault`.
    """

    def __init__(self, topic: str, **options: Any) -> None:
        super().__init__(topic, **options)
        self._held: Message | None = None

    def change(self, message: Message) -> Copies:
        """Holds the message back until the next one. If one is already held back, sends both."""
        if self._held is not None:
            return self.pass_by(message)
        self._note(f"reorder {self.topic}")
        self._held = message
        return []

    def pass_by(self, message: Message) -> Copies:
        """Sends the message, then the one that was held back."""
        held, self._held = self._held, None
        return None if held is None else [(0, message), (0, held)]


class Blackout(Drop):
    """A topic receives no messages from `start` to `end`, as if its sensor were switched off.

    Args:
        topic: Name of the sensor's topic.
        start: Time at which the fault begins [s].
        end: Time at which the fault ends [s].
    """

    def __init__(self, topic: str = "scan", *, start: float = 0.0, end: float = math.inf) -> None:
        super().__init__(topic, start=start, end=end)

    def change(self, message: Message) -> Copies:
        """Sends nothing."""
        self._note(f"blackout of {self.topic}")
        return []


class StuckRanges(MessageFault):
    """A scanner repeats the ranges of the first affected scan, with current stamps.

    Args:
        topic: Name of the scanner's topic.
        **options: As for `MessageFault`.
    """

    needs = LaserScan

    def __init__(self, topic: str = "scan", **options: Any) -> None:
        super().__init__(topic, **options)
        self._first: LaserScan | None = None

    def change(self, message: Message) -> Copies:
        """Sends the scan with the ranges of the first affected scan."""
        assert isinstance(message, LaserScan)
        self._first = self._first or message
        self._note(f"ranges of {self.topic} stuck")
        return [(0, replace(message, ranges=self._first.ranges))]


class BlockedSector(MessageFault):
    """An object on the scanner blocks the beams in a sector.

    A blocked beam returns the distance to the object, or its own range if that is shorter. If the object is nearer than the
    scanner's minimum range, the beam returns -inf, as REP 117 specifies.

    Args:
        first_angle: Start of the sector in the scanner's frame [rad].
        last_angle: End of the sector in the scanner's frame [rad], greater than `first_angle`.
        distance: Distance from the scanner to the object [m].
        topic: Name of the scanner's topic.
        **options: As for `MessageFault`.

    Raises:
        ValueError: `last_angle` is not greater than `first_angle`, one of them is beyond one turn, or `distance` is negative
            or not finite.
    """

    needs = LaserScan

    def __init__(
        self, first_angle: float, last_angle: float, *, distance: float = 0.0, topic: str = "scan", **options: Any
    ) -> None:
        super().__init__(topic, **options)
        check_numbers(first_angle=first_angle, last_angle=last_angle)
        for name, angle in (("first_angle", first_angle), ("last_angle", last_angle)):
            if not abs(angle) <= math.tau:
                raise ValueError(f"{name} must be in [-2π, 2π] radians, got {quoted_angle(angle)}")
        if not first_angle < last_angle:
            raise ValueError(f"the last angle must be greater than the first, got {first_angle} and {last_angle}")
        check_at_least_0(distance=distance)
        self.first_angle, self.last_angle, self.distance = first_angle, last_angle, distance

    def change(self, message: Message) -> Copies:
        """Sends the scan with the changed ranges of the blocked beams."""
        assert isinstance(message, LaserScan)
        angles = message.angle_min + np.arange(len(message.ranges)) * message.angle_increment
        blocked = (self.first_angle <= angles) & (angles <= self.last_angle)
        reading = self.distance if self.distance >= message.range_min else -math.inf
        self._note(f"{int(blocked.sum())} beams of {self.topic} blocked")
        ranges = np.where(blocked, np.minimum(message.ranges, np.float32(reading)), message.ranges).astype(np.float32)
        return [(0, replace(message, ranges=ranges))]

    def _arguments(self) -> list[str]:
        sector = [f"{self.first_angle:g} rad", f"{self.last_angle:g} rad", f"distance={self.distance:g} m"]
        return sector + super()._arguments()
