"""Random choices that come out the same on every machine and version of Python."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import TypeVar

_Item = TypeVar("_Item")


class Dice:
    """Choices from a seed, by `random.Random.random` alone: of that module, only its sequence is promised to stay."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed).random

    def between(self, low: float, high: float) -> float:
        """A number from low to high."""
        return low + (high - low) * self._random()

    def whole(self, low: int, high: int) -> int:
        """A whole number from low to high, both included; low if high is less."""
        return low + int(self._random() * max(1, high - low + 1))

    def chance(self, share: float) -> bool:
        """Whether something happens that happens in this share of cases."""
        return self._random() < share

    def one_of(self, items: Sequence[_Item]) -> _Item:
        """One of some items."""
        return items[self.whole(0, len(items) - 1)]

    def shuffled(self, items: Sequence[_Item]) -> list[_Item]:
        """The items in another order."""
        return [item for _, item in sorted(((self._random(), number), item) for number, item in enumerate(items))]
