"""Pictures of grids, and of drives and scans in them, as PNG, PDF or SVG.

The same arguments make the same file, byte for byte, with the same version of Matplotlib. Files need neither a display nor
pyplot; only `plot_grid` without axes opens a pyplot figure.
"""

from __future__ import annotations

import errno
import io
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import OccupancyGrid, Pose, Shape

try:
    from matplotlib import style
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.figure import Figure
    from matplotlib.markers import MarkerStyle
    from matplotlib.path import Path as Outline
    from matplotlib.transforms import Affine2D
except ImportError as error:
    raise ImportError("pictures need matplotlib: pip install 'mobile-robot-simulator[plotting]'") from error

__all__ = ["grid_png", "plot_drive", "plot_grid", "plot_scan"]

_Points: TypeAlias = NDArray[np.float64]
_PoseLike: TypeAlias = Pose | Sequence[float]

_DPI, _NOTEBOOK_DPI = 150, 80
_LONGEST_SIDE, _SHORTEST_SIDE = 9.0, 3.0  # of the axes [in]
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.65, 0.25, 0.85, 0.25  # around them [in]
_TITLE, _LEGEND = 0.25, 0.48  # what a title adds above; how far below the axes the legend is [in]

_FREE, _OCCUPIED, _UNKNOWN = (255, 255, 255), (38, 42, 51), (226, 229, 233)
_INK, _FAINT, _ROBOT, _SCAN, _GOAL = "#262a33", "#8a919c", "#1f4fd8", "#e8442e", "#f5a300"
_SHAPE = "#b9c2d0"
_TIME = LinearSegmentedColormap.from_list("time", ["#20308f", "#7a2bc4", "#d62a9d", "#ff8a3d"])
_ARROW = Outline([(1.0, 0.0), (-0.8, 0.7), (-0.4, 0.0), (-0.8, -0.7), (1.0, 0.0)], closed=True)

# On top of matplotlib's own defaults, so that nobody's matplotlibrc changes the picture.
_STYLE: dict[Any, Any] = {
    "axes.edgecolor": _FAINT,
    "axes.facecolor": tuple(value / 255 for value in _UNKNOWN),
    "axes.labelcolor": _INK,
    "axes.linewidth": 0.6,
    "axes.titlecolor": _INK,
    "axes.titlelocation": "left",
    "axes.titlesize": 12,
    "axes.titleweight": "bold",
    "font.size": 9,
    "legend.frameon": False,
    "svg.hashsalt": "mobile-robot-simulator",
    "xtick.color": _FAINT,
    "xtick.labelcolor": _INK,
    "ytick.color": _FAINT,
    "ytick.labelcolor": _INK,
}

# The dates and versions that files would have otherwise.
_METADATA: dict[str, dict[str, None]] = {
    ".png": {"Software": None},
    ".pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    ".svg": {"Creator": None, "Date": None},
}


