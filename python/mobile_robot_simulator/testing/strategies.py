"""Strategies of Hypothesis for worlds, poses, faults and disturbances, for tests with `@given`.

Example:
    >>> from hypothesis import given, settings
    >>> from mobile_robot_simulator.scenarios import Moving, Space
    >>> from mobile_robot_simulator.testing import worlds
    >>> @settings(max_examples=5)
    ... @given(worlds(Space(obstacles=Moving(3))))
    ... def test_the_robot_does_not_start_in_an_obstacle(world):
    ...     assert world.simulation().truth.clearance > 0.0
    >>> test_the_robot_does_not_start_in_an_obstacle()
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

try:
    from hypothesis import strategies as st
except ImportError as error:
    raise ImportError("these strategies need Hypothesis: pip install hypothesis") from error

from ..faults.reading import read_fault
from ..scenarios.disturbances import Disturbance
from ..scenarios.ranges import DIGITS, FaultRange, Free, Range
from ..scenarios.space import Space
from ..scenarios.world import World
from ..scenarios.world_map import Places, WorldMap
from ..simulation.fault import Fault

__all__ = ["disturbances", "faults", "poses", "worlds"]

T = TypeVar("T")


def worlds(space: Space) -> st.SearchStrategy[World]:
    """Returns a strategy for the worlds of a space.

    It shrinks towards the first map, the first place, no obstacles and no faults, and numbers near 0.

    Args:
        space: The space.
    """
    return st.composite(lambda draw: space.choose(_Drawn(draw)))()


def poses(map: WorldMap | None = None, free: Free | None = None) -> st.SearchStrategy[tuple[float, float, float]]:
    """Returns a strategy for poses (x, y, yaw) [m, m, rad] in free space. It shrinks towards the lower left and yaw 0.

    Args:
        map: The map; default: an empty room.
        free: Radius of the free space and range of the yaw.

    Raises:
        ValueError: There is no such place on the map.
    """
    limits = free or Free()
    places = (map or WorldMap()).places(limits.radius)
    return st.tuples(st.sampled_from(places), _numbers(limits.yaw)).map(lambda pair: (*pair[0], pair[1]))


def faults(*ranges: FaultRange) -> st.SearchStrategy[list[Fault]]:
    """Returns a strategy for lists of faults, new ones for each example. It shrinks towards no faults.

    Args:
        *ranges: The faults to choose from. Each is in the list once or not at all.
    """
    space = Space(start=(2.0, 2.0, 0.0), goal=None, faults=ranges, is_noisy=False)
    return worlds(space).map(lambda world: [read_fault(text) for text in world.faults])


def disturbances(*kinds: Disturbance, duration: float = 30.0) -> st.SearchStrategy[list[Fault]]:
    """Returns a strategy for lists of disturbances as faults, new ones for each example.

    It shrinks towards fewer, shorter and weaker ones.

    Args:
        *kinds: The disturbances to choose from: `scenarios.Pushes`, `Slips`, `Drift`.
        duration: Longest duration of the drive [s].
    """
    space = Space(start=(2.0, 2.0, 0.0), goal=None, disturbances=kinds, duration=duration)
    return worlds(space).map(lambda world: [read_fault(text) for text in world.faults])


def _numbers(limits: Range) -> st.SearchStrategy[float]:
    """Numbers with few digits. Integers shrink towards 0 or the limit nearest to it, floats do not always."""
    scale = 10**DIGITS
    low, high = math.ceil(limits.low * scale - 1e-6), math.floor(limits.high * scale + 1e-6)
    return st.just(limits.low) if low >= high else st.integers(low, high).map(lambda number: number / scale)


class _Drawn:
    """Choices that Hypothesis draws."""

    def __init__(self, draw: Any) -> None:
        self._draw = draw

    def number(self, name: str, limits: Range) -> float:
        return self._draw(_numbers(limits))  # type: ignore[no-any-return]

    def index(self, name: str, count: int) -> int:
        return self._draw(st.integers(0, count - 1))  # type: ignore[no-any-return]

    def happens(self, name: str, chance: float) -> bool:
        return chance > 0.0 and (chance == 1.0 or self._draw(st.booleans()))

    def place(self, name: str, places: Places) -> tuple[float, float]:
        return self._draw(st.sampled_from(places))  # type: ignore[no-any-return]

    def several(self, name: str, at_least: int, at_most: int, make: Callable[[int], T]) -> list[T]:
        # `make` draws through this object, and `lists` deletes elements with everything that they drew.
        element = st.builds(make, st.just(0))
        return self._draw(st.lists(element, min_size=at_least, max_size=at_most))  # type: ignore[no-any-return]
