"""Generated plans of houses, as those of HouseExpo are."""

from __future__ import annotations

import numpy as np


def generated(random: np.random.Generator) -> list[list[float]]:
    """The outline of rooms along a corridor, with walls of 0.1 m between them, as plans of the dataset are."""
    corners, x = [[0.0, 0.0]], 0.0
    widths = random.uniform(2.0, 5.0, random.integers(3, 8))
    for width in widths:
        depth = random.uniform(2.0, 5.0)
        door = x + random.uniform(0.2, width - 1.2)
        corners += [[door, 0], [door, -0.1], [x, -0.1], [x, -depth], [x + width - 0.1, -depth], [x + width - 0.1, -0.1]]
        corners += [[door + 0.9, -0.1], [door + 0.9, 0]]
        x += width
    return np.round([*corners, [x, 0], [x, 1.8], [0, 1.8]], 4).tolist()