def plot_drive(
    file: str | os.PathLike[str],
    grid: OccupancyGrid,
    path: _Points,
    *,
    others: Mapping[str, _Points] | None = None,
    shapes: Sequence[tuple[Shape, Pose]] = (),
    scan_points: _Points | None = None,
    laser_pose: _PoseLike | None = None,
    goal: Sequence[float] | None = None,
    title: str | None = None,
) -> None:
    """Draw the path of a robot in its map, cropped to what is known of the map around it.

    path: (N, 2) or (N, 3) float64, N >= 1: x, y [m] and yaw [rad] in the map frame; its colour tells first from last.
    others: paths of other robots by their names, which are written beside their ends. shapes: what is drawn in outline, such
    as obstacles and footprints, with poses in the map frame.
    scan_points: (M, 2) float64, where the beams of the last scan ended [m]; laser_pose: from where. goal: x, y [m].
    file: ending in .png, .pdf or .svg; an older one is replaced in one step.
    raises: ValueError for another ending, a wrong shape or a number that is not finite; OSError if the folder is not
    there or cannot be written.
    """
    picture = _picture(file)
    path = _rows("path", path, (2, 3))
    if not len(path):
        raise ValueError("path must have at least one row, got none")
    ends = _rows("scan_points", scan_points, (2,))
    laser = _rows("laser_pose", laser_pose, (3,))
    target = _rows("goal", goal, (2, 3))
    ways = {name: _rows(f"others[{name!r}]", way, (2, 3)) for name, way in (others or {}).items()}
    outlines = [_outline(shape, pose) for shape, pose in shapes]
    drive = np.vstack([path[:, :2], ends, target[:, :2], *(way[:, :2] for way in ways.values()), *outlines])
    view = _view(np.vstack([_known_around(grid, drive), drive]), margin=0.02)
    with style.context(["default", _STYLE]):
        figure, axes = _figure(view, title)
        _draw_map(axes, grid)
        for outline in outlines:
            axes.fill(*outline.T, fc=_SHAPE, ec=_INK, lw=0.8, zorder=2)
        for name, way in ways.items():
            if len(way):
                _draw_path(axes, way)
                _draw_robot(axes, way[-1])
                paper = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8}
                end = (way[-1, 0], way[-1, 1])
                axes.annotate(name, end, (8, 8), textcoords="offset points", color=_INK, bbox=paper, zorder=9)
        _draw_path(axes, path, labels=("start", "path"))
        _draw_robot(axes, path[-1], label="end")
        if len(target):
            axes.plot(*target[:, :2].T, "*", ms=17, mfc=_GOAL, mec="white", mew=1.2, zorder=7, label="goal")
        _draw_scan(axes, ends, laser, label="last scan")
        _save(figure, picture)


def plot_scan(
    file: str | os.PathLike[str],
    grid: OccupancyGrid,
    pose: _PoseLike,
    scan_points: _Points,
    *,
    title: str | None = None,
) -> None:
    """Draw a scan in its map, cropped to where its beams reach.

    pose: x, y [m] and yaw [rad] of the laser in the map frame. scan_points: (M, 2) float64, where beams ended [m].
    file, raises: as for plot_drive.
    """
    picture = _picture(file)
    laser = _rows("pose", pose, (3,))
    ends = _rows("scan_points", scan_points, (2,))
    around = laser[:, :2] + np.array([[-3.0, -3.0], [3.0, 3.0]])
    view = _view(np.vstack([around, ends]), margin=0.08)
    with style.context(["default", _STYLE]):
        figure, axes = _figure(view, title)
        _draw_map(axes, grid)
        _draw_scan(axes, ends, laser, label="scan")
        _draw_robot(axes, laser[0], label="laser")
        _save(figure, picture)


def plot_grid(grid: OccupancyGrid, ax: Axes | None = None) -> Axes:
    """Draw a whole grid and return its axes: what `OccupancyGrid.plot` does.

    Args:
        grid: Grid to draw, down-sampled to the pixels of the axes. Walls stay visible.
        ax: Axes to draw in. None opens a new pyplot figure.
    """
    if ax is None:
        from matplotlib import pyplot

        _, ax = pyplot.subplots()
    low, high = _view(_corners(grid), margin=0.02)
    ax.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    ax.apply_aspect()
    _draw_map(ax, grid)
    return ax


def grid_png(grid: OccupancyGrid) -> bytes:
    """Return a PNG image of a whole grid, at most about 800 pixels a side: what notebooks show for a grid."""
    with style.context(["default", _STYLE]):
        figure, axes = _figure(_view(_corners(grid), margin=0.02), None)
        figure.set_dpi(_NOTEBOOK_DPI)
        _draw_map(axes, grid)
        image = io.BytesIO()
        figure.savefig(image, format="png", dpi=_NOTEBOOK_DPI, metadata=_METADATA[".png"])
    return image.getvalue()


# --- What is drawn ---


