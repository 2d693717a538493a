"""WorldMap: the map of a world, as plain data."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from .._core import OccupancyGrid
from ..maps import load_map
from ..maps.floor_plans import KINDS, floor_plan

__all__ = ["ROOM", "WorldMap", "floor_plans"]

ROOM = "room"
"""Kind of an empty rectangle with a wall around it: the plainest map."""

SPACING = 0.25
"""Distance between two places of the lattice [m]."""

Places = tuple[tuple[float, float], ...]
"""Positions (x, y) in the map frame [m], ordered by x, then by y."""


@dataclass(frozen=True)
class WorldMap:
    """The map of a world: an empty room, a generated floor plan, or a map file.

    Args:
        kind: "room", a kind of `floor_plan`, or the path of a map file, absolute or relative to the working directory.
        seed: Seed of a floor plan.
        size: Width and height of a room or a floor plan [m].
        resolution: Side of a cell of a room or a floor plan [m].
    """

    kind: str = ROOM
    seed: int = 0
    size: tuple[float, float] = (12.0, 9.0)
    resolution: float = 0.05

    @property
    def is_generated(self) -> bool:
        """True if the map is not a file."""
        return self.kind == ROOM or self.kind in KINDS

    def in_folder(self, folder: Path) -> WorldMap:
        """Returns this map as a file in a folder names it: the path of a map file becomes relative to the folder.

        Args:
            folder: The folder.
        """
        if self.is_generated:
            return self
        path = _absolute(self.kind)
        try:
            path = os.path.relpath(path, os.path.realpath(folder))
        except ValueError:  # Another drive of Windows.
            pass
        return replace(self, kind=Path(path).as_posix())

    def from_folder(self, folder: Path) -> WorldMap:
        """Returns the map that a file in a folder names: a relative path of a map file is relative to the folder.

        Args:
            folder: The folder.
        """
        return self if self.is_generated else replace(self, kind=_absolute(folder / self.kind))

    def grid(self) -> OccupancyGrid:
        """Returns the grid. It is shared by all callers, so do not change its cells.

        Raises:
            OSError: The file cannot be read.
            ValueError: `floor_plan` refuses an argument, or the file is malformed.
        """
        # The working directory may change, and another file have the same relative path then.
        return _grid(self.from_folder(Path()))

    def places(self, radius: float) -> Places:
        """Returns the places of a lattice, 0.25 m wide, where a disc fits into known free space.

        Args:
            radius: Radius of the disc [m].

        Raises:
            ValueError: There is no such place.
        """
        return _places(self.from_folder(Path()), radius)


def floor_plans(
    *kinds: str, seeds: Iterable[int] = range(10), size: tuple[float, float] = (12.0, 9.0), resolution: float = 0.05
) -> tuple[WorldMap, ...]:
    """Returns the maps of several kinds and seeds, for `Space`.

    Args:
        *kinds: Kinds of `floor_plan`; default: all.
        seeds: Seeds of each kind.
        size: Width and height [m].
        resolution: Side of a cell [m].
    """
    return tuple(WorldMap(kind, seed, size, resolution) for kind in kinds or KINDS for seed in seeds)


def _absolute(file: str | Path) -> str:
    """Returns an absolute path without links to folders, so that ".." means the folder above. The file can be a link."""
    folder, name = os.path.split(file)
    return os.path.join(os.path.realpath(folder), name)


@lru_cache(maxsize=256)
def _grid(map: WorldMap) -> OccupancyGrid:
    if not map.is_generated:
        return load_map(Path(map.kind))
    if map.kind != ROOM:
        return floor_plan(map.kind, seed=map.seed, size=map.size, resolution=map.resolution)
    # The checks of sizes are those of floor plans, which need at least 8 m; a room may be smaller.
    width, height = (round(side / map.resolution) for side in map.size)
    if min(width, height) < 3 or width * height > 100_000_000:
        raise ValueError(f"a room must have 3 x 3 to 100 million cells, got {width} x {height}")
    cells = np.zeros((height, width), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return OccupancyGrid(cells, resolution=map.resolution)


@lru_cache(maxsize=1024)
def _places(map: WorldMap, radius: float) -> Places:
    grid = map.grid()
    cells, (rows, cols), side = grid.cells, grid.shape, grid.resolution
    origin = grid.origin
    corners = [origin * type(origin)(x, y) for x in (0.0, cols * side) for y in (0.0, rows * side)]
    steps = [
        range(int(min(values) // SPACING), int(max(values) // SPACING) + 1)
        for values in ([corner.x for corner in corners], [corner.y for corner in corners])
    ]
    places = []
    for x in (SPACING * step for step in steps[0]):
        for y in (SPACING * step for step in steps[1]):
            cell = grid.cell_at(x, y)
            if cell is not None and 0 <= cells[cell] < grid.occupied_threshold and grid.is_free_disc(x, y, radius):
                places.append((x, y))
    if not places:
        raise ValueError(f"{map} must have a place for a disc of {radius:g} m, it has none")
    return tuple(places)
