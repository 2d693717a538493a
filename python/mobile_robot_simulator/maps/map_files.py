"""Maps on disk: map_server YAML with its image, to and from an OccupancyGrid.

The rules are those of nav2_map_server (`map_io.cpp`).
The YAML names an `image` (relative to the YAML's folder), a `resolution` in metres per cell, an `origin` [x, y, yaw]
of the lower-left corner, `negate`, `occupied_thresh`, `free_thresh`, and a `mode`: trinary (the default), scale or raw.
Other keys are passed over.
"""

from __future__ import annotations

import errno
import math
import os
import tempfile
import warnings
from pathlib import Path
from typing import Literal, NamedTuple, TypeAlias

import numpy as np
import yaml
from numpy.typing import NDArray

from .._core import OccupancyGrid
from .map_image import MapImage, read_image

__all__ = ["load_map", "save_map"]

_Cells: TypeAlias = NDArray[np.int8]
_Entries: TypeAlias = dict[object, object]

_MODES = ("trinary", "scale", "raw")
_REQUIRED_KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
_TRUTH_VALUES = {"0": False, "1": True, "false": False, "true": True}

# What Nav2's and ROS 1's savers write; 205 is unknown under these thresholds in both.
_SAVED_THRESHOLDS = {"occupied_thresh": 0.65, "free_thresh": 0.196}
_SAVED_GREYS = {0: 254, 100: 0, -1: 205}


def load_map(
    path: str | os.PathLike[str], *, occupied_threshold: int = 60, unknown: Literal["free", "occupied"] = "free"
) -> OccupancyGrid:
    """Grid of a map_server YAML and its image.

    The bottom row of the image is row 0 of the grid. The cell of a pixel, with p = (255 - pixel) / 255, or pixel / 255
    under negate, where pixel is the 8-bit Rec. 601 luma:

    - trinary: 100 where p >= occupied_thresh, else 0 where p <= free_thresh, else -1;
    - scale: in between, round(100 * (p - free_thresh) / (occupied_thresh - free_thresh));
    - raw: the pixel itself up to 100, else -1, whatever negate and the thresholds are.

    In trinary and scale a pixel that is not fully opaque is -1. Samples of more than 8 bits are scaled down, rounding
    down; colours of 16-bit samples may come out one level high, since Pillow keeps only their high byte. The image may
    be PNM (P1 to P6), PNG, JPEG, BMP, TIFF or GIF. A yaw of NaN, which real files have, is taken as 0 with a warning.

    path: the YAML file; its image is relative to its folder, or absolute.
    occupied_threshold: the cells that block beams; not the YAML's occupied_thresh, which turns pixels into cells.
    unknown: whether cells of value -1 block beams, "free" or "occupied".
    raises: OSError if a file cannot be read, FileNotFoundError if it is not there; ValueError if what it holds is not a
    map, with the file, the entry, its value and what was needed. Half an image is not a map.
    source: nav2_map_server, map_io.cpp; GraphicsMagick 1.3, image.h and pnm.c; Netpbm, pgm(5).
    """
    yaml_path = Path(path)
    description = _read_description(yaml_path)
    image = read_image(description.image_path, yaml_path)
    return OccupancyGrid(
        _cells_from_image(image, description),
        resolution=description.resolution,
        origin=description.origin,
        occupied_threshold=occupied_threshold,
        unknown=unknown,
    )


def save_map(grid: OccupancyGrid, path: str | os.PathLike[str]) -> None:
    """Write a grid as a map_server YAML, and a PGM of the same stem beside it.

    load_map gives back the same cells, resolution and origin to the last bit. Cells that are all -1, 0 or 100 are
    written in mode trinary, which every map server reads, others in mode raw. The format has no place for
    occupied_threshold and unknown: pass them to load_map again.

    Older files are replaced, first the image, then the YAML: each in one step, and neither before both are complete.

    path: the YAML file, ending in .yaml or .yml.
    raises: ValueError if path ends otherwise; OSError if its folder is not there or cannot be written.
    """
    yaml_path = Path(path)
    if yaml_path.suffix.lower() not in (".yaml", ".yml"):
        raise ValueError(f"path of a map must end in .yaml or .yml, got {str(yaml_path)!r}")
    image_path = yaml_path.with_suffix(".pgm")
    mode, pixels = _pixels_from_cells(grid.cells)
    height, width = grid.shape
    _write_together(
        {
            image_path: b"P5\n%d %d\n255\n" % (width, height) + pixels,
            yaml_path: _describe(grid, image_path.name, mode).encode(),
        }
    )


# --- The YAML ---


class _Description(NamedTuple):
    """What the YAML says, checked."""

    image_path: Path
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


def _read_description(path: Path) -> _Description:
    entries = _parse_yaml(path)
    missing = [key for key in _REQUIRED_KEYS if key not in entries]
    if missing:
        raise ValueError(f"{path}: missing {', '.join(missing)}; a map needs {', '.join(_REQUIRED_KEYS)}")
    try:
        free_thresh, occupied_thresh = _thresholds(entries)
        return _Description(
            image_path=path.parent / _image(entries),
            resolution=_resolution(entries),
            origin=_origin(entries),
            negate=_negate(entries),
            free_thresh=free_thresh,
            occupied_thresh=occupied_thresh,
            mode=_mode(entries),
        )
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _parse_yaml(path: Path) -> _Entries:
    """Entries of the YAML's mapping, with every scalar as text.

    Text, because yaml-cpp, which Nav2 reads with, resolves no types either, while PyYAML takes 0.05e0 for a string, 010
    for 8 and 1:30 for 90.
    """
    text = path.read_bytes()
    try:
        entries = yaml.load(text, yaml.BaseLoader)
    except (yaml.YAMLError, RecursionError) as error:
        raise ValueError(f"{path}: not valid YAML: {error}") from error
    if not isinstance(entries, dict):
        raise ValueError(f"{path}: must hold a YAML mapping, got {str(entries)[:40]!r}")
    return entries


