"""Message filters: replace, delay or drop messages on their way. Faults use them, on the bus and on ROS."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ..messages import Message

Filter = Callable[[str, Message], list[tuple[int, Message]] | None]
"""Takes a topic's name and a message. Returns (delay [ns], message) pairs to send instead, or None to change nothing."""


def filtered(filters: Iterable[Filter], topic: str, message: Message) -> list[tuple[int, Message]]:
    """Returns the messages to send instead of a message, each with its delay [ns].

    Args:
        filters: Filters, in the order in which they apply. Each takes what the previous ones return.
        topic: Full name of the topic.
        message: The message.
    """
    delayed_messages = [(0, message)]
    for replace in tuple(filters):
        passed: list[tuple[int, Message]] = []
        for delay_ns, before in delayed_messages:
            after = replace(topic, before)
            passed += [(delay_ns, before)] if after is None else [(delay_ns + more_ns, new) for more_ns, new in after]
        delayed_messages = passed
    return delayed_messages
