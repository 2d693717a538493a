"""Topics, timers and services in one process, on a virtual clock: ordered, repeatable, and without sleeping.

Everything that happens is an event at a time. Events of one moment come in a fixed order: messages and service calls in the
order in which they were sent, then timers in the order in which they were created. A message goes to those who are
subscribed when it is sent, after the callback that sent it has returned. A message is copied when it is sent; all who get it
get the same one, and leave it unchanged.

A bus can be saved and put back as it was: its time, what is under way, timers, subscriptions, latest messages, nodes.
Callbacks are called again as they are; what they keep elsewhere is not the bus's (`Simulation.keep`).
"""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, Protocol

from ..handle import Handle
from ..instant import NANOSECONDS
from ..messages import Message, copied
from ..nodes.future import Future
from ..nodes.interface import M

Tap = Callable[[str, Message, int], None]

Filter = Callable[[str, Message], list[tuple[int, Message]] | None]
"""What becomes of a message sent to a topic: copies and how much later each goes out [ns]; None lets it pass as it is."""

LONGEST_CHAIN, MOST_ANSWERS = 10_000, 100_000
"""More messages at one moment, each sent upon the one before, or upon any other, are taken for an endless loop."""


class Savable(Protocol):
    """A part of the bus that `Bus.save` saves and `Bus.restore` restores."""

    def save(self) -> Any:
        """Returns the state that `restore` takes."""

    def restore(self, state: Any) -> None:
        """Puts the part back into a saved state."""


class SavableTimer(Savable, Protocol):
    """A timer of the bus."""

    def cancel(self) -> None:
        """Stops the timer."""


class Bus(Handle):
    """The world that nodes live in: a clock, and what happens when."""

    def __init__(self) -> None:
        self.time_ns = 0
        self.clock_offset_ns = 0
        self.taps: list[Tap] = []
        self.filters: list[Filter] = []
        self.nodes: list[Savable] = []
        self.timers: dict[SavableTimer, None] = {}
        self._events: list[tuple[int, int, int, Callable[[], None]]] = []
        self._at_once: deque[tuple[Callable[[], None], int]] = deque()
        self._chain, self._answers = 0, 0
        self._calls: dict[Future, None] = {}
        self._sent = 0
        self._timer_count = 0
        self._running = self._closed = False
        self._topics: dict[str, Topic] = {}
        self._services: dict[str, Service] = {}

    @property
    def clock_ns(self) -> int:
        """What clocks show: the time, and whatever they are off by."""
        return self.time_ns + self.clock_offset_ns

    def run_until(self, time_ns: int) -> None:
        """Let everything happen up to and at a time; the clock then shows that time.

        raises: ValueError for a time that has passed; RuntimeError if called from a callback, or if so much happens at one
        moment that time would never go on. What a callback raises comes out here, and the run can go on afterwards.
        """
        if time_ns < self.time_ns:
            raise ValueError(f"the time to run to must not have passed, got {time_ns} ns at {self.time_ns} ns")
        self._check_idle("run it")
        self._running = True
        try:
            events, at_once = self._events, self._at_once
            while True:
                # What was sent to this moment from an earlier one is older than what was sent at it.
                if at_once and not (events and events[0][0] <= self.time_ns and events[0][1] == 0):
                    happen, self._chain = at_once.popleft()
                    self._answers += self._chain > 1
                    if self._chain > LONGEST_CHAIN or self._answers > MOST_ANSWERS:
                        raise RuntimeError(
                            f"time stands still at {self.time_ns / NANOSECONDS} s: "
                            "callbacks answer each other's messages without end"
                        )
                elif events and events[0][0] <= time_ns:
                    before = self.time_ns
                    self.time_ns, _, _, happen = heapq.heappop(events)
                    self._chain = 0
                    if self.time_ns != before:
                        self._answers = 0
                else:
                    break
                happen()
            self.time_ns = time_ns
        finally:
            self._running, self._chain, self._answers = False, 0, 0

    def next_ns(self) -> int | None:
        """When something happens next, None if nothing does."""
        if self._at_once:
            return self.time_ns
        return self._events[0][0] if self._events else None

    def topic_names(self) -> list[str]:
        """Names of all topics, sorted."""
        return sorted(self._topics)

    def topics(self) -> list[Topic]:
        """All topics, sorted by their names."""
        return [self._topics[name] for name in self.topic_names()]

    def latest(self, topic: str) -> Message | None:
        """The message last sent to a topic, None if there was none."""
        found = self._topics.get(absolute(topic))
        return found.latest if found else None

    def latched(self) -> list[tuple[str, Message, int]]:
        """What is kept for those who come later: topic, message and when it was sent."""
        return [(topic.name, topic.latest, topic.latest_ns) for topic in self.topics() if topic.latched and topic.latest]

    def schedule(self, time_ns: int, happen: Callable[[], None]) -> None:
        """Have something happen at a time, in the order of sending."""
        if time_ns <= self.time_ns:
            self._at_once.append((happen, self._chain + 1))
        else:
            self._sent += 1
            heapq.heappush(self._events, (time_ns, 0, self._sent, happen))

    def schedule_timer(self, time_ns: int, order: int, happen: Callable[[], None]) -> None:
        """Have a timer fire at a time, after all messages, in the order of the timers."""
        heapq.heappush(self._events, (time_ns, 1, order, happen))

    def next_timer_order(self) -> int:
        """The place of a new timer among the others."""
        self._timer_count += 1
        return self._timer_count

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
        if self.filters:
            self._publish_filtered(topic, message)
        else:
            self._send(topic, message)

    def call(self, service: Service, request: Any) -> Future:
        """Ask a service; the answer comes at the same moment, and never if nobody answers."""
        future = Future()
        self._calls[future] = None
        self.schedule(self.time_ns, partial(self._answer, service, request, future))
        return future

    def save(self) -> Any:
        """All that `restore` needs to put the bus back as it is now. raises: RuntimeError if called from a callback."""
        self._check_idle("save it")
        return (
            (self.time_ns, self.clock_offset_ns, self._sent, self._timer_count),
            (list(self._events), list(self._at_once), list(self.filters)),
            [(topic, topic.save()) for topic in self._topics.values()],
            [(service, service.handler) for service in self._services.values()],
            [(timer, timer.save()) for timer in self.timers],
            [(future, future.save()) for future in self._calls],
            [(node, node.save()) for node in self.nodes],
        )

    def restore(self, state: Any) -> None:
        """Be as when the state was saved. Handles made since are void. raises: RuntimeError if called from a callback."""
        self._check_idle("restore it")
        counters, (events, at_once, filters), topics, services, timers, calls, nodes = state
        self.time_ns, self.clock_offset_ns, self._sent, self._timer_count = counters
        self._events, self._at_once, self.filters = list(events), deque(at_once), list(filters)
        for topic in self._topics.values():
            topic.restore(topic.empty)
        for service in self._services.values():
            service.handler = None
        for timer in self.timers:
            timer.cancel()
        self._topics = {topic.name: topic for topic, _ in topics}
        self._services = {service.name: service for service, _ in services}
        for service, handler in services:
            service.handler = handler
        self.timers = {timer: None for timer, _ in timers}
        self._calls = {future: None for future, _ in calls}
        self.nodes = [node for node, _ in nodes]
        for keeper, kept in (*topics, *timers, *calls, *nodes):
            keeper.restore(kept)

    def close(self) -> None:
        """Forget all that is under way, and whom to call. Time does not go on after. The second time, nothing happens."""
        if self._closed:
            return
        self.restore(((self.time_ns, 0, 0, 0), ((), (), ()), (), (), (), (), ()))
        self.taps.clear()
        self._closed = True

    def _send(self, topic: Topic, message: Message) -> None:
        topic.latest, topic.latest_ns = message, self.time_ns
        topic.count += 1
        for tap in self.taps:
            tap(topic.name, message, self.time_ns)
        for subscription in topic.subscriptions:
            self._at_once.append((partial(subscription.hand, message), self._chain + 1))

    def _publish_filtered(self, topic: Topic, message: Message) -> None:
        copies = [(0, message)]
        for change in tuple(self.filters):
            passed: list[tuple[int, Message]] = []
            for delay_ns, copy in copies:
                made = change(topic.name, copy)
                passed += [(delay_ns, copy)] if made is None else [(delay_ns + more_ns, new) for more_ns, new in made]
            copies = passed
        for delay_ns, copy in copies:
            if delay_ns <= 0:
                self._send(topic, copy)
            else:
                self.schedule(self.time_ns + delay_ns, partial(self._send, topic, copy))

    def _answer(self, service: Service, request: Any, future: Future) -> None:
        self._calls.pop(future, None)
        if service.handler is not None:
            future.set_result(service.handler(request, service.srv_type.Response()))

    def _check_idle(self, deed: str) -> None:
        if self._closed:
            raise RuntimeError("the simulation is closed")
        if self._running:
            raise RuntimeError(f"the bus is running already: a callback must not {deed}")


