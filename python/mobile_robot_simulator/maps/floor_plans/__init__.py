"""Floor plans: generated maps for tests and examples that need no map files."""

from __future__ import annotations

import math
from collections.abc import Callable
from operator import index
from typing import SupportsFloat, SupportsIndex

from ..._core import OccupancyGrid
from ...quoting import nearest, quoted
from .cave import draw_cave
from .connectivity import fill_unreachable
from .corridor import draw_corridor
from .dice import Dice
from .maze import draw_maze
from .office import draw_office
from .plan import Plan
from .warehouse import draw_warehouse

__all__ = ["KINDS", "floor_plan"]

_DRAW: dict[str, Callable[[Plan, Dice], None]] = {
    "office": draw_office,
    "corridor": draw_corridor,
    "maze": draw_maze,
    "cave": draw_cave,
    "warehouse": draw_warehouse,
}

KINDS = tuple(_DRAW)
"""Kinds of floor plans."""

_MIN_SIDE = 8.0  # [m]
_MAX_RESOLUTION = 0.2  # [m]
_MAX_CELLS = 100_000_000


def floor_plan(
    kind: str = "office", *, seed: int = 0, size: tuple[float, float] = (40.0, 25.0), resolution: float = 0.05
) -> OccupancyGrid:
    """Generates a floor plan.

    All free cells are connected and surrounded by a closed outer wall. Cells outside of the wall are unknown. Doors are at
    least 0.9 m wide, and a robot with a radius of 0.3 m can reach almost all free cells. The lower-left corner of the plan
    is the origin of the map frame.

    Args:
        kind: One of `KINDS`: office, corridor, maze, cave or warehouse.
        seed: Seed of the random choices, at least 0. The same kind, seed, size and resolution give the same cells on every
            machine.
        size: Width and height [m], each at least 8.
        resolution: Side of a cell [m], at most 0.2.

    Returns:
        A grid with cells of value 0 (free), 100 (occupied) and -1 (unknown).

    Raises:
        ValueError: The kind is unknown, the seed is negative, the size or the resolution is out of range, or the plan would
            have more than 100 million cells.
        TypeError: The seed is not an integer, or the resolution is not a number.
    """
    if kind not in _DRAW:
        near = nearest(kind, KINDS)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, got {quoted(kind)}{hint}")
    if not isinstance(seed, SupportsIndex):
        raise TypeError(f"seed must be an integer, got {quoted(seed)}")
    if index(seed) < 0:
        raise ValueError(f"seed must be at least 0, got {quoted(seed)}")
    try:
        width, height = map(float, size)
    except (TypeError, ValueError):
        raise ValueError(f"size must be two numbers (width, height) [m], got {quoted(size)}") from None
    if not all(_MIN_SIDE <= side < math.inf for side in (width, height)):
        raise ValueError(f"size must be at least {_MIN_SIDE} x {_MIN_SIDE} m, got {width} x {height}")
    if not isinstance(resolution, SupportsFloat):
        raise TypeError(f"resolution must be a number [m], got {quoted(resolution)}")
    if not 0.0 < resolution <= _MAX_RESOLUTION:
        raise ValueError(f"resolution must be above 0 and at most {_MAX_RESOLUTION} m, got {quoted(resolution)}")
    if (width / resolution) * (height / resolution) > _MAX_CELLS:
        raise ValueError(f"a plan must have at most {_MAX_CELLS} cells, got more: {width} x {height} m at {resolution} m")
    plan = Plan(round(width / resolution), round(height / resolution), resolution)
    _DRAW[kind](plan, Dice(index(seed)))
    fill_unreachable(plan.cells)
    return OccupancyGrid(plan.cells, resolution=resolution)
