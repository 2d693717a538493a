"""Conversion between `OccupancyGrid` and the message nav_msgs/OccupancyGrid."""

from __future__ import annotations

from typing import Literal

import numpy as np

from .. import messages
from .._core import OccupancyGrid


def to_message(grid: OccupancyGrid, frame_id: str = "map") -> messages.OccupancyGrid:
    """Returns a grid as a message.

    Args:
        grid: Map to send.
        frame_id: Frame of the grid's origin.
    """
    height, width = grid.shape
    origin = messages.Pose.from_planar(grid.origin)
    info = messages.MapMetaData(resolution=grid.resolution, width=width, height=height, origin=origin)
    return messages.OccupancyGrid(messages.Header(frame_id=frame_id), info, grid.cells.reshape(-1))


def from_message(message: messages.OccupancyGrid, *, unknown: Literal["free", "occupied"] = "free") -> OccupancyGrid:
    """Returns the grid in a message.

    Args:
        message: Received map.
        unknown: Whether beams treat unknown cells as free or as occupied.

    Raises:
        ValueError: A value is not an integer in -1..100, the number of values is not width * height, or the resolution or
            the origin is invalid.
    """
    info, data = message.info, np.asarray(message.data)
    if data.dtype.kind not in "iu" or data.min(initial=0) < -1 or data.max(initial=0) > 100:
        raise ValueError(f"a map's data must be integers in -1..100, got {data.dtype} values such as {data.ravel()[:4]}")
    if data.size != info.width * info.height:
        raise ValueError(
            f"a map of {info.width}x{info.height} cells must have {info.width * info.height} values, got {data.size}"
        )
    cells = data.astype(np.int8, copy=False).reshape(info.height, info.width)
    return OccupancyGrid(cells, resolution=_resolution(info), origin=info.origin.to_planar(), unknown=unknown)


def _resolution(info: messages.MapMetaData) -> float:
    """Returns the resolution that the sender meant [m/cell].

    The message holds a float32. Converted to float64, 0.05 would become 0.05000000074505806. This function returns the
    shortest decimal number that rounds to the same float32.
    """
    rounded = np.float32(info.resolution)
    return float(str(rounded)) if info.resolution == rounded else info.resolution


def carries_grid(message: messages.OccupancyGrid, grid: OccupancyGrid) -> bool:
    """Returns True if a message has the same cells, resolution and origin as a grid."""
    info = message.info
    return (
        (info.height, info.width) == grid.shape
        and _resolution(info) == grid.resolution
        and info.origin == messages.Pose.from_planar(grid.origin)
        and np.array_equal(message.data, grid.cells.reshape(-1))
    )


def with_unknown(grid: OccupancyGrid, unknown: Literal["free", "occupied"]) -> OccupancyGrid:
    """Returns a copy of a grid in which beams treat unknown cells as free or as occupied."""
    return OccupancyGrid(
        grid.cells,
        resolution=grid.resolution,
        origin=grid.origin,
        occupied_threshold=grid.occupied_threshold,
        unknown=unknown,
        materials=grid.materials,
        material_table=grid.material_table,
    )
