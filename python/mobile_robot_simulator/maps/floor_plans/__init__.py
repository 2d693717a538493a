"""Made-up floor plans, so that tests and demonstrations need no files."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable
from operator import index

from ..._core import OccupancyGrid
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

_SMALLEST_SIDE = 8.0
_COARSEST = 0.2
_MOST_CELLS = 100_000_000


def floor_plan(
    kind: str = "office", *, seed: int = 0, size: tuple[float, float] = (40.0, 25.0), resolution: float = 0.05
) -> OccupancyGrid:
    """A floor plan of a kind: office, corridor, maze, cave or warehouse.

    All of its free cells hang together, behind a closed outer wall; what is outside is unknown. Doors are 0.9 m or
    wider, and a robot of 0.3 m radius gets to nearly all of it. The lower left corner is the origin of the map.

    size: width and height [m], each at least 8. resolution: side of a cell [m], at most 0.2.
    seed: names the plan: the same kind, seed, size and resolution give the same cells on every machine.
    raises: ValueError for an unknown kind, a negative seed, or a size or resolution out of range.
    """
    if kind not in _DRAW:
        near = difflib.get_close_matches(kind, KINDS, 1, 0.4) if isinstance(kind, str) else []
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, got {kind!r}{hint}")
    if index(seed) < 0:
        raise ValueError(f"seed must be 0 or more, got {seed}")
    try:
        width, height = map(float, size)
    except (TypeError, ValueError):
        raise ValueError(f"size must be two numbers (width, height) [m], got {size!r}") from None
    if not all(_SMALLEST_SIDE <= side < math.inf for side in (width, height)):
        raise ValueError(f"size must be at least {_SMALLEST_SIDE} x {_SMALLEST_SIDE} m, got {width} x {height}")
    if not 0.0 < resolution <= _COARSEST:
        raise ValueError(f"resolution must be above 0 and at most {_COARSEST} m, got {resolution}")
    if (width / resolution) * (height / resolution) > _MOST_CELLS:
        raise ValueError(f"a plan has at most {_MOST_CELLS} cells, {width} x {height} m at {resolution} m has more")
    plan = Plan(round(width / resolution), round(height / resolution), resolution)
    _DRAW[kind](plan, Dice(index(seed)))
    fill_unreachable(plan.cells)
    return OccupancyGrid(plan.cells, resolution=resolution)