def _draw_map(axes: Axes, grid: OccupancyGrid) -> None:
    """The cells in view, at about one per pixel: of more, the highest shows, so that no wall is lost."""
    map_from_cells = _map_from_cells(grid)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    in_cells = map_from_cells.inverted().transform([(left, bottom), (right, bottom), (right, top), (left, top)])
    height, width = grid.shape
    first_col, first_row = np.clip(np.floor(in_cells.min(axis=0)), 0, (width, height)).astype(int)
    last_col, last_row = np.clip(np.ceil(in_cells.max(axis=0)), 0, (width, height)).astype(int)
    cells = grid.cells[first_row:last_row, first_col:last_col]
    if not cells.size:
        return
    pixels = axes.get_window_extent().width * grid.resolution / (right - left)
    side = max(1, int(1.0 / pixels))
    for axis in (0, 1):
        cells = np.maximum.reduceat(cells, np.arange(0, cells.shape[axis], side), axis=axis)
    rows, cols = cells.shape
    axes.imshow(
        _colours()[cells],  # -1 is the last of them
        origin="lower",
        extent=(first_col, first_col + cols * side, first_row, first_row + rows * side),
        transform=map_from_cells + axes.transData,
        interpolation="nearest" if pixels > 2 else "hanning",
        zorder=1,
    )
    axes.set(xlim=(left, right), ylim=(bottom, top))


def _colours() -> NDArray[np.uint8]:
    """Colours of the cell values 0..100 and -1, (102, 3)."""
    share = np.linspace(0.0, 1.0, 101)[:, None]
    shades = (1.0 - share) * np.array(_FREE) + share * np.array(_OCCUPIED)
    return np.vstack([shades, _UNKNOWN]).astype(np.uint8)


def _draw_scan(axes: Axes, ends: _Points, laser: _Points, *, label: str) -> None:
    if not len(ends):
        return
    if len(laser):
        beams = np.stack([np.broadcast_to(laser[:, :2], ends.shape), ends], axis=1)
        strength = float(np.clip(40.0 / len(ends), 0.04, 0.3))
        axes.add_collection(LineCollection(list(beams), colors=_SCAN, linewidths=0.8, alpha=strength, zorder=3))
    axes.plot(*ends.T, "o", ms=2.6, mfc=_SCAN, mec="none", zorder=5, label=label)


def _outline(shape: Shape, pose: Pose) -> _Points:
    """Corners of a shape in the map frame; a disc has many."""
    corners = shape.points
    if shape.radius is not None:
        angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        corners = shape.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    outline: _Points = Affine2D().rotate(pose.yaw).translate(pose.x, pose.y).transform(corners)
    return outline


