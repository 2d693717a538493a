"""Map files: reads and writes an OccupancyGrid as a map_server YAML file and its image.

The format follows nav2_map_server (`map_io.cpp`). The YAML file has these keys; others are ignored:

- `image`: path of the image, absolute or relative to the YAML file;
- `resolution`: side of a cell [m];
- `origin`: pose [x, y, yaw] of the lower-left corner in the map frame [m, m, rad];
- `negate`, `occupied_thresh`, `free_thresh`: how pixels become cells, see `load_map`;
- `mode`: trinary (default), scale or raw.
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

# Values that the map savers of Nav2 and ROS 1 write. With these thresholds, both map servers read grey 205 as unknown.
_SAVED_THRESHOLDS = {"occupied_thresh": 0.65, "free_thresh": 0.196}
_SAVED_GREYS = {0: 254, 100: 0, -1: 205}


def load_map(
    path: str | os.PathLike[str], *, occupied_threshold: int = 60, unknown: Literal["free", "occupied"] = "free"
) -> OccupancyGrid:
    """Loads a map from a map_server YAML file and its image.

    The bottom row of the image becomes row 0 of the grid. Let `pixel` be the 8-bit Rec. 601 luma of a pixel and
    p = (255 - pixel) / 255, or p = pixel / 255 with `negate`. The value of its cell depends on the mode:

    - trinary: 100 if p >= occupied_thresh, 0 if p <= free_thresh, else -1;
    - scale: the same, but round(100 * (p - free_thresh) / (occupied_thresh - free_thresh)) between the thresholds;
    - raw: `pixel` if it is at most 100, else -1; `negate` and the thresholds have no effect.

    In trinary and scale mode a pixel that is not fully opaque becomes -1.

    The image may be PNM (P1 to P6), PNG, JPEG, BMP, TIFF or GIF. Samples of more than 8 bits are scaled to 8 bits and
    rounded down. Colours of 16-bit samples can come out one level too high, because Pillow keeps only their high byte.

    Args:
        path: The YAML file.
        occupied_threshold: Cells of at least this value block beams. Not to be confused with `occupied_thresh` in the
            YAML file, which turns pixels into cells.
        unknown: Treatment of unknown cells, which have the value -1: "free", or "occupied", which blocks beams.

    Returns:
        The grid.

    Raises:
        OSError: A file cannot be read; FileNotFoundError if it does not exist.
        ValueError: The YAML file or the image is invalid or truncated. The message gives the file, the key, its value and
            the requirement.

    Warns:
        UserWarning: The yaw of the origin is NaN, as in some real files; it is read as 0.

    Sources: nav2_map_server, map_io.cpp; GraphicsMagick 1.3, image.h and pnm.c; Netpbm, pgm(5).
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
    """Saves a grid as a map_server YAML file and a PGM image of the same stem next to it.

    `load_map` restores the same cells, resolution and origin, bit by bit. If all cells are -1, 0 or 100 the mode is
    trinary, which every map server reads; otherwise it is raw. The format cannot store `occupied_threshold` and `unknown`;
    pass them to `load_map` again.

    Existing files are replaced atomically, first the image and then the YAML file, once both are written completely.

    Args:
        grid: The grid.
        path: The YAML file; must end in .yaml or .yml.

    Raises:
        ValueError: The path has another ending.
        OSError: The folder does not exist or cannot be written.
    """
    yaml_path = Path(path)
    if yaml_path.suffix.lower() not in (".yaml", ".yml"):
        raise ValueError(f"the path of a map must end in .yaml or .yml, got {str(yaml_path)!r}")
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
    """Entries of the YAML file, after all checks."""

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
        raise ValueError(f"{path}: missing {', '.join(missing)}; the required keys are {', '.join(_REQUIRED_KEYS)}")
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
    """Entries of the YAML file, with every scalar as text.

    PyYAML's types do not match those of yaml-cpp, which Nav2 uses: it reads 0.05e0 as a string, 010 as 8 and 1:30 as 90.
    """
    text = path.read_bytes()
    try:
        entries = yaml.load(text, yaml.BaseLoader)
    except (yaml.YAMLError, RecursionError) as error:
        raise ValueError(f"{path}: not valid YAML: {error}") from error
    if not isinstance(entries, dict):
        raise ValueError(f"{path}: must contain a YAML mapping, got {str(entries)[:40]!r}")
    return entries


