"""What every reader of a map format returns: cells, their size, and where they are."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .material_layer import MaterialLayer


class CellMap(NamedTuple):
    """The cells of a map and their place in the map frame."""

    cells: NDArray[np.int8]
    """(H, W), row 0 at the bottom; -1 is unknown, 0 to 100 is occupancy."""

    resolution: float
    """Side of a cell [m]."""

    origin: tuple[float, float, float]
    """Pose of the lower-left corner of the grid in the map frame [m, m, rad]."""

    materials: MaterialLayer | None = None
    """The materials of the cells; None if the format or the file has none."""


def check_length(name: str, value: object) -> float:
    """Returns a length that a user gave, such as the side of a cell, after checking that it is positive and finite.

    Args:
        name: Its name, for the message.
        value: What the user gave.

    Raises:
        TypeError: It is not a number.
        ValueError: It is not positive, or not finite.
    """
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"{name} must be a number [m], got {type(value).__name__}")
    if not 0 < value < math.inf:
        raise ValueError(f"{name} must be positive and finite [m], got {value}")
    return float(value)
