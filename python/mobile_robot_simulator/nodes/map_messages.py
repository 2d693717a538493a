"""Maps as messages: OccupancyGrid to nav_msgs/OccupancyGrid and back."""

from __future__ import annotations

from typing import Literal

import numpy as np

from .. import messages
from .._core import OccupancyGrid


def to_message(grid: OccupancyGrid, frame_id: str = "map") -> messages.OccupancyGrid:
    """The message that carries a grid."""
    height, width = grid.shape
    origin = messages.Pose.from_planar(grid.origin)
    info = messages.MapMetaData(resolution=grid.resolution, width=width, height=height, origin=origin)
    return messages.OccupancyGrid(messages.Header(frame_id=frame_id), info, grid.cells.reshape(-1))


def from_message(message: messages.OccupancyGrid, *, unknown: Literal["free", "occupied"] = "free") -> OccupancyGrid:
    """The grid that a message carries.

    raises: ValueError for data that does not fill the map, or that no grid can hold.
    """
    info, data = message.info, np.asarray(message.data)
    if data.dtype.kind not in "iu" or data.min(initial=0) < -1 or data.max(initial=0) > 100:
        raise ValueError(f"a map's data must be integers in -1..100, got {data.dtype} values such as {data.ravel()[:4]}")
    if data.size != info.width * info.height:
        raise ValueError(f"a map of {info.width}x{info.height} cells must have as many values, got {data.size}")
    cells = data.astype(np.int8, copy=False).reshape(info.height, info.width)
    return OccupancyGrid(cells, resolution=_resolution(info), origin=info.origin.to_planar(), unknown=unknown)


def _resolution(info: messages.MapMetaData) -> float:
    """The resolution that was meant: a message on the wire carries float32, which is not 0.05 but nearly so."""
    rounded = np.float32(info.resolution)
    return float(str(rounded)) if info.resolution == rounded else info.resolution


def is_of(message: messages.OccupancyGrid, grid: OccupancyGrid) -> bool:
    """Whether a message carries the very cells of a grid, in the same place."""
    info = message.info
    return (
        (info.height, info.width) == grid.shape
        and _resolution(info) == grid.resolution
        and info.origin == messages.Pose.from_planar(grid.origin)
        and np.array_equal(message.data, grid.cells.reshape(-1))
    )


def with_unknown(grid: OccupancyGrid, unknown: Literal["free", "occupied"]) -> OccupancyGrid:
    """The same grid with another reading of its unknown cells."""
    return OccupancyGrid(
        grid.cells,
        resolution=grid.resolution,
        origin=grid.origin,
        occupied_threshold=grid.occupied_threshold,
        unknown=unknown,
    )
