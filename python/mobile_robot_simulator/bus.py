"""Topics, timers and services in one process, on a virtual clock: ordered, repeatable, and without sleeping.

Everything that happens is an event at a time. Events of one moment come in a fixed order: messages and service calls in the
order in which they were sent, then timers in the order in which they were created. A message goes to those who are
subscribed when it is sent, after the callback that sent it has returned. Messages are handed on as they are, not copied:
whoever gets one leaves it unchanged.
"""

from __future__ import annotations

import heapq
import logging
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Generic

from .messages import Message, Time
from .node_interface import M, QoS

Tap = Callable[[str, Message, int], None]

NANOSECONDS = 1_000_000_000

LONGEST_CHAIN, MOST_ANSWERS = 10_000, 100_000
"""More messages at one moment, each sent upon the one before, or upon any other, are taken for an endless loop."""


class Bus:
    """The world that nodes live in: a clock, and what happens when."""

    def __init__(self) -> None:
        self.time_ns = 0
        self.taps: list[Tap] = []
        self._events: list[tuple[int, int, int, Callable[[], None], int]] = []
        self._chain, self._answers = 0, 0
        self._sent = 0
        self._timers = 0
        self._running = False
        self._topics: dict[str, Topic] = {}
        self._services: dict[str, Service] = {}

    def create_node(self, name: str) -> BusNode:
        """A node of this name."""
        return BusNode(self, name)

    def run_until(self, time_ns: int) -> None:
        """Let everything happen up to and at a time; the clock then shows that time.

        raises: ValueError for a time that has passed; RuntimeError if called from a callback, or if so much happens at one
        moment that time would never go on. What a callback raises comes out here, and the run can go on afterwards.
        """
        if time_ns < self.time_ns:
            raise ValueError(f"the time to run to must not have passed, got {time_ns} ns at {self.time_ns} ns")
        if self._running:
            raise RuntimeError("the bus is running already: a callback must not run it")
        self._running = True
        try:
            while self._events and self._events[0][0] <= time_ns:
                before = self.time_ns
                self.time_ns, _, _, happen, self._chain = heapq.heappop(self._events)
                self._answers = self._answers + (self._chain > 1) if self.time_ns == before else 0
                if self._chain > LONGEST_CHAIN or self._answers > MOST_ANSWERS:
                    raise RuntimeError(
                        f"time stands still at {self.time_ns / NANOSECONDS} s: "
                        "callbacks answer each other's messages without end"
                    )
                happen()
            self.time_ns = time_ns
        finally:
            self._running, self._chain = False, 0

    def topic_names(self) -> list[str]:
        """Names of all topics, sorted."""
        return sorted(self._topics)

    def latest(self, topic: str) -> Message | None:
        """The message last published to a topic, None if there was none."""
        found = self._topics.get(absolute(topic))
        return found.latest if found else None

    def latched(self) -> list[tuple[str, Message, int]]:
        """What is kept for those who come later: topic, message and when it was sent."""
        topics = (self._topics[name] for name in self.topic_names())
        return [(topic.name, topic.latest, topic.latest_ns) for topic in topics if topic.latched and topic.latest]

    def schedule(self, time_ns: int, happen: Callable[[], None]) -> None:
        """Have something happen at a time, in the order of sending."""
        self._sent += 1
        chain = self._chain + 1 if time_ns == self.time_ns else 0
        heapq.heappush(self._events, (time_ns, 0, self._sent, happen, chain))

    def schedule_timer(self, time_ns: int, order: int, happen: Callable[[], None]) -> None:
        """Have a timer fire at a time, after all messages, in the order of the timers."""
        heapq.heappush(self._events, (time_ns, 1, order, happen, 0))

    def next_timer_order(self) -> int:
        """The place of a new timer among the others."""
        self._timers += 1
        return self._timers

    def topic(self, name: str, msg_type: type[Message]) -> Topic:
        """The topic of a name, which carries messages of one type."""
        if not (isinstance(msg_type, type) and issubclass(msg_type, Message)):
            raise TypeError(f"a topic's type must be a message class, got {msg_type!r} for {name}")
        topic = self._topics.setdefault(absolute(name), Topic(absolute(name), msg_type))
        if topic.msg_type is not msg_type:
            raise TypeError(f"{topic.name} carries {topic.msg_type.__name__}, got {msg_type.__name__}")
        return topic

    def service(self, name: str, srv_type: Any) -> Service:
        """The service of a name, which is of one type."""
        service = self._services.setdefault(absolute(name), Service(absolute(name), srv_type))
        if service.srv_type is not srv_type:
            raise TypeError(f"{service.name} is a {service.srv_type.__name__}, got {srv_type.__name__}")
        return service

    def publish(self, topic: Topic, message: Message) -> None:
        """Send a message to all who are subscribed now."""
        if not isinstance(message, topic.msg_type):
            raise TypeError(f"{topic.name} carries {topic.msg_type.__name__}, got {type(message).__name__}")
        topic.latest, topic.latest_ns = message, self.time_ns
        for tap in self.taps:
            tap(topic.name, message, self.time_ns)
        for subscription in topic.subscriptions:
            self.schedule(self.time_ns, partial(subscription.hand, message))