def _image(entries: _Entries) -> str:
    image = entries["image"]
    if not isinstance(image, str) or not image:
        raise _invalid("image", "the path of an image", image)
    return image


def _resolution(entries: _Entries) -> float:
    resolution = _number(entries["resolution"])
    if not 0 < resolution < math.inf:
        raise _invalid("resolution", "a positive number [m]", entries["resolution"])
    return resolution


def _origin(entries: _Entries) -> tuple[float, float, float]:
    origin = entries["origin"]
    if not isinstance(origin, list) or len(origin) != 3:
        raise _invalid("origin", "three numbers [x, y, yaw]", origin)
    x, y, yaw = map(_number, origin)
    if str(origin[2]).lower().lstrip("+-.") == "nan":
        warnings.warn(f"the yaw of the map's origin is {origin[2]}; 0 is used instead", stacklevel=4)
        yaw = 0.0
    if not all(map(math.isfinite, (x, y, yaw))):
        raise _invalid("origin", "three finite numbers [x, y, yaw]", origin)
    return x, y, yaw


def _negate(entries: _Entries) -> bool:
    negate = _TRUTH_VALUES.get(str(entries["negate"]).lower())
    if negate is None:
        raise _invalid("negate", "0, 1, false or true", entries["negate"])
    return negate


def _thresholds(entries: _Entries) -> tuple[float, float]:
    """free_thresh and occupied_thresh. They may be equal, as in some real maps."""
    free, occupied = (_number(entries[key]) for key in ("free_thresh", "occupied_thresh"))
    for key, threshold in (("free_thresh", free), ("occupied_thresh", occupied)):
        if not 0 <= threshold <= 1:
            raise _invalid(key, "a number from 0 to 1", entries[key])
    if free > occupied:
        raise _invalid("free_thresh", f"at most occupied_thresh, which is {occupied}", entries["free_thresh"])
    return free, occupied


def _mode(entries: _Entries) -> str:
    mode = entries.get("mode", "trinary")
    if not isinstance(mode, str) or mode not in _MODES:
        raise _invalid("mode", "trinary, scale or raw", mode)
    return mode


def _number(entry: object) -> float:
    """Value of a YAML scalar as a number; NaN if it is not a number."""
    try:
        return float(entry) if isinstance(entry, str) else math.nan
    except ValueError:
        return math.nan


def _invalid(key: str, needed: str, entry: object) -> ValueError:
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
    # default_flow_style=None writes the origin on one line. safe_dump writes floats with all their digits.
    return yaml.safe_dump(description, sort_keys=False, default_flow_style=None, allow_unicode=True)


# --- Pixels and cells ---


def _cells_from_image(image: MapImage, description: _Description) -> _Cells:
    # bytes.translate needs one byte of memory per pixel; indexing a NumPy table needs nine.
    table = _cell_by_grey(description).tobytes()
    cells = np.frombuffer(image.grey[::-1].tobytes().translate(table), np.int8).reshape(image.grey.shape)
    if image.alpha is None or description.mode == "raw":
        return cells
    return np.where(image.alpha[::-1] == 255, cells, np.int8(-1))


def _cell_by_grey(description: _Description) -> _Cells:
    """Lookup table (256,) int8 from the grey of a pixel to the value of its cell."""
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
    """Returns a mode that represents all cells exactly, and the 8-bit pixels in that mode, top row first."""
    octets = cells[::-1].tobytes()
    others = octets.translate(None, bytes(cell & 0xFF for cell in _SAVED_GREYS))
    if not others:
        table = bytearray(256)
        for cell, grey in _SAVED_GREYS.items():
            table[cell & 0xFF] = grey
        return "trinary", octets.translate(table)
    # -1 becomes the byte 255: Nav2 reads values above 100 as unknown, and ROS 1 reads the byte as -1.
    return "raw", octets


# --- Files ---


def _write_together(contents: dict[Path, bytes]) -> None:
    """Writes files into one folder: completes all of them first, then replaces the existing ones in order."""
    for path in contents:
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, "Cannot save a map over a folder", str(path))
    folder = next(iter(contents)).parent
    if not folder.is_dir():
        raise FileNotFoundError(errno.ENOENT, "Cannot save a map: no such folder", str(folder))
    with tempfile.TemporaryDirectory(prefix=".map-", dir=folder) as temporary:
        for path, data in contents.items():
            (Path(temporary) / path.name).write_bytes(data)
        for path in contents:
            os.replace(Path(temporary) / path.name, path)
