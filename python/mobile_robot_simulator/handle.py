"""Handles: objects that deep copies share, and `Handles`, which releases the resources of a node together."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from .quoting import quoted


class Handle:
    """Base class of objects that a deep copy shares instead of copying."""

    def __deepcopy__(self, memo: object) -> Any:
        return self


def check_callback(callback: object) -> None:
    """Checks that an object is callable.

    Args:
        callback: The object.

    Raises:
        TypeError: It is not callable.
    """
    if not callable(callback):
        raise TypeError(f"a callback must be callable, got {quoted(callback)}")


class Handles:
    """Publishers, subscriptions and timers of a node, each with the function that releases it.

    As a context manager, it releases everything if the block raises, and nothing otherwise.
    """

    def __init__(self) -> None:
        self._releases: list[Callable[[], object]] = []

    def add(self, release: Callable[..., object], *handle: Any) -> None:
        """Adds a handle.

        Args:
            release: Function that releases it.
            *handle: Arguments of that function.
        """
        self._releases.append(partial(release, *handle))

    def close(self) -> None:
        """Releases everything, the last added first."""
        for release in reversed(self._releases):
            release()

    def __enter__(self) -> Handles:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is not None:
            self.close()
