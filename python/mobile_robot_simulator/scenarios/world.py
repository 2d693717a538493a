"""World: everything about one drive except the controller, as plain data."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from .._core import Shape
from ..faults.reading import read_fault
from ..quoting import quoted, shortened
from ..simulation.simulation import Simulation
from .checks import to_goal, to_place
from .world_map import WorldMap

__all__ = ["MovingDisc", "World"]

Place = tuple[float, float, float]


@dataclass(frozen=True)
class MovingDisc:
    """An obstacle: a disc that stands or moves at a constant velocity, also through walls.

    Args:
        x: Position of its centre along x at the start, in the map frame [m].
        y: Position along y [m].
        radius: Radius [m].
        vx: Velocity along x of the map frame [m/s].
        vy: Velocity along y [m/s].
    """

    x: float
    y: float
    radius: float
    vx: float = 0.0
    vy: float = 0.0


@dataclass(frozen=True)
class World:
    """A map, a start, a goal, obstacles, faults and parameters: what one drive needs besides a controller.

    Args:
        map: The map.
        start: Start in the map frame: a pose, or (x, y, yaw) [m, m, rad]. It is kept as a tuple.
        goal: Goal (x, y) in the map frame [m], or None.
        obstacles: The obstacles.
        faults: Faults as texts that `--fault` takes, such as "Drop('/scan', probability=0.1)".
        parameters: Parameters of the nodes by name.
        duration: Longest duration of the drive [s].
        tolerance: The robot has arrived when its origin is at most so far from the goal [m].
        seed: Seed of the noise.

    Raises:
        ValueError: The start or the goal is not finite.
        TypeError: The start or the goal has a wrong type.

    Example:
        >>> from mobile_robot_simulator.scenarios import World, WorldMap
        >>> world = World(WorldMap("room", size=(5.0, 4.0)), start=(1.0, 2.0, 0.0), faults=("Blackout('/scan', start=3.0)",))
        >>> world.things, World.from_json(world.to_json()) == world
        (1, True)
        >>> world.simulation()
        Simulation(at 0 s, 1 robot at (1.00, 2.00, 0.00), map 100x80 cells)
    """

    map: WorldMap
    start: Place
    goal: tuple[float, float] | None = None
    obstacles: tuple[MovingDisc, ...] = ()
    faults: tuple[str, ...] = ()
    parameters: Mapping[str, Any] = field(default_factory=dict)
    duration: float = 30.0
    tolerance: float = 0.3
    seed: int = 0

    def __post_init__(self) -> None:
        """Converts start and goal to tuples of numbers."""
        object.__setattr__(self, "start", to_place(self.start))
        if self.goal is not None:
            object.__setattr__(self, "goal", to_goal(self.goal))

    @property
    def things(self) -> int:
        """Number of obstacles and faults."""
        return len(self.obstacles) + len(self.faults)

    @property
    def name(self) -> str:
        """Name made of the contents: equal worlds have equal names."""
        return hashlib.sha256(self.to_json().encode()).hexdigest()[:10]

    def simulation(self) -> Simulation:
        """Returns a simulation at the start of the drive.

        Raises:
            ValueError: A parameter or a fault is invalid, or the robot starts inside a wall.
            OSError: The map file cannot be read.
        """
        sim = Simulation(self.map.grid(), parameters=self.parameters, seed=self.seed, start=self.start)
        sim.goal = self.goal
        for disc in self.obstacles:
            place = (disc.x, disc.y, 0.0)
            end = (disc.x + disc.vx * self.duration, disc.y + disc.vy * self.duration, 0.0)
            stands = place == end or not self.duration > 0.0
            sim.add_obstacle(Shape.disc(disc.radius), place if stands else [(0.0, *place), (self.duration, *end)])
        for text in self.faults:
            sim.add_fault(read_fault(text))
        return sim

    def to_json(self) -> str:
        """Returns the world as a JSON text, from which `from_json` makes an equal world."""
        return json.dumps(asdict(self), indent=2, allow_nan=False, default=_as_json) + "\n"

    @staticmethod
    def from_json(text: str) -> World:
        """Returns the world of a JSON text.

        Args:
            text: The text.

        Raises:
            ValueError: It is not the text of a world.
        """
        try:
            values = json.loads(text)
            numbers = [*values["start"], *(values["goal"] or ()), values["duration"], values["tolerance"]]
            world = World(
                map=WorldMap(**{**values["map"], "size": tuple(values["map"]["size"])}),
                start=tuple(values["start"]),
                goal=None if values["goal"] is None else tuple(values["goal"]),
                obstacles=tuple(MovingDisc(**disc) for disc in values["obstacles"]),
                faults=tuple(values["faults"]),
                parameters=dict(values["parameters"]),
                duration=values["duration"],
                tolerance=values["tolerance"],
                seed=values["seed"],
            )
            if not all(math.isfinite(number) for number in numbers):
                raise ValueError("numbers must be finite")
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
            raise ValueError(f"not a world: {shortened(error)}, got {quoted(text)}") from None
        return world


def _as_json(value: object) -> Any:
    """Returns a number or an array of NumPy as JSON has it."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"parameters of a world must be numbers, texts or sequences of them, got {quoted(value)}")
