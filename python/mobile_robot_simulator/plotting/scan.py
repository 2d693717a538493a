"""ScanPicture: a scan in its map."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from .._core import OccupancyGrid
from .layers import draw_cells, draw_robot, draw_scan
from .picture import Picture
from .view import Points, PoseLike, finite_rows, view_of


class ScanPicture(Picture):
    """A picture of a scan in its map, cropped to where the beams reach.

    Args:
        grid: Map that was scanned.
        pose: Pose of the laser in the map frame: x, y [m], yaw [rad].
        scan_points: End points of the beams in the map frame [m], (M, 2) float64.
        title: Title above the axes.

    Raises:
        ValueError: An array has a wrong shape or a number that is not finite.
    """

    def __init__(self, grid: OccupancyGrid, pose: PoseLike, scan_points: Points, *, title: str | None = None) -> None:
        self._grid, self.title = grid, title
        self._laser = finite_rows("pose", pose, (3,))
        self._scan_points = finite_rows("scan_points", scan_points, (2,))

    def view(self) -> Points:
        """Returns the corners of an area with all end points and 3 m around the laser, (2, 2)."""
        around_laser = self._laser[:, :2] + np.array([[-3.0, -3.0], [3.0, 3.0]])
        return view_of(np.vstack([around_laser, self._scan_points]), margin=0.08)

    def draw(self, axes: Axes) -> None:
        """Draws the map, the beams and the laser."""
        draw_cells(axes, self._grid)
        draw_scan(axes, self._scan_points, self._laser, label="scan")
        draw_robot(axes, self._laser[0], label="laser")
