"""Space: the worlds that a search or a test may choose from."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any, Protocol, TypeVar

from ..physics.obstacles import PoseLike
from ..quoting import quoted
from ..scanners import check_robot_names
from ..simulation.arguments import check_at_least_0
from .checks import check_kinds, items_of, to_goal, to_place
from .disturbances import Disturbance, Drift
from .ranges import DIGITS, Dimension, FaultRange, Free, Moving, Range
from .world import MovingDisc, Place, World
from .world_map import Places, WorldMap

__all__ = ["Choices", "Space"]

T = TypeVar("T")

ANYWHERE = Free()

SEEDS = 1000
"""Number of seeds of the noise."""


class Choices(Protocol):
    """Where the numbers of a world come from: a point of a unit cube, or a strategy of Hypothesis."""

    def number(self, name: str, limits: Range) -> float:
        """Returns a number in a range, rounded."""

    def index(self, name: str, count: int) -> int:
        """Returns an index, 0 to count - 1."""

    def happens(self, name: str, chance: float) -> bool:
        """Returns True with a probability."""

    def place(self, name: str, places: Places) -> tuple[float, float]:
        """Returns one of the places [m]."""

    def several(self, name: str, at_least: int, at_most: int, make: Callable[[int], T]) -> list[T]:
        """Returns several things, each made by a function of its index."""


@dataclass(frozen=True)
class Space:
    """A set of worlds: what may differ between them, with units.

    Args:
        maps: The maps to choose from; see `floor_plans`.
        start: A pose, or (x, y, yaw) [m, m, rad], or `Free` for any.
        goal: A position (x, y) [m], `Free` for any, or None.
        obstacles: The obstacles, or None.
        faults: Faults that a world can have.
        disturbances: What the world can do to the robot while it drives: `Pushes`, `Slips`, `Drift`. They are among the
            `faults` of a world, after the others.
        parameters: Parameters of the nodes by name. Each is a value, or a `Range` of values.
        duration: Longest duration of a drive [s].
        tolerance: Distance from the goal at which the robot has arrived [m].
        is_noisy: False if all worlds have the noise of seed 0; else they have 1,000 different seeds.

    Raises:
        ValueError: There is no map, a parameter is unknown, the start or the goal is not finite, or the duration is not
            positive and finite.
        TypeError: An argument has a wrong type.

    Example:
        >>> from mobile_robot_simulator.scenarios import Free, Moving, Range, Space, WorldMap
        >>> room = WorldMap("room", size=(6.0, 5.0))
        >>> space = Space([room], start=(1.0, 1.0, 0.0), goal=(5.0, 4.0), obstacles=Moving(1), is_noisy=False)
        >>> [dimension.name for dimension in space.dimensions]
        ['obstacles', 'obstacle 1 x', 'obstacle 1 y', 'obstacle 1 radius']
        >>> space.dimensions[3]
        Dimension(name='obstacle 1 radius', low=0.1, high=0.3, unit='m')
        >>> space.world([0.9, 0.5, 0.5, 0.0]).obstacles
        (MovingDisc(x=3.0, y=2.5, radius=0.1, vx=0.0, vy=0.0),)
    """

    maps: Sequence[WorldMap] = (WorldMap(),)
    start: PoseLike | Free = ANYWHERE
    goal: tuple[float, float] | Free | None = ANYWHERE
    obstacles: Moving | None = None
    faults: Sequence[FaultRange] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    duration: float = 30.0
    tolerance: float = 0.3
    is_noisy: bool = True
    disturbances: Sequence[Disturbance] = ()

    def __post_init__(self) -> None:
        """Checks the arguments, and converts start and goal to tuples."""
        set_field = partial(object.__setattr__, self)
        set_field("maps", items_of("maps", "scenarios.WorldMap", WorldMap, self.maps))
        if not self.maps:
            raise ValueError("maps must be one or more of scenarios.WorldMap, got none")
        if not isinstance(self.start, Free):
            set_field("start", to_place(self.start))
        if not isinstance(self.goal, Free | None):
            set_field("goal", to_goal(self.goal))
        check_kinds("a scenarios.Moving or None", Moving | None, obstacles=self.obstacles)
        set_field("faults", items_of("faults", "scenarios.FaultRange", FaultRange, self.faults))
        set_field(
            "disturbances", items_of("disturbances", "scenarios.Pushes, Slips or Drift", Disturbance, self.disturbances)
        )
        drifts = [number for number, each in enumerate(self.disturbances) if isinstance(each, Drift)]
        if len(drifts) > 1:
            raise ValueError(f"disturbances must have at most one scenarios.Drift, got {len(drifts)}")
        check_kinds("a mapping from names to values", Mapping, parameters=self.parameters)
        check_robot_names(self.parameters)
        check_at_least_0(duration=self.duration, tolerance=self.tolerance)
        if not self.duration:
            raise ValueError(f"duration must be positive, got {quoted(self.duration)} s")
        check_kinds("True or False", bool, is_noisy=self.is_noisy)

    @cached_property
    def dimensions(self) -> tuple[Dimension, ...]:
        """The numbers that are drawn for each world, in the order of the coordinates of `world`.

        Positions have two coordinates, 0 to 1: the share of free places at smaller x, and at that x of those at smaller y.
        """
        listing = _Listing()
        self.choose(listing)
        return tuple(listing.dimensions)

    def world(self, point: Sequence[float]) -> World:
        """Returns the world at a point of the unit cube.

        Args:
            point: As many numbers as there are `dimensions`, each 0 to 1.

        Raises:
            ValueError: A number is out of range, or there are more or fewer.
        """
        if len(point) != len(self.dimensions) or not all(0.0 <= share <= 1.0 for share in point):
            raise ValueError(f"a point must be {len(self.dimensions)} numbers in 0..1, got {quoted(list(point))}")
        return self.choose(_Point(point))

    def choose(self, choices: Choices) -> World:
        """Returns a world whose numbers come from somewhere.

        Args:
            choices: Where they come from.
        """
        map = self.maps[choices.index("map", len(self.maps))]
        start = to_place(self.start) if not isinstance(self.start, Free) else _pose(choices, map, self.start)
        goal = self.goal if not isinstance(self.goal, Free) else choices.place("goal", map.places(self.goal.radius))
        return World(
            map,
            start,
            goal,
            obstacles=self._obstacles(choices, map, start),
            faults=(
                *(
                    text
                    for number, fault in enumerate(self.faults, 1)
                    if (text := _fault(choices, number, fault)) is not None
                ),
                *(
                    text
                    for number, each in enumerate(self.disturbances, 1)
                    for text in self._disturbed(choices, number, each)
                ),
            ),
            parameters={
                name: choices.number(name, value) if isinstance(value, Range) else value
                for name, value in self.parameters.items()
            },
            duration=self.duration,
            tolerance=self.tolerance,
            seed=choices.index("seed", SEEDS) if self.is_noisy else 0,
        )

    def _disturbed(self, choices: Choices, number: int, disturbance: Disturbance) -> list[str]:
        """Returns the faults of a world that are disturbances of one kind."""
        limits = self._disturbance_ranges[number - 1]
        kind = f"disturbance {number} {limits.kind}"

        def make(index: int) -> str:
            name = f"{kind} {index + 1}"
            seeded = limits
            if disturbance.is_seeded and self.is_noisy:
                seeded = disturbance.fault(self.duration, choices.index(f"{name} seed", SEEDS))
            return seeded.text(lambda key, limits: choices.number(f"{name} {key}", limits))

        return choices.several(kind, disturbance.at_least, disturbance.at_most, make)

    @cached_property
    def _disturbance_ranges(self) -> tuple[FaultRange, ...]:
        return tuple(each.fault(self.duration) for each in self.disturbances)

    def _obstacles(self, choices: Choices, map: WorldMap, start: Place) -> tuple[MovingDisc, ...]:
        if self.obstacles is None:
            return ()
        limits = self.obstacles
        places = map.places(0.0)

        def make(number: int) -> MovingDisc:
            name = f"obstacle {number + 1}"
            x, y = choices.place(name, places)
            radius = choices.number(f"{name} radius", limits.radius)
            if limits.speed.high == 0.0:
                return MovingDisc(x, y, radius)
            speed = choices.number(f"{name} speed", limits.speed)
            direction = choices.number(f"{name} direction", ANYWHERE.yaw)
            vx, vy = (round(speed * part(direction), DIGITS) for part in (math.cos, math.sin))
            return MovingDisc(x, y, radius, vx, vy)

        discs = choices.several("obstacles", limits.at_least, limits.at_most, make)
        return tuple(
            disc
            for disc in discs
            if math.hypot(disc.x - start[0], disc.y - start[1]) >= disc.radius + self.obstacles.from_start
        )


def _pose(choices: Choices, map: WorldMap, free: Free) -> Place:
    x, y = choices.place("start", map.places(free.radius))
    return x, y, choices.number("start yaw", free.yaw)


def _fault(choices: Choices, number: int, fault: FaultRange) -> str | None:
    """Returns the text of a fault, or None if the world does not have it. All numbers are drawn in either case."""
    name = f"fault {number} {fault.kind}"
    happens = choices.happens(name, fault.chance)
    text = fault.text(lambda key, limits: choices.number(f"{name} {key}", limits))
    return text if happens else None


class _Point:
    """Choices that are the coordinates of a point of the unit cube, one after another."""

    def __init__(self, point: Sequence[float]) -> None:
        self._shares = iter([float(share) for share in point])

    def number(self, name: str, limits: Range) -> float:
        if limits.low == limits.high:
            return limits.low
        return min(max(round(limits.low + next(self._shares) * (limits.high - limits.low), DIGITS), limits.low), limits.high)

    def index(self, name: str, count: int) -> int:
        return 0 if count == 1 else min(int(next(self._shares) * count), count - 1)

    def happens(self, name: str, chance: float) -> bool:
        return chance == 1.0 or next(self._shares) >= 1.0 - chance

    def place(self, name: str, places: Places) -> tuple[float, float]:
        # The places are ordered by x, so a share of them is also a share of the columns, each with its weight.
        x = places[min(int(next(self._shares) * len(places)), len(places) - 1)][0]
        first, after = bisect_left(places, (x, -math.inf)), bisect_right(places, (x, math.inf))
        return places[first + min(int(next(self._shares) * (after - first)), after - first - 1)]

    def several(self, name: str, at_least: int, at_most: int, make: Callable[[int], T]) -> list[T]:
        count = at_least + self.index(name, at_most - at_least + 1)
        # All are made, so that each coordinate always has the same meaning.
        return [make(number) for number in range(at_most)][:count]


class _Listing:
    """Choices that take the smallest of everything, and list what was asked for."""

    def __init__(self) -> None:
        self.dimensions: list[Dimension] = []

    def number(self, name: str, limits: Range) -> float:
        if limits.low < limits.high:
            self.dimensions.append(Dimension(name, limits.low, limits.high, limits.unit))
        return limits.low

    def index(self, name: str, count: int) -> int:
        if count > 1:
            self.dimensions.append(Dimension(name, 0, count - 1, ""))
        return 0

    def happens(self, name: str, chance: float) -> bool:
        if chance < 1.0:
            self.dimensions.append(Dimension(name, 0.0, 1.0, ""))
        return False

    def place(self, name: str, places: Places) -> tuple[float, float]:
        self.dimensions += [Dimension(f"{name} {axis}", 0.0, 1.0, "") for axis in "xy"]
        return places[0]

    def several(self, name: str, at_least: int, at_most: int, make: Callable[[int], T]) -> list[T]:
        if at_least < at_most:
            self.dimensions.append(Dimension(name, at_least, at_most, ""))
        return [make(number) for number in range(at_most)][:at_least]
