"""Snapshot: the saved state of a simulation."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field

import numpy as np

from .._core import OccupancyGrid
from ..bus.bus import Bus, BusSnapshot
from ..nodes.map_server import MapServer, MapServerSnapshot
from ..physics.world import World, WorldSnapshot
from .fault import FaultList, FaultSnapshot
from .kept import Kept, KeptSnapshot
from .robots import Robots, RobotsSnapshot


@dataclass(frozen=True)
class SavedParts:
    """The saved state of each part of a simulation.

    Attributes:
        grid: Copy of the map.
        bus: Time, pending messages, timers, subscriptions, latest messages and nodes.
        world: Obstacles, and the time up to which robots have moved.
        robots: The robots, with their nodes and scanners.
        faults: The faults, with their random generators.
        map_server: The map that is served, with the handles of its server.
        kept: The user's objects (`Simulation.keep`).
    """

    grid: OccupancyGrid
    bus: BusSnapshot
    world: WorldSnapshot
    robots: RobotsSnapshot
    faults: tuple[FaultSnapshot, ...]
    map_server: MapServerSnapshot
    kept: tuple[KeptSnapshot, ...]


@dataclass(frozen=True)
class Snapshot:
    """A state saved by `Simulation.save`. It can be restored any number of times, in the same simulation only.

    Attributes:
        simulation: The simulation that was saved.
        time: Simulated time at which it was saved [s].
        parts: The saved state of each part.
    """

    simulation: object = field(repr=False)
    time: float
    parts: SavedParts = field(repr=False)


@dataclass(frozen=True)
class Parts:
    """The parts of a simulation that are saved and restored together.

    Attributes:
        grid: The map.
        bus: The bus.
        world: The world that robots and obstacles move in.
        robots: The robots.
        faults: The faults.
        map_server: The node that serves the map.
        kept: The user's objects (`Simulation.keep`).
    """

    grid: OccupancyGrid
    bus: Bus
    world: World
    robots: Robots
    faults: FaultList
    map_server: MapServer
    kept: Kept

    def save(self) -> SavedParts:
        """Returns the state that `restore` takes.

        Raises:
            RuntimeError: Called from a callback.
            TypeError: An attribute of a node or of a kept object cannot be copied.
        """
        return SavedParts(
            grid=copy.copy(self.grid),  # both grids share the cells until one of them changes
            bus=self.bus.save(),
            world=self.world.save(),
            robots=self.robots.save(),
            faults=self.faults.save(),
            map_server=self.map_server.save(),
            kept=self.kept.save(),
        )

    def restore(self, saved: SavedParts) -> None:
        """Puts all parts back into a saved state.

        Raises:
            RuntimeError: Called from a callback.
        """
        self.bus.restore(saved.bus)
        if not np.array_equal(saved.grid.cells, self.grid.cells):
            self.grid.set_cells(0, 0, saved.grid.cells)
        self.robots.restore(saved.robots)
        self.world.restore(saved.world)  # must follow the robots, because the world reads their poses
        self.map_server.restore(saved.map_server)
        self.faults.restore(saved.faults)
        self.kept.restore(saved.kept)
