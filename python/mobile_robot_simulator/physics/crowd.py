"""Crowd: the obstacles and the robots with a footprint at one time, as Python and as the core know them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, TypeAlias, TypeVar

import numpy as np

from .._core import Obstacles, OccupancyGrid, Pose, Shape, touches

T = TypeVar("T")

OPEN = OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0)
"""A map without walls, to ask for obstacles alone."""

Placed: TypeAlias = tuple[Shape, Pose]
"""A shape and its pose in the map frame."""


class Crowd(Generic[T]):
    """Things with a shape, each at its place, in an order that stays.

    The core gets each place once, however many robots look at it.

    Args:
        things: Each thing with its shape and its pose in the map frame.

    """

    def __init__(self, things: Sequence[tuple[T, Placed]] = ()) -> None:
        self.things = list(things)
        """Each thing with its shape and pose."""
        self._core: Obstacles | None = None
        """The same for the core, None until it is needed."""
        self._index_of: dict[T, int] = {}
        """Index of each thing, if `_core` is not None."""
        self._around: dict[T, Obstacles] = {}
        """Results of `around`."""

    def index_of(self, thing: T) -> int | None:
        """Returns the index of a thing in `things`, None if it is not there."""
        self._prepare()
        return self._index_of.get(thing)

    def move(self, index: int, pose: Pose) -> None:
        """Moves the thing at an index of `things`."""
        thing, (shape, _) = self.things[index]
        self.things[index] = thing, (shape, pose)
        if self._core is not None:
            self._core.place(index, shape, pose)

    def insert(self, index: int, thing: T, placed: Placed) -> None:
        """Adds a thing before the one at an index of `things`."""
        is_last = index == len(self.things)
        self.things.insert(index, (thing, placed))
        if self._core is None or self._around or not is_last:
            # Results of `around` stay as they are.
            self._core = None
            return
        self._core.place(index, *placed)
        self._index_of[thing] = index

    def touches(self, shape: Shape, pose: Pose, besides: T | None = None) -> list[T]:
        """Returns the things that a shape at a pose touches, in their order.

        Args:
            shape: The shape.
            pose: Its pose in the map frame.
            besides: A thing that does not count.
        """
        self._prepare()
        assert self._core is not None
        others = self._core if besides is None else self._core.without(self._index_of.get(besides))
        if not touches(OPEN, shape, pose, obstacles=others):
            return []
        near = [thing for thing, placed in self.things if touches(OPEN, shape, pose, obstacles=[placed])]
        return [thing for thing in near if thing is not besides]

    def around(self, thing: T) -> Obstacles:
        """Returns everything but one thing, whose index remains. Always the same object until something is inserted."""
        self._prepare()
        if (around := self._around.get(thing)) is None:
            assert self._core is not None
            around = self._around[thing] = self._core.without(self._index_of.get(thing))
        return around

    def _prepare(self) -> None:
        if self._core is None:
            self._core = Obstacles([placed for _, placed in self.things])
            self._index_of = {thing: index for index, (thing, _) in enumerate(self.things)}
            self._around = {}
