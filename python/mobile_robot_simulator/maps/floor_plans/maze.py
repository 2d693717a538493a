"""Mazes: one lane to every place, and a few short cuts."""

from __future__ import annotations

from .dice import Dice
from .plan import Box, Plan

_LANE = 1.5  # [m]
_SHORT_CUTS = 0.06


def draw_maze(plan: Plan, dice: Dice) -> None:
    """Carve a maze by recursive backtracking."""
    inside, wall = plan.inside, plan.wall
    plan.block(inside.grown(plan.outer_wall))
    cols = (inside.width + wall) // (plan.count(_LANE) + wall)
    rows = (inside.height + wall) // (plan.count(_LANE) + wall)
    lefts = [inside.left + (inside.width + wall) * col // cols for col in range(cols + 1)]
    bottoms = [inside.bottom + (inside.height + wall) * row // rows for row in range(rows + 1)]

    def place(col: int, row: int) -> Box:
        return Box(lefts[col], bottoms[row], lefts[col + 1] - wall, bottoms[row + 1] - wall)

    def join(one: tuple[int, int], other: tuple[int, int]) -> None:
        low, high = place(*min(one, other)), place(*max(one, other))
        plan.carve(Box(low.left, low.bottom, high.right, high.top))

    been = {(0, 0)}
    trail = [(0, 0)]
    while trail:
        col, row = trail[-1]
        ways = [
            way
            for way in ((col + 1, row), (col, row + 1), (col - 1, row), (col, row - 1))
            if 0 <= way[0] < cols and 0 <= way[1] < rows and way not in been
        ]
        if not ways:
            trail.pop()
            continue
        way = dice.one_of(ways)
        join((col, row), way)
        been.add(way)
        trail.append(way)
    for col in range(cols - 1):
        for row in range(rows - 1):
            if dice.chance(_SHORT_CUTS):
                join((col, row), dice.one_of([(col + 1, row), (col, row + 1)]))
