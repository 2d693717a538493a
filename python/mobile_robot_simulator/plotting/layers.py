"""Layers of a picture: functions that draw cells, paths, robots, scans, shapes and so on in axes of the map frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from .._core import OccupancyGrid, Pose, Shape
from .style import CONTACT, FREE, GOAL, INK, OCCUPIED, ROBOT, SCAN, SHAPE, TIME, UNKNOWN
from .view import Points, map_from_cells

_ARROW = Path([(1.0, 0.0), (-0.8, 0.7), (-0.4, 0.0), (-0.8, -0.7), (1.0, 0.0)], closed=True)
_ENOUGH_POINTS = 4000  # a path with at least twice as many is thinned out, but keeps about this many at equal distances
_MOST_POINTS = 50_000  # of a path; a picture of them takes about a second
_INVISIBLE = 5e-4  # deviation of a thinned path, as a share of its size: less than a pixel in pictures of usual size
_NO_LABEL = "_"


def draw_cells(axes: Axes, grid: OccupancyGrid) -> None:
    """Draws the cells in view. If there are several per pixel, draws their maximum, so that no wall disappears."""
    transform = map_from_cells(grid)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    corners = transform.inverted().transform([(left, bottom), (right, bottom), (right, top), (left, top)])
    height, width = grid.shape
    first_col, first_row = np.clip(np.floor(corners.min(axis=0)), 0, (width, height)).astype(int)
    last_col, last_row = np.clip(np.ceil(corners.max(axis=0)), 0, (width, height)).astype(int)
    cells = grid.cells[first_row:last_row, first_col:last_col]
    if not cells.size:
        return
    pixels = axes.get_window_extent().width * grid.resolution / (right - left)  # per cell
    side = max(1, int(1.0 / pixels))
    for axis in (0, 1):
        cells = np.maximum.reduceat(cells, np.arange(0, cells.shape[axis], side), axis=axis)
    rows, cols = cells.shape
    axes.imshow(
        _cell_colours()[cells],  # -1 selects the last colour
        origin="lower",
        extent=(first_col, first_col + cols * side, first_row, first_row + rows * side),
        transform=transform + axes.transData,
        interpolation="nearest" if pixels > 2 else "hanning",
        zorder=1,
    )
    axes.set(xlim=(left, right), ylim=(bottom, top))


def _cell_colours() -> NDArray[np.uint8]:
    """Returns the colours of the cell values 0..100 and, last, of -1: (102, 3)."""
    occupancy = np.linspace(0.0, 1.0, 101)[:, None]
    shades = (1.0 - occupancy) * np.array(FREE) + occupancy * np.array(OCCUPIED)
    return np.vstack([shades, UNKNOWN]).astype(np.uint8)


def outline_of(shape: Shape, pose: Pose) -> Points:
    """Returns the corners of a shape in the map frame, (N, 2). A disc becomes a polygon with 48 corners."""
    corners = shape.points
    if shape.radius is not None:
        angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        corners = shape.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    outline: Points = Affine2D().rotate(pose.yaw).translate(pose.x, pose.y).transform(corners)
    return outline


def draw_outline(axes: Axes, outline: Points) -> None:
    """Draws a filled polygon."""
    axes.fill(*outline.T, fc=SHAPE, ec=INK, lw=0.8, zorder=2)


def draw_path(axes: Axes, path: Points, *, labels: tuple[str, str] = (_NO_LABEL, _NO_LABEL)) -> None:
    """Draws a path as a coloured line with a white border, and a ring at its start. A long path is thinned out."""
    axes.plot(*path[0, :2], "o", ms=8, mfc="white", mec=TIME(0.0), mew=2.2, zorder=6, label=labels[0])
    shown = _shown(path[:, :2])
    points = path[shown, :2]
    axes.plot(*points.T, color="white", lw=4.2, alpha=0.85, solid_joinstyle="round", zorder=4)
    segments = list(np.stack([points[:-1], points[1:]], axis=1))
    colours = TIME(shown[:-1] / max(1, shown[-1] - 1))
    axes.add_collection(LineCollection(segments, colors=colours, linewidths=2.0, capstyle="round", zorder=4))
    axes.plot([], [], color=TIME(0.5), lw=2.0, label=labels[1])


def _shown(points: Points) -> NDArray[np.intp]:
    """Returns the indices of the points (N, 2) of a path to draw: all, or those that a long path cannot do without.

    Every `stride`-th point stays, for the colours. Each pass looks at every second one of the points left, and removes those
    on the line between their neighbours, until that is less than a tenth of them. Of what is still too much, a part is left
    out at equal distances.
    """
    shown, stride = np.arange(len(points)), len(points) // _ENOUGH_POINTS
    if stride < 2:
        return shown
    tolerance = _INVISIBLE * np.ptp(points, axis=0).max()
    while True:
        middle = shown[1:-1:2]
        start, end = points[shown[:-2:2]], points[shown[2::2]]
        chord, offset = end - start, points[middle] - start
        share = (chord * offset).sum(axis=1) / np.maximum((chord * chord).sum(axis=1), np.finfo(float).tiny)
        distance = np.hypot(*(offset - np.clip(share, 0.0, 1.0)[:, None] * chord).T)
        removed = (distance <= tolerance) & (middle % stride > 0)
        shown = np.delete(shown, 1 + 2 * np.flatnonzero(removed))
        if removed.sum() < 0.1 * len(middle):
            return np.append(shown[: -1 : -(-len(shown) // _MOST_POINTS)], shown[-1])


def draw_robot(axes: Axes, pose: Points, *, label: str = _NO_LABEL) -> None:
    """Draws an arrow along the heading of a pose (3,), or a disc at a position (2,)."""
    look: dict[str, Any] = {"marker": "o", "ms": 11}
    if len(pose) == 3:
        look = {"marker": MarkerStyle(_ARROW, transform=Affine2D().rotate(pose[2])), "ms": 20}
    axes.plot(*pose[:2], ls="none", mfc=ROBOT, mec="white", mew=1.3, zorder=8, label=label, **look)


def draw_named_path(axes: Axes, name: str, path: Points) -> None:
    """Draws a path and, at its end, the robot and its name."""
    draw_path(axes, path)
    draw_robot(axes, path[-1])
    draw_name(axes, name, path[-1])


def draw_name(axes: Axes, name: str, pose: Points) -> None:
    """Writes the name of a robot beside its pose, (2,) or (3,). It has a light background, so walls do not hide it."""
    background = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8}
    axes.annotate(name, (pose[0], pose[1]), (8, 8), textcoords="offset points", color=INK, bbox=background, zorder=9)


def draw_goal(axes: Axes, goal: Points) -> None:
    """Draws a star at the goal (1, 2), or nothing for (0, 2)."""
    if len(goal):
        axes.plot(*goal.T, "*", ms=17, mfc=GOAL, mec="white", mew=1.2, zorder=7, label="goal")


def draw_contacts(axes: Axes, points: Points) -> None:
    """Draws a cross at each contact point (N, 2)."""
    if len(points):
        axes.plot(*points.T, "X", ls="none", ms=11, mfc=CONTACT, mec="white", mew=1.0, zorder=9, label="contact")


def draw_scan(axes: Axes, ends: Points, laser: Points, *, label: str) -> None:
    """Draws the end points of beams and, if `laser` has a row, the beams. With more beams, each is fainter."""
    if not len(ends):
        return
    if len(laser):
        beams = np.stack([np.broadcast_to(laser[:, :2], ends.shape), ends], axis=1)
        opacity = float(np.clip(40.0 / len(ends), 0.04, 0.3))
        axes.add_collection(LineCollection(list(beams), colors=SCAN, linewidths=0.8, alpha=opacity, zorder=3))
    axes.plot(*ends.T, "o", ms=2.6, mfc=SCAN, mec="none", zorder=5, label=label)
