"""Mazes: lanes that form a tree, plus a few extra openings that form loops."""

from __future__ import annotations

from .dice import Dice
from .plan import Box, Plan

_LANE = 1.5  # width of a lane [m]
_OPENING_SHARE = 0.06  # share of lattice squares with an extra opening to a neighbour


def draw_maze(plan: Plan, dice: Dice) -> None:
    """Draws a maze on a square lattice by recursive backtracking."""
    inside, wall = plan.inside, plan.wall
    plan.block(inside.grown(plan.outer_wall))
    cols = (inside.width + wall) // (plan.count(_LANE) + wall)
    rows = (inside.height + wall) // (plan.count(_LANE) + wall)
    lefts = [inside.left + (inside.width + wall) * col // cols for col in range(cols + 1)]
    bottoms = [inside.bottom + (inside.height + wall) * row // rows for row in range(rows + 1)]

    def square(col: int, row: int) -> Box:
        return Box(lefts[col], bottoms[row], lefts[col + 1] - wall, bottoms[row + 1] - wall)

    def join(one: tuple[int, int], other: tuple[int, int]) -> None:
        low, high = square(*min(one, other)), square(*max(one, other))
        plan.carve(Box(low.left, low.bottom, high.right, high.top))

    visited = {(0, 0)}
    trail = [(0, 0)]
    while trail:
        col, row = trail[-1]
        neighbours = [
            neighbour
            for neighbour in ((col + 1, row), (col, row + 1), (col - 1, row), (col, row - 1))
            if 0 <= neighbour[0] < cols and 0 <= neighbour[1] < rows and neighbour not in visited
        ]
        if not neighbours:
            trail.pop()
            continue
        neighbour = dice.one_of(neighbours)
        join((col, row), neighbour)
        visited.add(neighbour)
        trail.append(neighbour)
    for col in range(cols - 1):
        for row in range(rows - 1):
            if dice.chance(_OPENING_SHARE):
                join((col, row), dice.one_of([(col + 1, row), (col, row + 1)]))
