"""Parts: the pieces of a frame as a page reads them, of a simulation and of a recording."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import LaserScanner, OccupancyGrid, Pose, Shape
from .trail import Trail


@dataclass(frozen=True)
class Frame:
    """What there is to draw at one time.

    Attributes:
        parts: JSON of each part by name.
        trails: Paths by the names of the robots. Pages take only the new points.
    """

    parts: Mapping[str, bytes]
    trails: Mapping[str, Trail]


def map_part(grid: OccupancyGrid, title: str, version: object) -> bytes:
    """Returns the place of a map.

    Args:
        grid: The map.
        title: Its name.
        version: What changes with the cells.
    """
    rows, columns = grid.shape
    return json_part(
        {
            "rows": rows,
            "columns": columns,
            "resolution": grid.resolution,
            "origin": rounded(grid.origin, 6),
            "threshold": grid.occupied_threshold,
            "title": title,
            "version": version,
        }
    )


def scan_part(scanner: LaserScanner, base: Pose, ranges: NDArray[np.float32], stamp: float) -> bytes:
    """Returns a scan: end points in the map frame, and which of them are returns.

    Args:
        scanner: The scanner.
        base: Pose of the robot in the map frame.
        ranges: (beam_count,) float32 [m].
        stamp: Time of the scan [s].
    """
    hits = (ranges >= scanner.min_range) & (ranges < scanner.max_range)
    # End points of beams without a return, just below the largest range, only to fill the area that was seen.
    farthest = np.nextafter(np.float32(scanner.max_range), np.float32(0.0))
    nearest = np.float32(scanner.min_range)
    points = scanner.end_points(base, np.where(hits, ranges, np.where(ranges < nearest, nearest, farthest)))
    return json_part(
        {
            "stamp": stamp,
            "place": rounded(base * scanner.mount),
            "points": _packed(points.astype(np.float32)),
            "hits": _packed(hits.astype(np.uint8)),
            "count": int(hits.sum()),
        }
    )


def outline_of(shape: Shape | None) -> dict[str, Any] | None:
    """Returns a shape as JSON can hold it, None without one."""
    if shape is None:
        return None
    if shape.radius is not None:
        return {"radius": shape.radius}
    return {"corners": shape.points.round(4).tolist()}


def rounded(pose: Pose, digits: int = 4) -> list[float]:
    """Returns x, y, yaw of a pose, with so many digits after the point [m, m, rad]."""
    return [round(pose.x, digits), round(pose.y, digits), round(pose.yaw, 5)]


def json_part(value: Any) -> bytes:
    """Returns a value as JSON."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).encode()


def _packed(values: NDArray[Any]) -> str:
    return base64.b64encode(values.tobytes()).decode("ascii")