def absolute(name: str) -> str:
    """The name from the root on."""
    if not name.strip("/"):
        raise ValueError(f"a topic or service must have a name, got {name!r}")
    return name if name.startswith("/") else f"/{name}"


@dataclass(eq=False)
class Service(Handle):
    """A name that requests are sent to, and who answers them."""

    name: str
    srv_type: Any
    handler: Callable[[Any, Any], Any] | None = None


@dataclass(eq=False)
class Subscription(Handle, Generic[M]):
    """A callback that gets the messages of a topic."""

    topic: Topic
    callback: Callable[[M], None]
    active: bool = True

    def hand(self, message: Any) -> None:
        """Call back with a message, unless the subscription was destroyed."""
        if self.active:
            self.callback(message)


@dataclass(eq=False)
class Topic(Handle):
    """A name that messages of one type are sent to."""

    name: str
    msg_type: type[Message]
    subscriptions: tuple[Subscription[Any], ...] = ()
    latest: Message | None = None
    latest_ns: int = 0
    latched: bool = False
    count: int = 0

    empty = ((), None, 0, False, 0)

    def save(self) -> Any:
        """Who is subscribed, and what was last sent."""
        return self.subscriptions, self.latest, self.latest_ns, self.latched, self.count

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        for subscription in self.subscriptions:
            subscription.active = False
        self.subscriptions, self.latest, self.latest_ns, self.latched, self.count = state
        for subscription in self.subscriptions:
            subscription.active = True


@dataclass(eq=False)
class Publisher(Handle, Generic[M]):
    """Sends messages to a topic."""

    bus: Bus
    topic: Topic

    @property
    def topic_name(self) -> str:
        """The topic's name."""
        return self.topic.name

    def publish(self, message: M) -> None:
        """Send one message, as it is now: it may change after, and be sent again."""
        self.bus.publish(self.topic, copied(message))

    def get_subscription_count(self) -> int:
        """How many are subscribed."""
        return len(self.topic.subscriptions)


class FreshPublisher(Publisher[M]):
    """For who makes each message anew: sends it without a copy."""

    def publish(self, message: M) -> None:
        """Send one message, which must not change after."""
        self.bus.publish(self.topic, message)
