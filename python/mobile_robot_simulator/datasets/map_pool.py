"""Maps of a data set: which there are, in which split each is, and the grids themselves."""

from __future__ import annotations

import glob
import hashlib
import json
import os
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._core import OccupancyGrid
from ..maps import floor_plan, load_map
from ..quoting import quoted
from .plan import Maps, Plan

__all__ = ["MapPool", "MapSource", "digest_of", "sources_by_split"]

KEPT = 64
"""Number of grids that stay in memory."""


@dataclass(frozen=True)
class MapSource:
    """A map: a file, or a floor plan to generate."""

    name: str
    """Name in the provenance: the file relative to the plan, or the kind, seed and size of a floor plan."""

    path: Path | None
    """The file; None for a floor plan."""

    seed: int
    """Seed of the floor plan."""

    entry: Maps
    """The entry of the plan."""

    digest: str
    """Digest of a map file's grid. Empty for a floor plan, whose name says all."""

    def load(self) -> OccupancyGrid:
        """Returns the grid.

        Raises:
            OSError: The file cannot be read.
            ValueError: The file is not a map, or not the one that it was.
        """
        if self.path is None:
            kind, side = self.entry.floor_plan or "", self.entry.resolution or 0.05
            grid = floor_plan(kind, seed=self.seed, size=self.entry.size, resolution=side)
            return OccupancyGrid(grid.cells, resolution=side, unknown=self.entry.unknown)
        grid = load_map(self.path, unknown=self.entry.unknown, resolution=self.entry.resolution)
        if self.digest and digest_of(grid) != self.digest:
            raise ValueError(f"{self.path}: the map has changed since the data set was begun")
        return grid


def digest_of(grid: OccupancyGrid) -> str:
    """Returns the SHA-256 of a grid: of its cells, of its numbers as JSON has them, and of its materials if it has some."""
    numbers = [*grid.shape, grid.resolution, *grid.origin, grid.occupied_threshold, grid.unknown]
    data = json.dumps(numbers).encode() + grid.cells.tobytes()
    if (materials := grid.materials) is not None:
        data += repr(grid.material_table).encode() + materials.tobytes()
    return hashlib.sha256(data).hexdigest()


def sources_by_split(plan: Plan) -> dict[str, list[MapSource]]:
    """Returns the maps of each split. Equal maps are in the same split, and no map is in two.

    The maps are in an order that the seed decides. Each split gets its share of them, and at least one.

    Raises:
        OSError: A file cannot be read.
        ValueError: No file has a name, a file is not a map, or there are fewer maps than splits.
    """
    # Files with equal grids are one map.
    by_key = {source.digest or source.name: source for source in reversed(_sources(plan))}
    ordered = sorted(by_key, key=lambda key: hashlib.sha256(f"{plan.seed}/{key}".encode()).digest())
    if len(ordered) < len(plan.splits):
        given = f"got {len(ordered)} for {', '.join(plan.splits)}"
        raise ValueError(f"there must be at least one map for each split, because no map is in two; {given}")
    sizes = shares(len(ordered), list(plan.splits.values()), least=1)
    result, first = {}, 0
    for name, size in zip(plan.splits, sizes, strict=True):
        result[name] = [by_key[key] for key in ordered[first : first + size]]
        first += size
    return result


def shares(total: int, weights: Sequence[float], *, least: int = 0) -> list[int]:
    """Returns whole shares of a number in proportion to weights, by the largest remainders.

    Args:
        total: The number.
        weights: Positive weights.
        least: Smallest share.
    """
    wanted = [total * weight / sum(weights) for weight in weights]
    sizes = [max(least, int(share)) for share in wanted]
    while sum(sizes) < total:
        index = max(range(len(sizes)), key=lambda index: wanted[index] - sizes[index])
        sizes[index] += 1
    while sum(sizes) > total:
        index = max(range(len(sizes)), key=lambda index: (sizes[index] > least, sizes[index] - wanted[index]))
        sizes[index] -= 1
    return sizes


def _sources(plan: Plan) -> list[MapSource]:
    found = []
    for entry in plan.maps:
        for pattern in entry.files:
            paths = sorted(glob.glob(os.path.join(glob.escape(str(plan.folder)), pattern), recursive=True))
            if not paths:
                raise FileNotFoundError(2, f"no map file of this name for {quoted(pattern)} of the plan", str(plan.folder))
            for path in map(Path, paths):
                name = Path(os.path.relpath(path, plan.folder)).as_posix()
                try:
                    digest = digest_of(load_map(path, unknown=entry.unknown, resolution=entry.resolution))
                except ValueError as error:
                    raise ValueError(f"maps: {name}, which is named by {quoted(pattern)}, is not a map: {error}") from error
                found.append(MapSource(name, path, 0, entry, digest))
        if entry.floor_plan is not None:
            (first, last), (width, height) = entry.seeds, entry.size
            shape = f"{width:g} x {height:g} m, cells of {entry.resolution or 0.05:g} m, unknown cells {entry.unknown}"
            found += [
                MapSource(f"{entry.floor_plan} {seed}, {shape}", None, seed, entry, "") for seed in range(first, last + 1)
            ]
    return found


class MapPool:
    """Grids that stay in memory while they are used, for several threads.

    Forked processes share the grids that are there. A process that gets a pool by pickle loads its grids itself.

    Args:
        kept: Number of grids that stay; the one that was not used for longest goes first.
    """

    def __init__(self, kept: int = KEPT) -> None:
        self._kept = kept
        self._grids: OrderedDict[MapSource, tuple[OccupancyGrid, str]] = OrderedDict()
        self._make_locks()

    def __reduce__(self) -> tuple[Any, ...]:
        return MapPool, (self._kept,)

    def _make_locks(self) -> None:
        self._process = os.getpid()
        self._lock = threading.Lock()
        self._loading: dict[MapSource, threading.Lock] = {}

    def grid(self, source: MapSource) -> tuple[OccupancyGrid, str]:
        """Returns the grid of a map, and its digest. Several threads that ask for a map load it once.

        Raises:
            OSError: The file cannot be read.
            ValueError: The file is not a map, or has changed.
        """
        if self._process != os.getpid():
            self._make_locks()  # A thread of the parent may have held them during the fork.
        with self._lock:
            loading = self._loading.setdefault(source, threading.Lock())
        with loading:
            with self._lock:
                if source in self._grids:
                    self._grids.move_to_end(source)
                    return self._grids[source]
            grid = source.load()
            found = grid, source.digest or digest_of(grid)
            with self._lock:
                self._grids[source] = found
                while len(self._grids) > self._kept:
                    gone, _ = self._grids.popitem(last=False)
                    self._loading.pop(gone, None)
        return found