def _draw_path(axes: Axes, path: _Points, *, labels: tuple[str, str] = ("_", "_")) -> None:
    """Where a path starts, and the path over a white seam, in at most some thousand pieces."""
    axes.plot(*path[0, :2], "o", ms=8, mfc="white", mec=_TIME(0.0), mew=2.2, zorder=6, label=labels[0])
    points = path[:: max(1, len(path) // 4000), :2]
    if len(path) > 1:
        points = np.vstack([points, path[-1:, :2]])
    axes.plot(*points.T, color="white", lw=4.2, alpha=0.85, solid_joinstyle="round", zorder=4)
    pieces = list(np.stack([points[:-1], points[1:]], axis=1))
    colours = _TIME(np.linspace(0.0, 1.0, len(pieces)))
    axes.add_collection(LineCollection(pieces, colors=colours, linewidths=2.0, capstyle="round", zorder=4))
    axes.plot([], [], color=_TIME(0.5), lw=2.0, label=labels[1])


def _draw_robot(axes: Axes, pose: _Points, *, label: str = "_") -> None:
    """An arrow along the heading, or a disc if there is none."""
    look: dict[str, Any] = {"marker": "o", "ms": 11}
    if len(pose) == 3:
        look = {"marker": MarkerStyle(_ARROW, transform=Affine2D().rotate(pose[2])), "ms": 20}
    axes.plot(*pose[:2], ls="none", mfc=_ROBOT, mec="white", mew=1.3, zorder=8, label=label, **look)


# --- Where it is drawn ---


def _map_from_cells(grid: OccupancyGrid) -> Affine2D:
    x, y, yaw = grid.origin
    return Affine2D().scale(grid.resolution).rotate(yaw).translate(x, y)


def _corners(grid: OccupancyGrid) -> _Points:
    """Returns the corners of a grid in the map frame, (4, 2)."""
    height, width = grid.shape
    corners: _Points = _map_from_cells(grid).transform([(0, 0), (width, 0), (width, height), (0, height)])
    return corners


def _known_around(grid: OccupancyGrid, drive: _Points) -> _Points:
    """Corners in the map frame, (2, 2), of the known cells, no farther from a drive than it is long (or 10 m)."""
    known = grid.cells >= 0
    rows, cols = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        rows, cols = (np.arange(size) for size in grid.shape)
    left, right, bottom, top = cols[0], cols[-1] + 1, rows[0], rows[-1] + 1
    corners = _map_from_cells(grid).transform([(left, bottom), (right, bottom), (right, top), (left, top)])
    low, high = drive.min(axis=0), drive.max(axis=0)
    far = max(10.0, (high - low).max())
    around: _Points = np.clip([corners.min(axis=0), corners.max(axis=0)], low - far, high + far)
    return around


def _view(points: _Points, *, margin: float) -> _Points:
    """Left lower and right upper corner, (2, 2), of what holds all points and a margin, not too slim to look at."""
    low, high = points.min(axis=0), points.max(axis=0)
    longest = max((high - low).max(), 1e-3)
    half = np.maximum((high - low) / 2 + margin * longest, longest / 2 * _SHORTEST_SIDE / _LONGEST_SIDE)
    return np.array([(low + high) / 2 - half, (low + high) / 2 + half])


def _figure(view: _Points, title: str | None) -> tuple[Figure, Axes]:
    """A figure that fits around its axes, which show a view, x and y at one scale."""
    low, high = view
    width, height = (high - low) * _LONGEST_SIDE / (high - low).max()
    full_width, full_height = width + _LEFT + _RIGHT, height + _BOTTOM + _TOP + (_TITLE if title else 0.0)
    figure = Figure(figsize=(full_width, full_height), dpi=_DPI)
    box = (_LEFT / full_width, _BOTTOM / full_height, width / full_width, height / full_height)
    axes = figure.add_axes(box, xlabel="x [m]", ylabel="y [m]", aspect="equal")
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    if title:
        axes.set_title(title)
    return figure, axes


# --- What is taken and given ---


def _rows(name: str, values: ArrayLike | Pose | None, widths: tuple[int, ...]) -> _Points:
    """Rows of finite numbers; a single one may come bare, and None is none."""
    if values is None:
        return np.zeros((0, widths[-1]))
    rows = np.array(tuple(values) if isinstance(values, Pose) else values, np.float64)
    if rows.ndim == 1 and rows.size:
        rows = rows[None]
    if rows.ndim != 2 or rows.shape[1] not in widths:
        needed = " or ".join(f"(N, {width})" for width in widths)
        raise ValueError(f"{name} must have shape {needed}, got {np.shape(rows)}")
    if not np.isfinite(rows).all():
        raise ValueError(f"{name} must be finite, got {rows[~np.isfinite(rows).all(axis=1)][0]}")
    return rows


def _picture(file: str | os.PathLike[str]) -> Path:
    """The file of a picture, in a folder that is there."""
    path = Path(file)
    if path.suffix.lower() not in _METADATA:
        raise ValueError(f"a picture's file must end in {', '.join(_METADATA)}, got {str(path)!r}")
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "Cannot save a picture over a folder", str(path))
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, "No such folder to save a picture in", str(path.parent))
    return path


def _save(figure: Figure, picture: Path) -> None:
    """Write the figure, with a legend below its axes, complete or not at all."""
    (axes,) = figure.axes
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(0.0, -_LEGEND * _DPI / axes.get_window_extent().height),
        ncols=5,
        borderaxespad=0.0,
        borderpad=0.0,
        handletextpad=0.4,
        columnspacing=1.8,
    )
    suffix = picture.suffix.lower()
    with tempfile.TemporaryDirectory(prefix=".picture-", dir=picture.parent) as drafts:
        draft = Path(drafts) / picture.name
        figure.savefig(draft, format=suffix[1:], dpi=_DPI, metadata=_METADATA[suffix])
        os.replace(draft, picture)
