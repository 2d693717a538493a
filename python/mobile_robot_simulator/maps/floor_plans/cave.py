"""Caves: halls of irregular shape, connected by tunnels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .connectivity import label
from .dice import Dice
from .plan import FREE, Plan

_COARSE_CELL = 0.4  # side of a cell of the cellular automaton [m]
_ROCK_SHARE = 0.46
_GENERATIONS = 6
_MIN_HALL = 40  # size in coarse cells; smaller halls are filled


def draw_cave(plan: Plan, dice: Dice) -> None:
    """Grows a cave with a cellular automaton on coarse cells, then smooths its walls."""
    inside = plan.inside
    grain = plan.count(_COARSE_CELL)
    shape = (-(-inside.height // grain), -(-inside.width // grain))
    open_ = np.array([dice.between(0.0, 1.0) >= _ROCK_SHARE for _ in range(shape[0] * shape[1])]).reshape(shape)
    for generation in range(_GENERATIONS):
        around = _sums(open_, 1)
        # In the first two generations, rock also appears in open space. This limits the width of the halls.
        pillars = _sums(open_, 2) >= 24 if generation < 2 else np.zeros(shape, bool)
        open_ = (around >= 5) & ~pillars
    open_ = _sums(_sums(open_, 1) == 9, 1) > 0
    _connect(open_, dice)
    fine = open_.repeat(grain, axis=0).repeat(grain, axis=1)[: inside.height, : inside.width]
    smooth = 2 * _sums(fine, grain) > (2 * grain + 1) ** 2
    plan.cells[inside.bottom : inside.top, inside.left : inside.right][smooth] = FREE
    plan.enclose()


def _sums(cells: NDArray[np.bool_], reach: int) -> NDArray[np.int32]:
    """Number of set cells in the square of side 2 * reach + 1 around each cell; cells off the plan count as not set."""
    sums = np.pad(cells, ((reach + 1, reach), (reach + 1, reach))).cumsum(0, np.int32).cumsum(1, np.int32)
    side = 2 * reach + 1
    inside: NDArray[np.int32] = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    return inside


def _connect(open_: NDArray[np.bool_], dice: Dice) -> None:
    """Fills small halls in place, then digs tunnels from the others to the largest hall, nearest hall first."""
    numbers = label(open_)
    sizes = np.bincount(numbers.ravel())
    halls = [number for number in range(1, len(sizes)) if sizes[number] >= _MIN_HALL]
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
    """Digs a tunnel from one cell to another, in place, by random steps along rows and columns."""
    while True:
        open_[max(row - 2, 0) : row + 3, max(col - 2, 0) : col + 3] = True
        down, across = end_row - row, end_col - col
        if not down and not across:
            return
        if dice.between(0.0, abs(down) + abs(across)) < abs(down):
            row += 1 if down > 0 else -1
        else:
            col += 1 if across > 0 else -1
