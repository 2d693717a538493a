"""Digest: a fingerprint of all messages of a drive, to the last bit."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass

import numpy as np

from ..messages import Message

__all__ = ["Digest"]


class Digest:
    """The SHA-256 of all messages that are written to it: their topics, times, types and fields."""

    def __init__(self) -> None:
        self._hash = hashlib.sha256()

    def write(self, topic: str, message: Message, time_ns: int) -> None:
        """Adds a message that was published on a topic.

        Args:
            topic: Name of the topic.
            message: The message.
            time_ns: Time of publication [ns].
        """
        self._add(topic)
        self._add(time_ns)
        self._add(message)

    def text(self) -> str:
        """Returns the digest of what was written so far, 64 hexadecimal digits."""
        return self._hash.hexdigest()

    def _add(self, value: object) -> None:
        if is_dataclass(value):
            self._hash.update(f"<{type(value).__name__}".encode())
            for field in fields(value):
                self._add(getattr(value, field.name))
        elif isinstance(value, np.ndarray):
            self._hash.update(f"<{value.dtype.str}{value.shape}".encode())
            self._hash.update(np.ascontiguousarray(value).tobytes())
        elif isinstance(value, list | tuple):
            self._hash.update(f"<{len(value)}".encode())
            for item in value:
                self._add(item)
        else:
            # repr of a float has all its digits.
            self._hash.update(f"<{value!r}".encode())
