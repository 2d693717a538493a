"""Saving: the state of a simulation, and things of the user's own that are saved along."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Snapshot:
    """What `Simulation.save` saved; only `Simulation.restore` of the same simulation can make use of it."""

    simulation: object = field(repr=False)
    time: float
    parts: Any = field(repr=False)


class Kept:
    """Things saved by their methods `save()` and `restore(state)`, if they have both, else by deep copies of attributes."""

    def __init__(self) -> None:
        self._things: list[Any] = []

    def add(self, thing: Any) -> None:
        """Save one more from now on."""
        self._things.append(thing)

    def save(self) -> Any:
        """All that `restore` needs. raises: TypeError for what cannot be copied."""
        return [(thing, _saved(thing)) for thing in self._things]

    def restore(self, state: Any) -> None:
        """Have all things, and them alone, be as when the state was saved."""
        self._things = [thing for thing, _ in state]
        for thing, saved in state:
            _restore(thing, saved)


def _saved(thing: Any) -> Any:
    if hasattr(thing, "save") and hasattr(thing, "restore"):
        return thing.save()
    return copy.deepcopy(vars(thing), {id(thing): thing})


def _restore(thing: Any, state: Any) -> None:
    if hasattr(thing, "save") and hasattr(thing, "restore"):
        thing.restore(state)
    else:
        vars(thing).clear()
        vars(thing).update(copy.deepcopy(state, {id(thing): thing}))
