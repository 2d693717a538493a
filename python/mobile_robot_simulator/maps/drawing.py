"""Drawings: walls and areas that were read from a vector file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .cell_map import CellMap
from .raster import Raster

__all__ = ["Drawing"]

_MAX_POINTS = 5_000_000


class Drawing:
    """Walls and areas in metres, x to the right and y up."""

    def __init__(self) -> None:
        """Makes an empty drawing."""
        self._walls: list[NDArray[np.float64]] = []
        self._areas: list[tuple[list[NDArray[np.float64]], bool]] = []
        self._point_count = 0

    def add_wall(self, line: NDArray[np.float64]) -> None:
        """Adds a wall without thickness.

        Args:
            line: Polyline (N, 2) [m].

        Raises:
            ValueError: A coordinate is not finite, or the drawing has too many points.
        """
        self._check(line)
        self._walls.append(line)

    def add_area(self, rings: list[NDArray[np.float64]], *, is_even_odd: bool) -> None:
        """Adds an area; see `Raster.add_area`.

        Raises:
            ValueError: As for `add_wall`.
        """
        for ring in rings:
            self._check(ring)
        self._areas.append((rings, is_even_odd))

    def cell_map(self, path: Path, resolution: float) -> CellMap:
        """Returns the cells of the drawing.

        Args:
            path: The file, for messages.
            resolution: Side of a cell [m].

        Raises:
            ValueError: The drawing is empty, or the grid would be too large.
        """
        lines = [*self._walls, *(ring for rings, _ in self._areas for ring in rings)]
        if not lines:
            raise ValueError(f"{path}: must have a wall or an area, got none")
        low = np.min([line.min(axis=0) for line in lines], axis=0)
        high = np.max([line.max(axis=0) for line in lines], axis=0)
        try:
            raster = Raster(low.tolist(), high.tolist(), resolution)
        except ValueError as error:
            raise ValueError(f"{path}: {error}; is the unit of the drawing right?") from None
        for rings, is_even_odd in self._areas:
            raster.add_area(rings, is_even_odd=is_even_odd)
        raster.add_walls(self._walls)
        return raster.cell_map()

    def _check(self, line: NDArray[np.float64]) -> None:
        if not np.isfinite(line).all():
            raise ValueError("coordinates must be finite")
        self._point_count += len(line)
        if self._point_count > _MAX_POINTS:
            raise ValueError(f"a drawing must have at most {_MAX_POINTS} points; is its unit right?")