def absolute(name: str) -> str:
    """The name from the root on."""
    if not name.strip("/"):
        raise ValueError(f"a topic or service must have a name, got {name!r}")
    return name if name.startswith("/") else f"/{name}"


def _check_callback(callback: object) -> None:
    if not callable(callback):
        raise TypeError(f"a callback must be callable, got {callback!r}")


@dataclass(eq=False)
class Subscription(Generic[M]):
    """A callback that gets the messages of a topic."""

    topic: Topic
    callback: Callable[[M], None]
    active: bool = True

    def hand(self, message: Any) -> None:
        """Call back with a message, unless the subscription was destroyed."""
        if self.active:
            self.callback(message)


@dataclass(eq=False)
class Topic:
    """A name that messages of one type are sent to."""

    name: str
    msg_type: type[Message]
    subscriptions: list[Subscription[Any]] = field(default_factory=list)
    latest: Message | None = None
    latest_ns: int = 0
    latched: bool = False


@dataclass(eq=False)
class Publisher(Generic[M]):
    """Sends messages to a topic."""

    bus: Bus
    topic: Topic

    def publish(self, message: M) -> None:
        """Send one message."""
        self.bus.publish(self.topic, message)


class Timer:
    """Fires at multiples of its period after its start: rounded to nanoseconds, without drift."""

    def __init__(self, bus: Bus, period: float, callback: Callable[[], None]) -> None:
        if not 1 <= period * NANOSECONDS < math.inf:
            raise ValueError(f"a timer's period must be at least a nanosecond, and finite, got {period} s")
        _check_callback(callback)
        self._bus, self._period, self._callback = bus, period, callback
        self._start_ns, self._order, self._fired = bus.time_ns, bus.next_timer_order(), 0
        self._cancelled = False
        self._wait()

    def cancel(self) -> None:
        """Never fire again."""
        self._cancelled = True

    def is_canceled(self) -> bool:
        """Whether the timer was cancelled."""
        return self._cancelled

    def _wait(self) -> None:
        offset = round((self._fired + 1) * self._period * NANOSECONDS)
        self._bus.schedule_timer(self._start_ns + offset, self._order, self._fire)

    def _fire(self) -> None:
        if self._cancelled:
            return
        self._fired += 1
        self._wait()
        self._callback()


class Future:
    """A service's answer, once it is there."""

    def __init__(self) -> None:
        self._done = False
        self._result: Any = None
        self._callbacks: list[Callable[[Future], None]] = []

    def done(self) -> bool:
        """Whether the answer is there."""
        return self._done

    def result(self) -> Any:
        """The answer, None before it is there."""
        return self._result

    def set_result(self, result: Any) -> None:
        """Give the answer, and call all callbacks."""
        self._done, self._result = True, result
        callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback(self)

    def add_done_callback(self, callback: Callable[[Future], None]) -> None:
        """Call back with the future once the answer is there, at once if it is."""
        if self._done:
            callback(self)
        else:
            self._callbacks.append(callback)


@dataclass(eq=False)
class Service:
    """A name that requests are sent to, and who answers them."""

    name: str
    srv_type: Any
    handler: Callable[[Any, Any], Any] | None = None


