"""BARN: the tasks of the Benchmark Autonomous Robot Navigation challenge, in its 300 static worlds.

Sources: D. Perille et al., *Benchmarking metric ground navigation*, SSRR 2020; `run.py` and `report_test.py` of
https://github.com/Daffan/the-barn-challenge at commit bf5a226 of 2026-03-04; the Jackal robot in
https://github.com/jackal/jackal (`jackal.urdf.xacro`, `control.yaml`).
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Pose
from ..maps import load_map
from ..quoting import shortened
from ..user_files import read_bytes
from .task import Task

__all__ = ["JACKAL", "barn_task"]

START = Pose(-2.25, 3.0, 1.57)
GOAL = (-2.25, 13.0)
TOP_SPEED = 2.0
"""Speed of the best robot [m/s]."""

JACKAL: Mapping[str, Any] = {
    # Around chassis and wheels: 0.262 + 2 * 0.098 long, 0.37559 + 0.040 wide.
    "footprint": "[[0.229, 0.2078], [-0.229, 0.2078], [-0.229, -0.2078], [0.229, -0.2078]]",
    "velocity_limits": [2.0, 0.0, 4.0],
    "acceleration_limits": [20.0, 0.0, 25.0],
    "velocity_timeout": 0.25,
    "laser_frame_id": "front_laser",
    "laser_mount": [0.055, 0.0, 0.0],  # the front mount, 0.12 m ahead, and the offset of the challenge, -0.065 m
    "laser_fov": 4.71238,
    "laser_beam_count": 720,
    "laser_min_range": 0.1,
    "laser_max_range": 30.0,
    "apply_noise": False,
}
"""Parameters of the Jackal with its Hokuyo UST-10, without noise."""

_CELL = 0.15
_CORNER = (-4.575, 5.075)
"""Centre of the cell (0, 0) of a path in the world [m]."""

_PATH_LIMIT = 2**24


def barn_task(
    world: str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    resolution: float = 0.025,
    quickest: float = 2.0,
    parameters: Mapping[str, Any] | None = None,
) -> Task:
    """Returns the task of a static BARN world: 10 m straight ahead, to within 1 m of the goal, in 100 s, without contact.

    Args:
        world: The world, such as `worlds/BARN/world_0.world`.
        path: Its shortest path, such as `worlds/BARN/path_files/path_0.npy`: cells (N, 2) of 0.15 m. The optimal time is
            that at 2 m/s from the start, along the path, to the goal.
        resolution: Side of a cell of the grid [m].
        quickest: Multiple of the optimal time below which a faster robot does not score more. The challenge's `run.py` has
            2; published copies of it have 4.
        parameters: Parameters that replace or complete those of the Jackal.

    Raises:
        OSError: A file cannot be read.
        ValueError: A file is malformed, or a value is out of range.
    """
    corners = [(START.x, START.y), *_path(Path(path)), GOAL]
    length = sum(math.dist(a, b) for a, b in pairwise(corners))
    return Task(
        Path(world).stem,
        load_map(world, resolution=resolution),
        START,
        GOAL,
        optimal_time=length / TOP_SPEED,
        parameters={**JACKAL, **(parameters or {})},
        quickest=quickest,
    )


def _path(path: Path) -> list[tuple[float, float]]:
    """Returns the points of a path in the world [m]."""
    data = read_bytes(path, _PATH_LIMIT)
    try:
        cells: NDArray[Any] = np.load(io.BytesIO(data), allow_pickle=False)
    except (ValueError, EOFError, SyntaxError) as error:
        raise ValueError(f"{path}: not a NumPy file: {shortened(error)}") from None
    if not isinstance(cells, np.ndarray) or cells.ndim != 2 or cells.shape[1] != 2 or cells.dtype.kind not in "iuf":
        got = f"{cells.dtype} {cells.shape}" if isinstance(cells, np.ndarray) else type(cells).__name__
        raise ValueError(f"{path}: a path must be numbers of shape (N, 2), got {got}")
    if not np.isfinite(cells).all():
        raise ValueError(f"{path}: the cells of a path must be finite")
    return [(_CORNER[0] + _CELL * float(x), _CORNER[1] + _CELL * float(y)) for x, y in cells]
