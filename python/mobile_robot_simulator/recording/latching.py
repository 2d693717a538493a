"""Latched topics, of which late subscribers get the last message."""

from __future__ import annotations

_LATCHED = ("map", "tf_static")


def is_latched(topic: str) -> bool:
    """Returns whether a topic is latched, in any namespace."""
    return topic.rpartition("/")[2] in _LATCHED
