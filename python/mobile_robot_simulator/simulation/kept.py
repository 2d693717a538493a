"""Kept: the user's objects that are saved and restored with a simulation (`Simulation.keep`)."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any, Protocol, TypeGuard


class Savable(Protocol):
    """An object that saves and restores itself."""

    def save(self) -> object:
        """Returns the state that `restore` takes."""

    def restore(self, state: object, /) -> None:
        """Puts the object back into a saved state. The state can be restored again."""


@dataclass(frozen=True)
class KeptSnapshot:
    """Saved state of an object.

    Attributes:
        thing: The object itself.
        state: Result of its `save()`, or deep copies of its attributes by name if it has no such method.
    """

    thing: object
    state: object


class Kept:
    """The user's objects that are saved and restored with a simulation.

    If an object has the methods `save()` and `restore(state)`, they are called. Otherwise its attributes are deep-copied.
    """

    def __init__(self) -> None:
        self._things: list[object] = []

    def add(self, thing: object) -> None:
        """Adds an object. It is saved from now on."""
        self._things.append(thing)

    def save(self) -> tuple[KeptSnapshot, ...]:
        """Returns the state that `restore` takes.

        Raises:
            TypeError: An attribute of an object cannot be copied.
        """
        return tuple(KeptSnapshot(thing, _saved(thing)) for thing in self._things)

    def restore(self, states: tuple[KeptSnapshot, ...]) -> None:
        """Puts the objects back into their saved states. Objects added later are no longer saved."""
        self._things = [state.thing for state in states]
        for state in states:
            _restore(state)


def _saves_itself(thing: object) -> TypeGuard[Savable]:
    return hasattr(thing, "save") and hasattr(thing, "restore")


def _saved(thing: object) -> object:
    return thing.save() if _saves_itself(thing) else _copied(vars(thing), thing)


def _restore(kept: KeptSnapshot) -> None:
    if _saves_itself(kept.thing):
        kept.thing.restore(kept.state)
    else:
        attributes = _copied(kept.state, kept.thing)
        vars(kept.thing).clear()
        vars(kept.thing).update(attributes)


def _copied(attributes: Any, thing: object) -> Any:
    """Returns deep copies of an object's attributes. References to the object itself stay as they are."""
    return copy.deepcopy(attributes, {id(thing): thing})
