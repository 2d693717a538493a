"""The interface of message_filters on the bus: subscribers, synchronizers and a cache, chained to each other.

Simulated time orders the messages, so a synchronizer gives the same sets in every run. `Simulation.restore` restores the
messages that filters keep.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Callable, Sequence
from functools import partial
from itertools import product
from typing import Any

from ..bus.node import BusNode
from ..handle import Handle, check_callback
from ..instant import NANOSECONDS, Instant
from ..messages import Time
from ..quoting import quoted


class SimpleFilter(Handle):
    """Base class of filters. It keeps the callbacks and calls them with what the filter lets through.

    Attributes:
        node: Node that the filter's messages come from, or None before there is one.
    """

    node: BusNode | None = None

    def __init__(self) -> None:
        self._callbacks: list[Callable[..., object]] = []

    def registerCallback(self, cb: Callable[..., object], *args: Any) -> int:
        """Calls a function with each message, or set of messages, and with further arguments.

        Args:
            cb: The function.
            *args: Arguments that follow the messages.

        Returns:
            Number of the function.

        Raises:
            TypeError: It is not callable.
        """
        check_callback(cb)
        self._callbacks.append(partial(_call, cb, args))
        return len(self._callbacks) - 1

    def signalMessage(self, *msg: Any) -> None:
        """Calls all functions with messages."""
        for callback in tuple(self._callbacks):
            callback(*msg)

    def save(self) -> Any:
        """Returns the state that `restore` takes."""
        return tuple(self._callbacks), self._save_messages()

    def restore(self, state: Any) -> None:
        """Puts the filter back into a saved state."""
        callbacks, messages = state
        self._callbacks = list(callbacks)
        self._restore_messages(messages)

    def _save_messages(self) -> Any:
        return None

    def _restore_messages(self, state: Any) -> None:
        pass

    def _join(self, node: BusNode | None) -> None:
        """Has the bus of a node save and restore this filter."""
        self.node = node
        if node is not None and self not in node._bus.nodes:
            node._bus.nodes.append(self)

    def _stamp_ns(self, message: Any, allow_headerless: bool) -> int | None:
        """Returns the stamp of a message, or the current time if it has none and may have none."""
        header = getattr(message, "header", None)
        if header is not None:
            return int(header.stamp.nanoseconds)
        if allow_headerless and self.node is not None:
            return self.node.get_clock().now().nanoseconds
        if self.node is not None:
            kind = type(message).__name__
            self.node.get_logger().warning(f"{kind} has no header, so {type(self).__name__} drops it", once=True)
        return None


class Subscriber(SimpleFilter):
    """Lets the messages of a topic through, with the interface of `message_filters.Subscriber`.

    Args:
        node: Node to subscribe through.
        msg_type: Message class.
        topic: Name of the topic.
        qos_profile: Ignored.
        **_: Other keywords of rclpy are ignored.

    Raises:
        TypeError: The type is not a message class, or the existing topic has another type.
        ValueError: The name is empty.
    """

    def __init__(self, node: BusNode, msg_type: Any, topic: str, qos_profile: Any = 10, **_: Any) -> None:
        super().__init__()
        self._join(node)
        self.topic = topic
        self.sub = node.create_subscription(msg_type, topic, self.signalMessage, qos_profile)

    def unsubscribe(self) -> None:
        """Ends the subscription."""
        if self.node is not None:
            self.node.destroy_subscription(self.sub)


class Cache(SimpleFilter):
    """Keeps the last messages of a filter, with the interface of `message_filters.Cache`.

    Args:
        f: Filter that the messages come from. Without one, call `add` or `connectInput`.
        cache_size: Number of messages that are kept.
        allow_headerless: True if a message without a header has the time at which it arrives. Otherwise it is dropped.

    Raises:
        ValueError: The size is below 1.
    """

    def __init__(self, f: SimpleFilter | None = None, cache_size: int = 1, allow_headerless: bool = False) -> None:
        super().__init__()
        self._messages: deque[tuple[int, Any]] = deque(maxlen=_checked_size("cache_size", cache_size))
        self._allow_headerless = allow_headerless
        if f is not None:
            self.connectInput(f)

    def connectInput(self, f: SimpleFilter) -> None:
        """Adds the messages of a filter from now on."""
        self._join(f.node)
        f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Adds a message and lets it through."""
        stamp_ns = self._stamp_ns(msg, self._allow_headerless)
        if stamp_ns is not None:
            self._messages.append((stamp_ns, msg))
            self.signalMessage(msg)

    def getInterval(self, from_stamp: Instant | Time, to_stamp: Instant | Time) -> list[Any]:
        """Returns the messages between two stamps, both included, in the order of their arrival."""
        return [message for ns, message in self._messages if from_stamp.nanoseconds <= ns <= to_stamp.nanoseconds]

    def getElemAfterTime(self, stamp: Instant | Time) -> Any:
        """Returns the first message to arrive that has this stamp or a later one, or None."""
        return next((message for ns, message in self._messages if ns >= stamp.nanoseconds), None)

    def getElemBeforeTime(self, stamp: Instant | Time) -> Any:
        """Returns the last message to arrive that has this stamp or an earlier one, or None."""
        return next((message for ns, message in reversed(self._messages) if ns <= stamp.nanoseconds), None)

    def getLatestTime(self) -> Instant | None:
        """Returns the stamp of the last message to arrive, or None."""
        return Instant(self._messages[-1][0]) if self._messages else None

    getLastestTime = getLatestTime
    """The name in older versions of message_filters."""

    def getOldestTime(self) -> Instant | None:
        """Returns the stamp of the first of the messages to arrive, or None."""
        return Instant(self._messages[0][0]) if self._messages else None

    def getLast(self) -> Any:
        """Returns the last message to arrive, or None."""
        return self._messages[-1][1] if self._messages else None

    def _save_messages(self) -> Any:
        return tuple(self._messages)

    def _restore_messages(self, state: Any) -> None:
        self._messages = deque(state, self._messages.maxlen)


