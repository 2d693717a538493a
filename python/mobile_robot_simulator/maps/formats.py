"""Formats of maps: finds the format of a file and reads it."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Literal, NamedTuple

from .._core import OccupancyGrid
from ..quoting import quoted
from ..user_files import open_regular
from .cell_map import CellMap, check_length
from .dxf import read_dxf
from .houseexpo import read_houseexpo
from .map_files import map_path, read_map_server
from .map_image import is_image
from .movingai import read_movingai
from .sdf_world import read_sdf_world
from .svg import read_svg

__all__ = ["load_map"]


class _Format(NamedTuple):
    """A format that has no map_server YAML file."""

    name: str
    endings: tuple[str, ...]
    start: re.Pattern[bytes]
    """What a file begins with."""

    read: Callable[..., CellMap]
    """Reads a file with a side of the cells [m] and, if it is a drawing, the length of its unit."""

    resolution: float
    """Side of the cells if the user gives none [m]."""

    is_drawing: bool = False
    """Whether the user may give the length of a unit."""


_XML = rb"(\xef\xbb\xbf)?\s*(<\?xml.*?\?>\s*)?(<!--.*?-->\s*|<!DOCTYPE[^>]*>\s*)*"
"""What an XML file may have before its first element."""

_DXF = rb"AutoCAD Binary DXF|\s*(999\s*\n[^\n]*\n\s*)*0\s*\n\s*SECTION\b"
"""What a DXF file begins with: the mark of binary ones, or the first group after comments."""

_FORMATS = (
    _Format("MovingAI map", (".map",), re.compile(rb"\s*type[ \t]"), read_movingai, 1.0),
    _Format("HouseExpo", (".json",), re.compile(rb'\s*\{\s*"'), read_houseexpo, 0.05),
    _Format("Gazebo world", (".world", ".sdf"), re.compile(_XML + rb"<sdf\b", re.DOTALL), read_sdf_world, 0.05),
    _Format("SVG", (".svg",), re.compile(_XML + rb"<svg\b", re.DOTALL), read_svg, 0.05, is_drawing=True),
    _Format("DXF", (".dxf",), re.compile(_DXF, re.DOTALL), read_dxf, 0.05, is_drawing=True),
)

_START_LENGTH = 4096


def load_map(
    path: str | os.PathLike[str],
    *,
    occupied_threshold: int = 60,
    unknown: Literal["free", "occupied"] = "free",
    transparency: Literal["unknown", "averaged"] = "unknown",
    resolution: float | None = None,
    unit: float | None = None,
) -> OccupancyGrid:
    """Loads a map: a map_server YAML file with its image, or one of the formats of benchmarks.

    The format is found from the content of the file. [Worlds of benchmarks](../guides/worlds.md) says what each format
    contains, its units, and which way is up.

    Of a map_server file, the bottom row of the image becomes row 0 of the grid. Let `pixel` be the 8-bit Rec. 601 luma of a
    pixel and p = (255 - pixel) / 255, or p = pixel / 255 with `negate`. The value of its cell depends on the mode:

    - trinary: 100 if p >= occupied_thresh, 0 if p <= free_thresh, else -1;
    - scale: the same, but round(100 * (p - free_thresh) / (occupied_thresh - free_thresh)) between the thresholds;
    - raw: `pixel` if it is at most 100, else -1; `negate` and the thresholds have no effect.

    In trinary and scale mode a pixel that is not fully opaque becomes -1, as in Nav2 since April 2025 (Kilted, and Jazzy
    since 1.3.7). Earlier versions of Nav2 and ROS 1 averaged the opacity with the three colours in trinary mode;
    `transparency="averaged"` does so too.

    The optional key `materials` gives the materials of the cells; see [Surfaces](../guides/surfaces.md). Nav2 ignores it.

    The image may be PNM (P1 to P6), PNG, JPEG, BMP, TIFF or GIF. Samples of more than 8 bits are scaled to 8 bits and
    rounded down. Colours of 16-bit samples can come out one level too high, because Pillow keeps only their high byte.

    Args:
        path: The file; of a map_server map the YAML file.
        occupied_threshold: Cells of at least this value block beams. Not to be confused with `occupied_thresh` in the
            YAML file, which turns pixels into cells.
        unknown: Treatment of unknown cells, which have the value -1: "free", or "occupied", which blocks beams.
        transparency: Treatment of an image with transparency: "unknown" or "averaged", as above.
        resolution: Side of a cell [m]. None means the usual one of the format. A map_server file has its own.
        unit: Length of a unit of a drawing, SVG or DXF [m]. None means the unit of a DXF file if it gives one, else 1 m.

    Returns:
        The grid.

    Raises:
        ImportError: The file is a drawing, and the extra `worlds` is not installed.
        OSError: A file cannot be read; FileNotFoundError if it does not exist.
        TypeError: The path is not a path, or a length is not a number.
        ValueError: The format is unknown, or the file or its image is invalid or truncated. The message gives the file,
            what is wrong, and the requirement.

    Warns:
        UserWarning: The yaw of the origin is NaN, as in some real files; it is read as 0.

    Sources: nav2_map_server, map_io.cpp, before and after commit 8d69483 of 2025-04-24; GraphicsMagick 1.3, image.h and
    pnm.c; Netpbm, pgm(5).
    """
    if transparency not in ("unknown", "averaged"):
        raise ValueError(f"transparency must be 'unknown' or 'averaged', got {quoted(transparency)}")
    side = None if resolution is None else check_length("resolution", resolution)
    length = None if unit is None else check_length("unit", unit)
    place = map_path(path)
    found = _format_of(place)
    if length is not None and not (found and found.is_drawing):
        raise ValueError(f"{place}: only drawings, SVG and DXF, have a unit, so none can be given here; got {length}")
    if found is None:
        if side is not None:
            raise ValueError(f"{place}: the YAML file of a map gives its resolution, so none can be given here; got {side}")
        cell_map = read_map_server(place, is_averaged=transparency == "averaged")
    else:
        options = {"unit": length} if found.is_drawing else {}
        cell_map = found.read(place, found.resolution if side is None else side, **options)
    return OccupancyGrid(
        cell_map.cells,
        resolution=cell_map.resolution,
        origin=cell_map.origin,
        occupied_threshold=occupied_threshold,
        unknown=unknown,
        materials=cell_map.materials and cell_map.materials.numbers,
        material_table=cell_map.materials and cell_map.materials.table,
    )


def _format_of(path: Path) -> _Format | None:
    """Returns the format of a file, or None for map_server's.

    Raises:
        OSError: The file cannot be read.
        ValueError: The file has no known format. The message lists those that are known.
    """
    ending = path.suffix.lower()
    if ending in (".yaml", ".yml"):
        return None
    with open_regular(path) as file:
        start = file.read(_START_LENGTH)
    for known in _FORMATS:
        if known.start.match(start):
            return known
    for known in _FORMATS:
        if ending in known.endings:
            return known  # Its reader says what is wrong with the file.
    if is_image(path) or _may_be_yaml(start):
        return None  # As above.
    raise ValueError(f"{path}: the format of this map is unknown; {known_formats()}")


def known_formats() -> str:
    """Returns a sentence that lists the formats of maps and the usual endings of their files."""
    names = [f"{known.name} ({', '.join(known.endings)})" for known in _FORMATS]
    return f"the known formats are map_server (.yaml, .yml), {', '.join(names)}"


def _may_be_yaml(start: bytes) -> bool:
    """True if a key of a map_server file is near the start of this one, in any encoding."""
    return re.search(rb"image|resolution|origin|negate|thresh", start.replace(b"\0", b"")) is not None
