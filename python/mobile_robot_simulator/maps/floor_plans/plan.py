"""Plan: the array of cells on which floor plans are drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

UNKNOWN, FREE, WALL = -1, 0, 100


class Box(NamedTuple):
    """A rectangle of cells: columns [left, right) and rows [bottom, top)."""

    left: int
    bottom: int
    right: int
    top: int

    @property
    def width(self) -> int:
        """Number of columns."""
        return self.right - self.left

    @property
    def height(self) -> int:
        """Number of rows."""
        return self.top - self.bottom

    def grown(self, by: int) -> Box:
        """The box extended by a number of cells on every side."""
        return Box(self.left - by, self.bottom - by, self.right + by, self.top + by)

    def overlaps(self, other: Box) -> bool:
        """True if the boxes have a cell in common."""
        return self.left < other.right and other.left < self.right and self.bottom < other.top and other.bottom < self.top

    def contains(self, other: Box) -> bool:
        """True if the other box is completely inside this one."""
        return (
            self.left <= other.left and other.right <= self.right and self.bottom <= other.bottom and other.top <= self.top
        )


@dataclass
class Plan:
    """Cells of a floor plan, unknown at first, and functions that draw on them.

    Args:
        width: Number of columns.
        height: Number of rows.
        resolution: Side of a cell [m].
    """

    width: int
    height: int
    resolution: float

    def __post_init__(self) -> None:
        self.cells = np.full((self.height, self.width), UNKNOWN, np.int8)
        self.wall = max(2, self.count(0.12))
        self.outer_wall = max(3, self.count(0.25))
        self.door = max(2, math.ceil(0.9 / self.resolution - 1e-9))

    @property
    def inside(self) -> Box:
        """The plan without its outer wall."""
        return Box(0, 0, self.width, self.height).grown(-self.outer_wall)

    def count(self, metres: float) -> int:
        """Number of cells in a length, at least 1."""
        return max(1, round(metres / self.resolution))

    def fill(self, box: Box, value: int) -> None:
        """Sets all cells of a box to a value."""
        self.cells[max(box.bottom, 0) : max(box.top, 0), max(box.left, 0) : max(box.right, 0)] = value

    def carve(self, box: Box) -> None:
        """Turns all cells of a box into free cells."""
        self.fill(box, FREE)

    def block(self, box: Box) -> None:
        """Turns all cells of a box into wall."""
        self.fill(box, WALL)

    def pillar(self, col: int, row: int, radius: float) -> None:
        """Turns all cells of a disc around a cell into wall. The radius is in metres."""
        reach = radius / self.resolution
        size = math.ceil(reach)
        rows, cols = np.ogrid[-size : size + 1, -size : size + 1]
        bottom, left = max(row - size, 0), max(col - size, 0)
        around = self.cells[bottom : row + size + 1, left : col + size + 1]
        round_ = (rows * rows + cols * cols <= reach * reach)[bottom - row + size :, left - col + size :]
        around[round_[: around.shape[0], : around.shape[1]]] = WALL

    def enclose(self) -> None:
        """Adds an outer wall wherever free cells border on unknown cells."""
        free = self.cells == FREE
        for axis in (0, 1):
            spread = free.copy()
            for step in range(1, self.outer_wall + 1):
                ahead, behind = [slice(None)] * 2, [slice(None)] * 2
                ahead[axis], behind[axis] = slice(step, None), slice(None, -step)
                spread[tuple(ahead)] |= free[tuple(behind)]
                spread[tuple(behind)] |= free[tuple(ahead)]
            free = spread
        self.cells[free & (self.cells == UNKNOWN)] = WALL