def _image(entries: _Entries) -> str:
    image = entries["image"]
    if not isinstance(image, str) or not image:
        raise _refusal("image", "the path of an image", image)
    return image


def _resolution(entries: _Entries) -> float:
    resolution = _number(entries["resolution"])
    if not 0 < resolution < math.inf:
        raise _refusal("resolution", "a positive number [m]", entries["resolution"])
    return resolution


def _origin(entries: _Entries) -> tuple[float, float, float]:
    origin = entries["origin"]
    if not isinstance(origin, list) or len(origin) != 3:
        raise _refusal("origin", "three numbers [x, y, yaw]", origin)
    x, y, yaw = map(_number, origin)
    if str(origin[2]).lower().lstrip("+-.") == "nan":
        warnings.warn(f"yaw of the map's origin is {origin[2]}, taken as 0", stacklevel=4)
        yaw = 0.0
    if not all(map(math.isfinite, (x, y, yaw))):
        raise _refusal("origin", "three finite numbers [x, y, yaw]", origin)
    return x, y, yaw


def _negate(entries: _Entries) -> bool:
    negate = _TRUTH_VALUES.get(str(entries["negate"]).lower())
    if negate is None:
        raise _refusal("negate", "0, 1, false or true", entries["negate"])
    return negate


def _thresholds(entries: _Entries) -> tuple[float, float]:
    """free_thresh and occupied_thresh; equal ones are in order, since real maps have them."""
    free, occupied = (_number(entries[key]) for key in ("free_thresh", "occupied_thresh"))
    for key, threshold in (("free_thresh", free), ("occupied_thresh", occupied)):
        if not 0 <= threshold <= 1:
            raise _refusal(key, "a number from 0 to 1", entries[key])
    if free > occupied:
        raise _refusal("free_thresh", f"at most occupied_thresh, which is {occupied}", entries["free_thresh"])
    return free, occupied


def _mode(entries: _Entries) -> str:
    mode = entries.get("mode", "trinary")
    if not isinstance(mode, str) or mode not in _MODES:
        raise _refusal("mode", "trinary, scale or raw", mode)
    return mode


def _number(entry: object) -> float:
    """Value of a YAML scalar as a number, NaN if it is none."""
    try:
        return float(entry) if isinstance(entry, str) else math.nan
    except ValueError:
        return math.nan


def _refusal(key: str, needed: str, entry: object) -> ValueError:
    return ValueError(f"{key} must be {needed}, got {entry!r}")


def _describe(grid: OccupancyGrid, image_name: str, mode: str) -> str:
    description = {
        "image": image_name,
        "mode": mode,
        "resolution": grid.resolution,
        "origin": [float(coordinate) for coordinate in grid.origin],
        "negate": 0,
        **_SAVED_THRESHOLDS,
    }
    # default_flow_style None writes the origin in one line; safe_dump writes floats in full.
    return yaml.safe_dump(description, sort_keys=False, default_flow_style=None, allow_unicode=True)


# --- Pixels and cells ---


def _cells_from_image(image: MapImage, description: _Description) -> _Cells:
    # bytes.translate looks a cell up in one byte of memory per pixel; NumPy's indexing takes eight more.
    table = _cell_of_each_grey(description).tobytes()
    cells = np.frombuffer(image.grey[::-1].tobytes().translate(table), np.int8).reshape(image.grey.shape)
    if image.alpha is None or description.mode == "raw":
        return cells
    return np.where(image.alpha[::-1] == 255, cells, np.int8(-1))


def _cell_of_each_grey(description: _Description) -> _Cells:
    """(256,) int8: the cell that each 8-bit grey stands for."""
    greys = np.arange(256)
    if description.mode == "raw":
        return np.where(greys <= 100, greys, -1).astype(np.int8)
    free, occupied = description.free_thresh, description.occupied_thresh
    occupancy = (greys if description.negate else 255 - greys) / 255
    between = np.full(256, -1.0)
    if description.mode == "scale" and free < occupied:
        between = np.floor(np.clip((occupancy - free) / (occupied - free), 0, 1) * 100 + 0.5)
    return np.select([occupancy >= occupied, occupancy <= free], [100, 0], between).astype(np.int8)


def _pixels_from_cells(cells: _Cells) -> tuple[str, bytes]:
    """Mode that gives back exactly these cells, and its 8-bit pixels, top row first."""
    octets = cells[::-1].tobytes()
    others = octets.translate(None, bytes(cell & 0xFF for cell in _SAVED_GREYS))
    if not others:
        table = bytearray(256)
        for cell, grey in _SAVED_GREYS.items():
            table[cell & 0xFF] = grey
        return "trinary", octets.translate(table)
    # -1 is the octet 255, which is outside of 0..100 and so unknown to Nav2, and -1 as it stands to ROS 1.
    return "raw", octets


# --- Files ---


def _write_together(contents: dict[Path, bytes]) -> None:
    """Write files of one folder, in order, each complete or not at all."""
    for path in contents:
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, "Cannot save a map over a folder", str(path))
    folder = next(iter(contents)).parent
    if not folder.is_dir():
        raise FileNotFoundError(errno.ENOENT, "No such folder to save a map in", str(folder))
    with tempfile.TemporaryDirectory(prefix=".map-", dir=folder) as drafts:
        for path, data in contents.items():
            (Path(drafts) / path.name).write_bytes(data)
        for path in contents:
            os.replace(Path(drafts) / path.name, path)
