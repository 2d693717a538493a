"""Handles: what is held on to, not copied; and those that a node has taken hold of, to be let go together."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any


class Handle:
    """Something that is itself wherever it is kept: a copy of what holds it holds the same one."""

    def __deepcopy__(self, memo: object) -> Any:
        return self


def check_callback(callback: object) -> None:
    """Refuse what cannot be called."""
    if not callable(callback):
        raise TypeError(f"a callback must be callable, got {callback!r}")


class Handles:
    """Publishers, subscriptions, timers: each with what lets go of it.

    In a `with` block, all is let go of if the block raises.
    """

    def __init__(self) -> None:
        self._undo: list[Callable[[], object]] = []

    def add(self, let_go: Callable[..., object], *handle: Any) -> None:
        """Remember a handle, and what lets go of it."""
        self._undo.append(partial(let_go, *handle))

    def close(self) -> None:
        """Let go of everything, the last first."""
        for undo in reversed(self._undo):
            undo()

    def __enter__(self) -> Handles:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is not None:
            self.close()