@dataclass(eq=False)
class Client:
    """Calls a service."""

    bus: Bus
    service: Service

    def service_is_ready(self) -> bool:
        """Whether anyone answers."""
        return self.service.handler is not None

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Whether anyone answers; time on the bus does not pass while somebody waits."""
        return self.service_is_ready()

    def call_async(self, request: Any) -> Future:
        """Ask; the answer comes at the same moment, after the caller has returned. If nobody answers, it never comes."""
        if not isinstance(request, self.service.srv_type.Request):
            expected = self.service.srv_type.Request.__name__
            raise TypeError(f"{self.service.name} takes a {expected}, got {type(request).__name__}")
        future = Future()

        def answer() -> None:
            if self.service.handler is not None:
                future.set_result(self.service.handler(request, self.service.srv_type.Response()))

        self.bus.schedule(self.bus.time_ns, answer)
        return future


@dataclass(frozen=True)
class Instant:
    """A moment of the bus's clock."""

    nanoseconds: int

    def to_msg(self) -> Time:
        """The moment as a message."""
        return Time.from_nanoseconds(self.nanoseconds)


@dataclass(eq=False)
class Clock:
    """The bus's clock."""

    bus: Bus

    def now(self) -> Instant:
        """The moment it is."""
        return Instant(self.bus.time_ns)


class BusNode:
    """The surroundings of a node on the bus, under rclpy's names."""

    def __init__(self, bus: Bus, name: str) -> None:
        self._bus, self._name = bus, name
        self._logger = logging.getLogger(f"mobile_robot_simulator.{name}")

    def get_name(self) -> str:
        """The node's name."""
        return self._name

    def get_clock(self) -> Clock:
        """The bus's clock."""
        return Clock(self._bus)

    def set_speed(self, factor: float) -> None:
        """Nothing: time on the bus goes on as it is run."""

    def get_logger(self) -> logging.Logger:
        """A logger of the standard library."""
        return self._logger

    def create_publisher(self, msg_type: type[M], topic: str, qos_profile: QoS | int = QoS.DEFAULT) -> Publisher[M]:
        """A publisher to a topic."""
        found = self._bus.topic(topic, msg_type)
        found.latched |= qos_profile is QoS.LATCHED
        return Publisher(self._bus, found)

    def create_subscription(
        self, msg_type: type[M], topic: str, callback: Callable[[M], None], qos_profile: QoS | int = QoS.DEFAULT
    ) -> Subscription[M]:
        """Have every message of a topic handed to the callback; of a latched one also the last message there was."""
        found = self._bus.topic(topic, msg_type)
        _check_callback(callback)
        subscription = Subscription(found, callback)
        found.subscriptions.append(subscription)
        if found.latched and found.latest is not None:
            message = found.latest
            self._bus.schedule(self._bus.time_ns, partial(subscription.hand, message))
        return subscription

    def create_timer(self, timer_period_sec: float, callback: Callable[[], None]) -> Timer:
        """Have the callback called once a period, first after one period."""
        return Timer(self._bus, timer_period_sec, callback)

    def create_service(self, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any]) -> Service:
        """Answer requests with what the callback makes of the request and an empty response."""
        service = self._bus.service(srv_name, srv_type)
        _check_callback(callback)
        if service.handler is not None:
            raise ValueError(f"{service.name} is answered already")
        service.handler = callback
        return service

    def create_client(self, srv_type: Any, srv_name: str) -> Client:
        """A client of a service."""
        return Client(self._bus, self._bus.service(srv_name, srv_type))

    def destroy_publisher(self, publisher: Publisher[Any]) -> None:
        """Take a publisher away."""

    def destroy_subscription(self, subscription: Subscription[Any]) -> None:
        """Take a subscription away: messages on their way no longer reach it. The second time, nothing happens."""
        if subscription.active:
            subscription.active = False
            subscription.topic.subscriptions.remove(subscription)

    def destroy_timer(self, timer: Timer) -> None:
        """Take a timer away."""
        timer.cancel()

    def destroy_service(self, service: Service) -> None:
        """No longer answer requests."""
        service.handler = None

    def destroy_client(self, client: Client) -> None:
        """Take a client away."""
