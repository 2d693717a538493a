"""Caves: halls that water has left, with tunnels between them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .connectivity import label
from .dice import Dice
from .plan import FREE, Plan

_GRAIN = 0.4  # side of the cells in which the cave grows [m]
_ROCK = 0.46
_AGES = 6
_SMALLEST_HALL = 40  # grains; what is smaller fills up


def draw_cave(plan: Plan, dice: Dice) -> None:
    """Grow a cave by a cellular automaton, coarsely, then smooth its walls."""
    inside = plan.inside
    grain = plan.count(_GRAIN)
    shape = (-(-inside.height // grain), -(-inside.width // grain))
    open_ = np.array([dice.between(0.0, 1.0) >= _ROCK for _ in range(shape[0] * shape[1])]).reshape(shape)
    for age in range(_AGES):
        around = _sums(open_, 1)
        # At first, rock in the open too, so that no hall grows too wide.
        pillars = _sums(open_, 2) >= 24 if age < 2 else np.zeros(shape, bool)
        open_ = (around >= 5) & ~pillars
    open_ = _sums(_sums(open_, 1) == 9, 1) > 0
    _join(open_, dice)
    fine = open_.repeat(grain, axis=0).repeat(grain, axis=1)[: inside.height, : inside.width]
    smooth = 2 * _sums(fine, grain) > (2 * grain + 1) ** 2
    plan.cells[inside.bottom : inside.top, inside.left : inside.right][smooth] = FREE
    plan.enclose()


def _sums(cells: NDArray[np.bool_], reach: int) -> NDArray[np.int32]:
    """How many cells are set in the square of cells up to so far from each; off the sheet none are."""
    sums = np.pad(cells, ((reach + 1, reach), (reach + 1, reach))).cumsum(0, np.int32).cumsum(1, np.int32)
    side = 2 * reach + 1
    inside: NDArray[np.int32] = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    return inside


def _join(open_: NDArray[np.bool_], dice: Dice) -> None:
    """Fill up small halls, in place, and drive a tunnel from each of the others to the one nearest to it, and so on."""
    numbers = label(open_)
    sizes = np.bincount(numbers.ravel())
    halls = [number for number in range(1, len(sizes)) if sizes[number] >= _SMALLEST_HALL]
    open_ &= np.isin(numbers, halls)
    places = {number: np.argwhere(numbers == number)[::3] for number in halls}
    joined = places.pop(max(halls, key=lambda number: sizes[number])) if halls else np.zeros((0, 2), int)
    while places:
        best = None
        for number, place in places.items():
            gaps = np.abs(place[:, None, :] - joined[None, ::2, :]).sum(axis=2)
            at = int(gaps.argmin())
            gap = int(gaps.flat[at])
            if best is None or gap < best[0]:
                best = gap, number, place[at // gaps.shape[1]], joined[::2][at % gaps.shape[1]]
        assert best is not None
        _, number, start, end = best
        _dig(open_, dice, *map(int, start), *map(int, end))
        joined = np.vstack([joined, places.pop(number)])


def _dig(open_: NDArray[np.bool_], dice: Dice, row: int, col: int, end_row: int, end_col: int) -> None:
    """Free the way from one cell to another, by steps along rows and columns, in place."""
    while True:
        open_[max(row - 2, 0) : row + 3, max(col - 2, 0) : col + 3] = True
        down, across = end_row - row, end_col - col
        if not down and not across:
            return
        if dice.between(0.0, abs(down) + abs(across)) < abs(down):
            row += 1 if down > 0 else -1
        else:
            col += 1 if across > 0 else -1
