"""Kept: objects of the user that are saved and restored with a simulation."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any, Protocol, TypeGuard


class Savable(Protocol):
    """An object that defines what of it is saved."""

    def save(self) -> object:
        """Returns the state that `restore` takes."""

    def restore(self, state: object, /) -> None:
        """Returns to a saved state, which stays usable."""


@dataclass(frozen=True)
class KeptSnapshot:
    """A saved object.

    Attributes:
        thing: The object itself.
        state: What its `save()` returned, or else deep copies of its attributes by name.
    """

    thing: object
    state: object


class Kept:
    """Objects that are saved and restored with a simulation.

    An object with the methods `save()` and `restore(state)` is saved by them; any other by deep copies of its attributes.
    """

    def __init__(self) -> None:
        self._things: list[object] = []

    def add(self, thing: object) -> None:
        """Adds an object, which is saved from now on."""
        self._things.append(thing)

    def save(self) -> tuple[KeptSnapshot, ...]:
        """Returns the state that `restore` takes.

        Raises:
            TypeError: An attribute of an object cannot be copied.
        """
        return tuple(KeptSnapshot(thing, _saved(thing)) for thing in self._things)

    def restore(self, states: tuple[KeptSnapshot, ...]) -> None:
        """Returns to a saved state. Objects added since then are no longer kept."""
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
    """Returns deep copies of the attributes of an object, in which references to the object itself still mean it."""
    return copy.deepcopy(attributes, {id(thing): thing})
