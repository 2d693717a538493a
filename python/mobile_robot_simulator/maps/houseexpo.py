"""HouseExpo files: floor plans of houses as JSON.

Source: T. Li et al., *HouseExpo: A large-scale 2D indoor layout dataset for learning-based algorithms on mobile robots*,
2019, and the README of https://github.com/TeaganLi/HouseExpo. A plan is an object with these keys; others are ignored:

- `verts`: corners [x, y] of the outline of all rooms together [m];
- `id`, `room_num`, `bbox`, `room_category`: not needed for a grid.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted
from ..user_files import read_text
from .cell_map import CellMap
from .raster import Raster

__all__ = ["read_houseexpo"]

_LIMIT = 2**26


def read_houseexpo(path: Path, resolution: float) -> CellMap:
    """Returns the cells of a HouseExpo plan: the inside of the outline is free, the outside is occupied.

    A point is inside if the outline encloses it an odd number of times, as in the pictures of the dataset. Cells that are
    partly outside are occupied; see `raster.py`. So the grid has a wall of at least one cell all around.

    Args:
        path: The file.
        resolution: Side of a cell [m].

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is malformed, or the grid would be too large.
    """
    corners = _corners(path)
    try:
        raster = Raster(corners.min(axis=0).tolist(), corners.max(axis=0).tolist(), resolution)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    raster.add_outside(corners)
    return raster.cell_map()


def _corners(path: Path) -> NDArray[np.float64]:
    try:
        plan = json.loads(read_text(path, _LIMIT))
    except json.JSONDecodeError as error:
        raise ValueError(f"{path}, line {error.lineno}: not valid JSON: {error.msg}") from None
    except RecursionError:
        raise ValueError(f"{path}: not valid JSON: nested too deeply") from None
    verts = plan.get("verts") if isinstance(plan, dict) else None
    if not isinstance(verts, list) or len(verts) < 3:
        got = quoted(verts if isinstance(plan, dict) else plan)
        raise ValueError(f"{path}: must have 'verts', a list of at least three corners [x, y], got {got}")
    for index, corner in enumerate(verts):
        if not isinstance(corner, list) or len(corner) != 2 or not {type(number) for number in corner} <= {int, float}:
            raise ValueError(f"{path}: corner {index} of 'verts' must be two numbers [x, y], got {quoted(corner)}")
    try:
        corners = np.array(verts, np.float64)
    except OverflowError:
        raise ValueError(f"{path}: the corners of 'verts' must be finite") from None
    if not np.isfinite(corners).all():
        raise ValueError(f"{path}: the corners of 'verts' must be finite")
    return corners
