"""DrivePicture: the paths of robots in their map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from .._core import OccupancyGrid, Pose, Shape
from .layers import (
    draw_cells,
    draw_contacts,
    draw_goal,
    draw_name,
    draw_named_path,
    draw_outline,
    draw_path,
    draw_robot,
    draw_scan,
    outline_of,
)
from .picture import Picture
from .view import Points, PoseLike, finite_rows, known_corners, view_of


class DrivePicture(Picture):
    """A picture of the path of a robot in its map, cropped to the known cells near the drive.

    Args:
        grid: Map that the robot drove in.
        path: Poses of the robot in the map frame, (N, 2) or (N, 3) float64 with N >= 1: x, y [m] and yaw [rad]. Its
            colour changes from start to end.
        name: Name of the robot, written beside the end of the path; empty for none.
        others: Paths of other robots by name. The name is written beside the end of the path.
        shapes: Shapes to draw with their poses in the map frame, such as obstacles and footprints.
        scan_points: End points of the last scan's beams in the map frame [m], (M, 2) float64.
        laser_pose: Pose of the laser at the last scan. Without it, no beams are drawn.
        goal: Goal in the map frame: x, y [m].
        contacts: Points in the map frame where a robot touched something [m], (K, 2) float64.
        title: Title above the axes.

    Raises:
        ValueError: An array has a wrong shape or a number that is not finite, or the path is empty.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        path: Points,
        *,
        name: str = "",
        others: Mapping[str, Points] | None = None,
        shapes: Sequence[tuple[Shape, Pose]] = (),
        scan_points: Points | None = None,
        laser_pose: PoseLike | None = None,
        goal: Sequence[float] | None = None,
        contacts: Points | None = None,
        title: str | None = None,
    ) -> None:
        self._grid, self._name, self.title = grid, name, title
        self._path = finite_rows("path", path, (2, 3))
        if not len(self._path):
            raise ValueError("path must have at least one row, got none")
        self._others = {name: finite_rows(f"others[{name!r}]", other, (2, 3)) for name, other in (others or {}).items()}
        self._outlines = [outline_of(shape, pose) for shape, pose in shapes]
        self._scan_points = finite_rows("scan_points", scan_points, (2,))
        self._laser = finite_rows("laser_pose", laser_pose, (3,))
        self._goal = finite_rows("goal", goal, (2, 3))[:, :2]
        self._contacts = finite_rows("contacts", contacts, (2,))

    def view(self) -> Points:
        """Returns the corners of an area with everything drawn and the known cells near it, (2, 2)."""
        others = (path[:, :2] for path in self._others.values())
        drawn = np.vstack([self._path[:, :2], self._scan_points, self._goal, self._contacts, *others, *self._outlines])
        return view_of(np.vstack([known_corners(self._grid, drawn), drawn]), margin=0.02)

    def draw(self, axes: Axes) -> None:
        """Draws the map, the shapes, the paths, the robots at their ends, the goal, the contacts and the scan."""
        draw_cells(axes, self._grid)
        for outline in self._outlines:
            draw_outline(axes, outline)
        for name, path in self._others.items():
            if len(path):
                draw_named_path(axes, name, path)
        draw_path(axes, self._path, labels=("start", "path"))
        draw_robot(axes, self._path[-1], label="end")
        if self._name:
            draw_name(axes, self._name, self._path[-1])
        draw_goal(axes, self._goal)
        draw_contacts(axes, self._contacts)
        draw_scan(axes, self._scan_points, self._laser, label="last scan")
