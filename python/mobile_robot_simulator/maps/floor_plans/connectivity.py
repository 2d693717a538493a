"""Connected components of the free cells of a plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .plan import FREE, WALL


def fill_unreachable(cells: NDArray[np.int8]) -> None:
    """Turns all free cells outside the largest 4-connected component into wall, in place.

    Args:
        cells: Cells (H, W) of a plan.
    """
    # Equal neighbouring rows have the same connections, and most rows equal the row below. Only the others are labelled.
    distinct = np.flatnonzero(np.r_[True, (np.diff(cells == FREE, axis=0)).any(axis=1)])
    heights = np.diff(np.r_[distinct, len(cells)])
    parts = label(cells[distinct] == FREE)
    sizes = np.bincount(parts.ravel(), np.repeat(heights, parts.shape[1]))
    sizes[0] = 0
    unreachable = np.repeat((parts != 0) & (parts != sizes.argmax()), heights, axis=0)
    cells[unreachable] = WALL


def label(free: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Labels the 4-connected components of the free cells.

    Method: runs along each row, merged with overlapping runs of the row below (Rosenfeld and Pfaltz, 1966).

    Args:
        free: True for each free cell, (H, W).

    Returns:
        The label of each cell's component, (H, W): at least 1, not always consecutive; 0 for cells that are not free.
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
