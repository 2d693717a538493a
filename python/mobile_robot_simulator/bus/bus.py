"""The bus: topics, services and timers in one process, on a simulated clock.

Simulated time jumps from one event to the next; nothing sleeps. The order of events is fixed, so every run repeats exactly.

Order of events
    1. Earlier times come first.
    2. At one time, messages and service calls come first, in the order in which they were sent. A message that was delayed
       until this time was sent earlier, so it precedes those sent at this time.
    3. When no message is left, the next timer of this time fires. Timers fire in the order in which they were created.
    4. Messages that a timer's callback sends are delivered before the next timer fires.

    Two timers A and B are due at 1.0 s, and a message is delayed until 1.0 s::

         time
          |   0.9 s   ...
          |
          |   1.0 s   the delayed message
          |           messages that its callbacks send
          |           timer A
          |           messages that A sends, then those that their callbacks send
          |           timer B
          |           messages that B sends, then those that their callbacks send
          |
          v   1.1 s   ...

Delivery
    A message goes to the subscriptions that exist when it is sent. It is delivered after the callback that sent it has
    returned. Its publisher copies it once (`NoCopyPublisher` does not). All subscribers receive the same object and must not
    change it.

Saving
    `Bus.save` returns a snapshot: the time, pending messages and service calls, timers, subscriptions, latest messages and
    nodes. `Bus.restore` goes back to it. Callbacks are shared, not copied, so a snapshot does not contain data that they
    store outside of nodes. `Simulation.keep` adds such data to the snapshots of a simulation.
"""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from operator import itemgetter
from typing import Any, Protocol

from ..handle import Handle
from ..instant import NANOSECONDS
from ..messages import Message
from ..nodes.future import Future, FutureSnapshot
from ..nodes.interface import M
from ..nodes.message_filters import Filter, filtered
from ..quoting import quoted
from .current import reset_current, set_current
from .service import BusService, ServiceHandler
from .task import BusTask
from .timer import BusTimer, Firing, TimerSnapshot
from .topic import BusPublisher, BusTopic, LazyTap, NoCopyPublisher, Tap, TopicSnapshot, absolute
from .waiting import Response, Waiting

Action = Callable[[], None]
"""What an event does."""

Event = tuple[int, int, int, Action]
"""Time [ns], kind (`MESSAGE` or `TIMER`), rank among the events of the same time and kind, action."""

MESSAGE, TIMER = 0, 1
"""Kinds of events. At the same time, messages run before timers."""

MAX_CHAIN_LENGTH = 10_000
"""Longest chain of events at the same time in which each event causes the next. A longer one counts as an endless loop."""

MAX_REPLIES = 100_000
"""Largest number of events at one time that other events of that time cause. More of them count as an endless loop."""


class BusMember(Protocol):
    """A node on the bus. `Bus.save` and `Bus.restore` save and restore it with the bus."""

    def save(self) -> Any:
        """Returns the state that `restore` takes."""

    def restore(self, state: Any) -> None:
        """Puts the node back into a saved state."""


@dataclass(frozen=True)
class BusSnapshot:
    """Saved state of a bus. The defaults are the state of an empty bus.

    Attributes:
        time_ns: Simulated time [ns].
        rounded: End of the last `run_for` [ns], and what rounding has cut off it [ns].
        clock_offset_ns: Time on the nodes' clocks minus simulated time [ns].
        scheduled_count: Number of actions scheduled for a later time so far.
        timer_count: Number of timers created so far.
        events: Scheduled events, without timers.
        firings: Timers that are due, each with its time [ns].
        immediate: Actions that are due now, each with its position in its chain (see `MAX_CHAIN_LENGTH`).
        filters: Message filters, in the order in which they apply.
        topics: All topics with their states.
        services: All services with their handlers.
        timers: All timers with their states.
        calls: Futures of pending service calls, with their states.
        nodes: All nodes with their states.
    """

    time_ns: int
    rounded: tuple[int, float] = (0, 0.0)
    clock_offset_ns: int = 0
    scheduled_count: int = 0
    timer_count: int = 0
    events: Sequence[Event] = ()
    firings: Sequence[tuple[int, Firing]] = ()
    immediate: Sequence[tuple[Action, int]] = ()
    filters: Sequence[Filter] = ()
    topics: Mapping[BusTopic, TopicSnapshot] = field(default_factory=dict)
    services: Mapping[BusService, ServiceHandler | None] = field(default_factory=dict)
    timers: Mapping[BusTimer, TimerSnapshot] = field(default_factory=dict)
    calls: Mapping[Future, FutureSnapshot] = field(default_factory=dict)
    nodes: Sequence[tuple[BusMember, Any]] = ()


