"""Random choices that are the same on every machine and in every version of Python."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import TypeVar

_Item = TypeVar("_Item")


class Dice:
    """Random choices from a seed. Uses only `random.Random.random`, whose sequence Python guarantees not to change."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed).random

    def between(self, low: float, high: float) -> float:
        """A uniform number from low to high."""
        return low + (high - low) * self._random()

    def whole(self, low: int, high: int) -> int:
        """A uniform integer from low to high, both included; low if high is less than low."""
        return low + int(self._random() * max(1, high - low + 1))

    def chance(self, probability: float) -> bool:
        """True with this probability."""
        return self._random() < probability

    def one_of(self, items: Sequence[_Item]) -> _Item:
        """One of the items, each with the same probability."""
        return items[self.whole(0, len(items) - 1)]

    def shuffled(self, items: Sequence[_Item]) -> list[_Item]:
        """The items in random order."""
        return [item for _, item in sorted(((self._random(), number), item) for number, item in enumerate(items))]
