"""Corridors: long and straight, with crossings, dead ends, and closed doors in niches."""

from __future__ import annotations

from .dice import Dice
from .plan import Box, Plan

_SPACING = 11.0  # distance between crossings [m]
_LOOP_SHARE = 0.35  # share of redundant corridors that are kept
_NICHE_EVERY, _NICHE_DEPTH = 3.5, 0.25  # [m]


def draw_corridor(plan: Plan, dice: Dice) -> None:
    """Draws corridors along an irregular lattice. All crossings are connected, some by more than one path."""
    depth = plan.count(_NICHE_DEPTH)
    inside = plan.inside.grown(-depth)
    widths = plan.count(1.8), plan.count(2.6)
    xs = _lines(dice, inside.left, inside.right, widths, plan.count(_SPACING))
    ys = _lines(dice, inside.bottom, inside.top, widths, plan.count(_SPACING))
    for (col, row), (next_col, next_row) in _edges(dice, len(xs), len(ys)):
        hall = Box(xs[col][0], ys[row][0], xs[next_col][1], ys[next_row][1])
        plan.carve(hall)
        _niches(plan, dice, hall, along_x=row == next_row)
    plan.enclose()


def _lines(dice: Dice, low: int, high: int, widths: tuple[int, int], spacing: int) -> list[tuple[int, int]]:
    """Cells [first, end) of each lattice line across a span. The outermost lines lie at its edges."""
    count = max(2, round((high - low) / spacing) + 1)
    lines = []
    for number in range(count):
        width = dice.whole(*widths)
        slack = (high - low) // (5 * count) if 0 < number < count - 1 else 0
        first = low + (high - low - width) * number // (count - 1) + dice.whole(-slack, slack)
        lines.append((first, first + width))
    return lines


def _edges(dice: Dice, cols: int, rows: int) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Pairs of neighbouring crossings to connect, lower one first: a random spanning tree and some extra pairs."""
    pairs = [((col, row), (col + 1, row)) for col in range(cols - 1) for row in range(rows)]
    pairs += [((col, row), (col, row + 1)) for col in range(cols) for row in range(rows - 1)]
    group = {(col, row): col * rows + row for col in range(cols) for row in range(rows)}
    edges = []
    for one, other in dice.shuffled(pairs):
        if group[one] != group[other]:
            old, new = group[one], group[other]
            group = {crossing: new if number == old else number for crossing, number in group.items()}
        elif not dice.chance(_LOOP_SHARE):
            continue
        edges.append((one, other))
    return edges


def _niches(plan: Plan, dice: Dice, hall: Box, *, along_x: bool) -> None:
    """Carves door niches into both sides of a corridor, at irregular distances."""
    depth, door = plan.count(_NICHE_DEPTH), plan.count(1.0)
    low, high = (hall.left, hall.right) if along_x else (hall.bottom, hall.top)
    for side in (-1, 1):
        at = low + plan.count(3.2)
        while at + door < high - plan.count(3.2):
            if along_x:
                edge = hall.top if side > 0 else hall.bottom - depth
                plan.carve(Box(at, edge, at + door, edge + depth))
            else:
                edge = hall.right if side > 0 else hall.left - depth
                plan.carve(Box(edge, at, edge + depth, at + door))
            at += plan.count(_NICHE_EVERY * dice.between(0.6, 1.6))