class Bus(Handle):
    """Runs events in order on a simulated clock that starts at 0.

    Attributes:
        time_ns: Simulated time [ns].
        clock_offset_ns: Time on the nodes' clocks minus simulated time [ns].
        taps: Functions that see every message when it is sent.
        lazy_taps: Those that get the call that builds a message, if nobody else needs the message.
        filters: Functions that can replace, delay or drop a message before it is sent. They apply in this order.
        nodes: Nodes on the bus, in the order in which they were created.
        timers: Timers, in the order in which they were created.
        tasks: Coroutines of async callbacks that wait for something, in the order in which they were started.
        waiting: Waits on the bus, for constructors of nodes.
    """

    def __init__(self) -> None:
        self.time_ns = 0
        self.clock_offset_ns = 0
        self.taps: list[Tap] = []
        self.lazy_taps: list[LazyTap] = []
        self.filters: list[Filter] = []
        self.nodes: list[BusMember] = []
        self.timers: dict[BusTimer, None] = {}
        self.tasks: dict[BusTask, None] = {}
        self.waiting = Waiting(self)
        self._events: list[Event] = []
        """Delayed messages, and for each time in `_firings` an event without an action, as a heap."""
        self._firings: dict[int, list[Firing]] = {}
        """Timers that are due later, by their times [ns]. Many are due at few times, and a list is faster than a heap."""
        self._due: deque[Firing] = deque()
        """Timers that are due now, after all messages, by rank."""
        self._immediate: deque[tuple[Action, int]] = deque()
        self._chain_length, self._reply_count = 0, 0
        self._calls: dict[Future, None] = {}
        self._scheduled_count = 0
        self._timer_count = 0
        self._is_running = self._is_closed = False
        self._rounded = 0, 0.0
        """End of the last `run_for` [ns], and what rounding has cut off it [ns]."""
        self._topics: dict[str, BusTopic] = {}
        self._services: dict[str, BusService] = {}

    @property
    def clock_ns(self) -> int:
        """Time on the nodes' clocks [ns]."""
        return self.time_ns + self.clock_offset_ns

    @property
    def is_running(self) -> bool:
        """True during a run, so a callback has made the call."""
        return self._is_running

    # --- time ---

    def run_until(self, time_ns: int) -> None:
        """Runs all events up to and including a time, then sets the simulated time to it.

        An exception in a callback ends the run and is raised here. The bus stays usable: the next run continues with the
        next event.

        Args:
            time_ns: Time to run to [ns].

        Raises:
            ValueError: The time is in the past.
            RuntimeError: The bus is running (the call came from a callback) or closed, or callbacks keep sending messages
                to each other, so that time would stand still forever.
        """
        if time_ns < self.time_ns:
            raise ValueError(f"the time to run to must not be in the past, got {time_ns} ns at {self.time_ns} ns")
        self._check_idle("run it")
        self._is_running, token = True, set_current(self)
        try:
            self._run_events(time_ns)
            self.time_ns = time_ns
        finally:
            reset_current(token)
            self._is_running, self._chain_length, self._reply_count = False, 0, 0

    def run_for(self, seconds: float) -> None:
        """Runs all events of a duration, then sets the simulated time to its end.

        The end is rounded to nanoseconds. Durations that follow one another add up before they are rounded: 30 runs of
        1/30 s end at 1 s.

        Args:
            seconds: Simulated duration [s], at least 0 and finite.

        Raises:
            RuntimeError: As for `run_until`.
        """
        time_ns, left = self._rounded
        asked = seconds * NANOSECONDS + (left if time_ns == self.time_ns else 0.0)
        end_ns = self.time_ns + round(asked)
        self.run_until(end_ns)
        self._rounded = end_ns, asked - round(asked)

    def next_ns(self) -> int | None:
        """Returns the time of the next event [ns], or None if there is none."""
        if self._immediate or self._due:
            return self.time_ns
        return self._events[0][0] if self._events else None

    def schedule(self, time_ns: int, action: Action) -> None:
        """Runs an action at a time, in order with the messages of that time. A time that is not in the future means now.

        Args:
            time_ns: Simulated time [ns].
            action: Called without arguments.
        """
        if time_ns <= self.time_ns:
            self._immediate.append((action, self._chain_length + 1))
        else:
            self._scheduled_count += 1
            heapq.heappush(self._events, (time_ns, MESSAGE, self._scheduled_count, action))

    def schedule_timer(self, time_ns: int, firing: Firing) -> None:
        """Fires a timer at a time [ns], after the messages of that time. Timers of one time fire by ascending rank."""
        firings = self._firings.get(time_ns)
        if firings is None:
            firings = self._firings[time_ns] = []
            heapq.heappush(self._events, (time_ns, TIMER, 0, _nothing))
        firings.append(firing)

    @property
    def due_timers(self) -> list[BusTimer]:
        """The timers that fire at this time after the current callback, in order. Some of them may be cancelled."""
        return [timer for _, timer in self._due]

    def next_timer_order(self) -> int:
        """Returns the rank of a new timer, one more than the last. Timers that are due at the same time fire by rank.

        Goals of actions take their identifiers from the same sequence, because it is saved, and repeats in every run.
        """
        self._timer_count += 1
        return self._timer_count

    # --- topics ---

    def topic_names(self) -> list[str]:
        """Returns the names of all topics, sorted."""
        return sorted(self._topics)

    def topics(self) -> list[BusTopic]:
        """Returns all topics, sorted by name."""
        return [self._topics[name] for name in self.topic_names()]

    def topic(self, name: str, msg_type: type[Message]) -> BusTopic:
        """Returns the topic with this name. Creates it if it does not exist.

        Args:
            name: Name, with or without a leading slash.
            msg_type: Message class.

        Raises:
            TypeError: `msg_type` is not a message class, or it is not the message class of the existing topic.
            ValueError: The name is empty.
            RuntimeError: The bus is closed.
        """
        self.check_open()
        if not (isinstance(msg_type, type) and issubclass(msg_type, Message)):
            raise TypeError(f"a topic's type must be a message class, got {quoted(msg_type)} for {name}")
        name = absolute(name)
        topic = self._topics.get(name)
        if topic is None:
            topic = self._topics[name] = BusTopic(name, msg_type)
        if topic.msg_type is not msg_type:
            raise TypeError(f"{topic.name} carries {topic.msg_type.__name__}, got {msg_type.__name__}")
        return topic

    def publisher(self, name: str, msg_type: type[M]) -> NoCopyPublisher[M]:
        """Returns a publisher of messages that do not change once they are sent. Arguments and errors as for `topic`."""
        return NoCopyPublisher(self, self.topic(name, msg_type))

    def find_topic(self, name: str) -> BusTopic | None:
        """Returns the topic of a name, or None if it does not exist."""
        found = self._topics.get(name) if type(name) is str else None  # names are absolute, as most callers write them
        return self._topics.get(absolute(name)) if found is None else found

    def latest(self, topic: str) -> Message | None:
        """Returns the last message sent to a topic, or None if there is none."""
        found = self.find_topic(topic)
        return found.latest if found else None

    def latched(self) -> list[tuple[str, Message, int]]:
        """Returns the messages that new subscriptions to latched topics receive, each with its topic and time [ns]."""
        return [(topic.name, message, time_ns) for topic in self.topics() for message, time_ns in topic.kept.values()]

    def publish(self, publisher: BusPublisher[Any], message: Message) -> None:
        """Passes a message through the filters, then sends it to the current subscriptions. Does not copy it.

        Args:
            publisher: Publisher that sends it.
            message: The message.

        Raises:
            TypeError: The message is not of the topic's message class.
        """
        topic = publisher.topic
        if not isinstance(message, topic.msg_type):
            raise TypeError(f"{topic.name} carries {topic.msg_type.__name__}, got {type(message).__name__}")
        if self.filters:
            self._publish_filtered(publisher, message)
        else:
            self._send(publisher, message)

    # --- services ---

    def services(self) -> list[BusService]:
        """Returns all services that a node offers, sorted by name."""
        return [self._services[name] for name in sorted(self._services) if self._services[name].handler is not None]

    def service(self, name: str, srv_type: Any) -> BusService:
        """Returns the service with this name. Creates it, without a handler, if it does not exist.

        Args:
            name: Name, with or without a leading slash.
            srv_type: Service class with `Request` and `Response`.

        Raises:
            TypeError: `srv_type` is not the service class of the existing service.
            ValueError: The name is empty.
        """
        name = absolute(name)
        service = self._services.get(name)
        if service is None:
            service = self._services[name] = BusService(name, srv_type)
        if service.srv_type is not srv_type:
            raise TypeError(f"{service.name} is a {service.srv_type.__name__}, got {srv_type.__name__}")
        return service

    def call(self, service: BusService, request: Any, convert: Callable[[Any], Any] | None = None) -> Future:
        """Calls a service. Does not copy the request.

        Args:
            service: The service.
            request: The request.
            convert: Function that takes the response and returns what the future brings instead. None for the response.

        Returns:
            A future for the response. It completes at the same simulated time, or never if the service has no handler.
        """
        future = Response(self.waiting, f"the response of {service.name}")
        self._calls[future] = None
        self.schedule(self.time_ns, partial(self._answer, service, request, future, convert))
        return future

    # --- saving ---

    def save(self) -> BusSnapshot:
        """Returns a snapshot that `restore` takes.

        Raises:
            RuntimeError: The bus is running (the call came from a callback) or closed, or an async callback waits, because a
                coroutine cannot be copied.
        """
        self._check_idle("save it")
        if self.tasks:
            waiting = ", ".join(map(repr, self.tasks))
            raise RuntimeError(f"the bus cannot be saved while async callbacks wait: {waiting}")
        return BusSnapshot(
            time_ns=self.time_ns,
            rounded=self._rounded,
            clock_offset_ns=self.clock_offset_ns,
            scheduled_count=self._scheduled_count,
            timer_count=self._timer_count,
            events=tuple(event for event in self._events if event[1] == MESSAGE),
            firings=self._scheduled_firings(),
            immediate=tuple(self._immediate),
            filters=tuple(self.filters),
            topics={topic: topic.save() for topic in self._topics.values()},
            services={service: service.handler for service in self._services.values()},
            timers={timer: timer.save() for timer in self.timers},
            calls={future: future.save() for future in self._calls},
            nodes=tuple((node, node.save()) for node in self.nodes),
        )

    def restore(self, state: BusSnapshot) -> None:
        """Puts the bus back into a saved state. A snapshot can be restored any number of times.

        Subscriptions, timers and services that were created after the snapshot become inactive.

        Raises:
            RuntimeError: The bus is running (the call came from a callback) or closed.
        """
        self._check_idle("restore it")
        self.time_ns, self._rounded, self.clock_offset_ns = state.time_ns, state.rounded, state.clock_offset_ns
        self._scheduled_count, self._timer_count = state.scheduled_count, state.timer_count
        self._immediate, self.filters = deque(state.immediate), list(state.filters)
        self._events, self._firings, self._due = list(state.events), {}, deque()
        heapq.heapify(self._events)
        for time_ns, firing in state.firings:
            self.schedule_timer(time_ns, firing)
        self._deactivate()
        for task in tuple(self.tasks):
            task.close()
        self._topics = {topic.name: topic for topic in state.topics}
        self._services = {service.name: service for service in state.services}
        self.timers = dict.fromkeys(state.timers)
        self._calls = dict.fromkeys(state.calls)
        self.nodes = [node for node, _ in state.nodes]
        for topic, topic_state in state.topics.items():
            topic.restore(topic_state)
        for service, handler in state.services.items():
            service.handler = handler
        for timer, timer_state in state.timers.items():
            timer.restore(timer_state)
        for future, future_state in state.calls.items():
            future.restore(future_state)
        for node, node_state in state.nodes:
            node.restore(node_state)

    def close(self) -> None:
        """Drops all events, callbacks and nodes. Closing twice has no effect.

        Afterwards `run_until`, `save`, `restore` and `topic` raise RuntimeError.
        """
        if self._is_closed:
            return
        self.restore(BusSnapshot(self.time_ns))
        self.taps.clear()
        self.lazy_taps.clear()
        self._is_closed = True

    def check_open(self) -> None:
        """Checks that the bus is not closed.

        Raises:
            RuntimeError: It is closed.
        """
        if self._is_closed:
            raise RuntimeError("the simulation is closed")

    def _deactivate(self) -> None:
        """Makes all current subscriptions, services and timers inactive."""
        for topic in self._topics.values():
            topic.restore(TopicSnapshot())
        for service in self._services.values():
            service.handler = None
        for timer in self.timers:
            timer.cancel()

    def _scheduled_firings(self) -> tuple[tuple[int, Firing], ...]:
        """Returns all timers that are due, each with its time [ns]."""
        later = ((time_ns, firing) for time_ns, firings in self._firings.items() for firing in firings)
        return (*((self.time_ns, firing) for firing in self._due), *later)

    def _run_events(self, time_ns: int) -> None:
        events, immediate, due = self._events, self._immediate, self._due
        while True:
            # A message in `events` that is due now was sent at an earlier time than those in `immediate`.
            if immediate and not (events and events[0][0] <= self.time_ns and events[0][1] == MESSAGE):
                action, self._chain_length = immediate.popleft()
                self._reply_count += self._chain_length > 1
                if self._chain_length > MAX_CHAIN_LENGTH or self._reply_count > MAX_REPLIES:
                    seconds = self.time_ns / NANOSECONDS
                    raise RuntimeError(f"time stands still at {seconds} s: callbacks keep sending messages to each other")
            elif due:
                action, self._chain_length = due.popleft()[1].fire, 0
            elif events and events[0][0] <= time_ns:
                due_ns, kind, _, action = heapq.heappop(events)
                self._chain_length = 0
                if due_ns != self.time_ns:
                    self.time_ns, self._reply_count = due_ns, 0
                if kind == TIMER:
                    due.extend(sorted(self._firings.pop(due_ns), key=_rank))
                    continue
            else:
                break
            action()

    def _send(self, publisher: BusPublisher[Any], message: Message) -> None:
        topic, time_ns = publisher.topic, self.time_ns
        topic.last, topic.latest_ns = message, time_ns
        if publisher.latched:
            topic.keep(publisher, message, time_ns)
        for tap in self.taps:
            tap(topic.name, message, time_ns)
        for lazy_tap in self.lazy_taps:
            lazy_tap(topic.name, message, time_ns)
        for subscription in topic.subscriptions:
            self._immediate.append((partial(subscription.deliver, message), self._chain_length + 1))

    def _publish_filtered(self, publisher: BusPublisher[Any], message: Message) -> None:
        for delay_ns, replacement in filtered(self.filters, publisher.topic.name, message):
            if delay_ns <= 0:
                self._send(publisher, replacement)
            else:
                self.schedule(self.time_ns + delay_ns, partial(self._send, publisher, replacement))

    def _answer(
        self, service: BusService, request: Any, future: Future, convert: Callable[[Any], Any] | None = None
    ) -> None:
        if service.handler is None:
            self._calls.pop(future, None)
            return
        response = service.handler(request, service.srv_type.Response())
        complete = partial(self._complete, future, convert)
        if isinstance(response, Future):
            response.add_done_callback(lambda responded: complete(responded.result()))
        else:
            complete(response)

    def _complete(self, future: Future, convert: Callable[[Any], Any] | None, response: Any) -> None:
        """Ends a pending call."""
        self._calls.pop(future, None)
        future.set_result(response if convert is None else convert(response))

    def _check_idle(self, action: str) -> None:
        self.check_open()
        if self._is_running:
            raise RuntimeError(f"the bus is already running: a callback must not {action}")


_rank = itemgetter(0)


def _nothing() -> None:
    """Does nothing."""