class TimeSynchronizer(SimpleFilter):
    """Lets through sets of messages with equal stamps, one from each input, as `message_filters.TimeSynchronizer` does.

    Args:
        fs: The inputs.
        queue_size: Number of messages that each input may have waiting. The one with the earliest stamp is dropped first.

    Raises:
        ValueError: There are no inputs, or the queue size is below 1.
    """

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        if not fs:
            raise ValueError("a synchronizer must have inputs, got none")
        self._size = _checked_size("queue_size", queue_size)
        self._waiting: list[dict[int, Any]] = [{} for _ in fs]
        self._join(next((each.node for each in fs if each.node is not None), None))
        for place, each in enumerate(fs):
            each.registerCallback(partial(self._add, place))

    def _add(self, place: int, message: Any) -> None:
        stamp_ns = self._stamp_ns(message, allow_headerless=False)
        if stamp_ns is not None:
            self._enqueue(place, stamp_ns, message)
            if all(stamp_ns in queue for queue in self._waiting):
                self._send([stamp_ns] * len(self._waiting))

    def _enqueue(self, place: int, stamp_ns: int, message: Any) -> None:
        queue = self._waiting[place]
        queue[stamp_ns] = message
        if len(queue) > self._size:
            del queue[min(queue)]

    def _send(self, stamps: Sequence[int]) -> None:
        self.signalMessage(*(queue.pop(stamp_ns) for queue, stamp_ns in zip(self._waiting, stamps, strict=True)))

    def _save_messages(self) -> Any:
        return [dict(queue) for queue in self._waiting]

    def _restore_messages(self, state: Any) -> None:
        self._waiting = [dict(queue) for queue in state]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Lets through sets of messages with nearly equal stamps, as `message_filters.ApproximateTimeSynchronizer` does.

    A new message goes with the messages of the other inputs whose stamps are nearest to its own. All stamps of a set are
    less than `slop` apart.

    Args:
        fs: The inputs.
        queue_size: Number of messages that each input may have waiting. The one with the earliest stamp is dropped first.
        slop: Difference that the stamps of a set must stay below [s].
        allow_headerless: True if a message without a header has the time at which it arrives. Otherwise it is dropped.

    Raises:
        ValueError: There are no inputs, the queue size is below 1, or the slop is not a number of at least 0.
    """

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int, slop: float, allow_headerless: bool = False) -> None:
        if not 0 <= slop * NANOSECONDS < float("inf"):
            raise ValueError(f"slop must be at least 0 s and finite, got {quoted(slop)}")
        super().__init__(fs, queue_size)
        self._slop_ns, self._allow_headerless = round(slop * NANOSECONDS), allow_headerless

    def _add(self, place: int, message: Any) -> None:
        stamp_ns = self._stamp_ns(message, self._allow_headerless)
        if stamp_ns is None:
            return
        self._enqueue(place, stamp_ns, message)
        near = [[stamp_ns] if i == place else self._near(queue, stamp_ns) for i, queue in enumerate(self._waiting)]
        if stamp_ns not in self._waiting[place]:
            return
        for stamps in product(*near):
            if max(stamps) - min(stamps) < self._slop_ns:
                self._send(stamps)
                return

    def _near(self, queue: dict[int, Any], stamp_ns: int) -> list[int]:
        """Returns the stamps in a queue that are near enough to a stamp, nearest first."""
        stamps = sorted(queue)
        near = stamps[bisect_left(stamps, stamp_ns - self._slop_ns) : bisect_right(stamps, stamp_ns + self._slop_ns)]
        return sorted(near, key=lambda other: abs(other - stamp_ns))


def _call(callback: Callable[..., object], more: tuple[Any, ...], *messages: Any) -> None:
    callback(*messages, *more)


def _checked_size(name: str, size: int) -> int:
    if size < 1:
        raise ValueError(f"{name} must be at least 1, got {quoted(size)}")
    return size
