"""Latched topics: a new subscriber receives the last message."""

from __future__ import annotations

_LATCHED = ("map", "tf_static")


def is_latched(topic: str) -> bool:
    """Returns True if a topic is latched. Its namespace does not matter."""
    return topic.rpartition("/")[2] in _LATCHED
