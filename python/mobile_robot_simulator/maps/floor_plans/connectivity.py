"""Which free cells hang together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .plan import FREE, WALL


def fill_unreachable(cells: NDArray[np.int8]) -> None:
    """Wall up, in place, all free cells but those of the largest part, which moves along rows and columns connect."""
    # Rows like the one below them connect nothing new; plans of straight walls have few others.
    fresh = np.flatnonzero(np.r_[True, (np.diff(cells == FREE, axis=0)).any(axis=1)])
    heights = np.diff(np.r_[fresh, len(cells)])
    parts = label(cells[fresh] == FREE)
    sizes = np.bincount(parts.ravel(), np.repeat(heights, parts.shape[1]))
    sizes[0] = 0
    stray = np.repeat((parts != 0) & (parts != sizes.argmax()), heights, axis=0)
    cells[stray] = WALL


def label(free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Number of the part that each cell belongs to, 0 where it is not free.

    method: runs along rows, joined from row to row (Rosenfeld & Pfaltz 1966).
    """
    edges = np.diff(np.pad(free, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, run_starts = np.nonzero(edges == 1)
    run_ends = np.nonzero(edges == -1)[1]
    starts, ends = run_starts.tolist(), run_ends.tolist()
    first = np.searchsorted(rows, np.arange(len(free) + 1)).tolist()
    parents = list(range(len(rows)))

    def root(run: int) -> int:
        while parents[run] != run:
            parents[run] = parents[parents[run]]
            run = parents[run]
        return run

    for row in range(1, len(free)):
        below, run = first[row - 1], first[row]
        while below < first[row] and run < first[row + 1]:
            if starts[below] < ends[run] and starts[run] < ends[below]:
                low, high = sorted((root(below), root(run)))
                parents[high] = low
            if ends[below] < ends[run]:
                below += 1
            else:
                run += 1
    numbers = np.zeros(free.shape, np.int32)
    roots = np.array([root(run) for run in range(len(rows))], np.int32)
    numbers[free] = np.repeat(roots + 1, run_ends - run_starts)
    return numbers
