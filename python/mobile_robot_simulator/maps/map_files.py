"""Map files: reads and writes an OccupancyGrid as a map_server YAML file and its image.

The format follows nav2_map_server (`map_io.cpp`). The YAML file has these keys; others are ignored:

- `image`: path of the image, absolute or relative to the YAML file;
- `resolution`: side of a cell [m];
- `origin`: pose [x, y, yaw] of the lower-left corner in the map frame [m, m, rad];
- `negate`, `occupied_thresh`, `free_thresh`: how pixels become cells, see `load_map`;
- `mode`: trinary (default), scale or raw;
- `materials`: optional and unknown to Nav2, see `material_layer`.
"""

from __future__ import annotations

import math
import os
import re
import warnings
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import yaml
from numpy.typing import NDArray

from .._core import OccupancyGrid
from ..new_files import write_files
from ..quoting import quoted
from ..user_files import read_text
from ..yaml_documents import MappingNode, Node, ScalarNode, SequenceNode, entries_of, invalid, parse
from .cell_map import CellMap
from .map_image import MapImage, is_image, read_image
from .material_layer import described, read_layer

__all__ = ["read_map_server", "save_map"]

_Cells: TypeAlias = NDArray[np.int8]
_Entries: TypeAlias = dict[str, Node]

_MODES = ("trinary", "scale", "raw")
_REQUIRED_KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")

# Integers and truth values of yaml-cpp. Nav2 reads `negate` as an integer if it is one, and takes all but 0 as true.
_INTEGER = re.compile(r"[+-]?(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
_TRUTH_VALUES = {"n": False, "no": False, "false": False, "off": False, "y": True, "yes": True, "true": True, "on": True}

# Values that the map savers of Nav2 and ROS 1 write. With these thresholds, both map servers read grey 205 as unknown.
_SAVED_THRESHOLDS = {"occupied_thresh": 0.65, "free_thresh": 0.196}
_SAVED_GREYS = {0: 254, 100: 0, -1: 205}


def read_map_server(path: Path, *, is_averaged: bool) -> CellMap:
    """Returns the cells of a map_server YAML file and its image, as `load_map` defines them.

    Args:
        path: The YAML file.
        is_averaged: Whether the opacity of a pixel is averaged with its colours in trinary mode.

    Raises:
        OSError: A file cannot be read.
        ValueError: The YAML file or the image is invalid or truncated. The message gives the file, the key, its value and
            the requirement.
    """
    description = _read_description(path)
    image = read_image(description.image_path, path)
    cells = _cells_from_image(image, description, is_averaged=is_averaged)
    node = description.materials
    materials = None if node is None else read_layer(node, path, cells.shape)
    return CellMap(cells, description.resolution, description.origin, materials)


def save_map(grid: OccupancyGrid, path: str | os.PathLike[str]) -> None:
    """Saves a grid as a map_server YAML file and a PGM image of the same stem next to it.

    `load_map` restores the same cells, resolution and origin, bit by bit. If all cells are -1, 0 or 100 the mode is
    trinary, which every map server reads; otherwise it is raw. The format cannot store `occupied_threshold` and `unknown`;
    pass them to `load_map` again. The materials of a grid that has some go to a second image, whose name ends in
    `_materials.pgm`.

    Existing files are replaced atomically, first the image and then the YAML file, once both are written completely. The
    folder must exist.

    Args:
        grid: The grid.
        path: The YAML file; must end in .yaml or .yml.

    Raises:
        ValueError: The path has another ending.
        TypeError: The grid is not an `OccupancyGrid`, or the path is not a path.
        OSError: The folder does not exist or cannot be written.
    """
    if not isinstance(grid, OccupancyGrid):
        raise TypeError(f"the grid must be an OccupancyGrid, got {quoted(grid)}")
    yaml_path = map_path(path)
    if yaml_path.suffix.lower() not in (".yaml", ".yml"):
        raise ValueError(f"the path of a map must end in .yaml or .yml, got {quoted(str(yaml_path))}")
    image_path = yaml_path.with_suffix(".pgm")
    mode, pixels = _pixels_from_cells(grid.cells)
    height, width = grid.shape
    header = b"P5\n%d %d\n255\n" % (width, height)
    files = {image_path: header + pixels}
    materials = grid.materials
    layer_path = image_path.with_name(f"{image_path.stem}_materials.pgm")
    if materials is not None:
        files[layer_path] = header + materials[::-1].tobytes()
    text = _describe(grid, image_path.name, mode, None if materials is None else layer_path.name)
    write_files({**files, yaml_path: text.encode()})


def map_path(path: object) -> Path:
    """Returns the path of a map after checking that it is one.

    Raises:
        TypeError: It is neither a text nor a path.
        ValueError: It is empty.
    """
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"the path of a map must be a text or a Path, got {quoted(path)}")
    if not os.fspath(path):
        raise ValueError("the path of a map must name a file, got ''")
    return Path(path)


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
    materials: Node | None


def _read_description(path: Path) -> _Description:
    try:
        text = read_text(path)
        root = parse(text, path, as_nav2=True)
    except ValueError:
        if hint := _image_hint(path):
            raise ValueError(hint) from None
        raise
    if not isinstance(root, MappingNode):
        raise ValueError(_image_hint(path) or f"{path}: must contain a YAML mapping, got {quoted(text.strip())}")
    entries = entries_of(root, path)
    missing = [key for key in _REQUIRED_KEYS if key not in entries]
    if missing:
        raise ValueError(f"{path}: missing {', '.join(missing)}; the required keys are {', '.join(_REQUIRED_KEYS)}")
    try:
        free_thresh, occupied_thresh = _thresholds(entries)
        return _Description(
            image_path=_image_path(path, entries),
            resolution=_resolution(entries),
            origin=_origin(entries),
            negate=_negate(entries),
            free_thresh=free_thresh,
            occupied_thresh=occupied_thresh,
            mode=_mode(entries),
            materials=entries.get("materials"),
        )
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _image_hint(path: Path) -> str:
    """Returns a message if the given file is an image and not a YAML file, otherwise an empty text."""
    if not is_image(path):
        return ""
    beside = path.with_suffix(".yaml")
    return f"{path}: this is an image; give the YAML file of the map" + (f", {beside}" if beside.is_file() else "")


def _image_path(yaml_path: Path, entries: _Entries) -> Path:
    """Returns the path of the image: absolute, from the home folder if it begins with ~/, or relative to the YAML file."""
    image = _text(entries["image"])
    if not image:
        raise invalid("image", entries["image"], "the path of an image")
    if image.startswith("~/") and not (yaml_path.parent / image).is_file():
        return Path(image).expanduser()
    return yaml_path.parent / os.fsdecode(image.encode("utf-8", "surrogateescape"))


def _resolution(entries: _Entries) -> float:
    resolution = _number(entries["resolution"])
    if not 0 < resolution < math.inf:
        raise invalid("resolution", entries["resolution"], "a positive number [m]")
    return resolution


def _origin(entries: _Entries) -> tuple[float, float, float]:
    origin = entries["origin"]
    if not isinstance(origin, SequenceNode) or len(origin.value) != 3:
        raise invalid("origin", origin, "three numbers [x, y, yaw]")
    x, y, yaw = map(_number, origin.value)
    text = _text(origin.value[2])
    if text.lower().lstrip("+-.") == "nan":
        warnings.warn(f"the yaw of the map's origin is {text}; 0 is used instead", stacklevel=5)
        yaw = 0.0
    if not all(map(math.isfinite, (x, y, yaw))):
        raise invalid("origin", origin, "three finite numbers [x, y, yaw]")
    return x, y, yaw


def _negate(entries: _Entries) -> bool:
    text = _text(entries["negate"])
    if _INTEGER.fullmatch(text):
        return any(digit not in "+-0xX" for digit in text)
    truth = _TRUTH_VALUES.get(text.lower())
    if truth is None or text not in (text.lower(), text.upper(), text.capitalize()):
        raise invalid("negate", entries["negate"], "0, 1, no, yes, off, on, false or true")
    return truth


def _thresholds(entries: _Entries) -> tuple[float, float]:
    """free_thresh and occupied_thresh. They may be equal, as in some real maps."""
    free, occupied = (_number(entries[key]) for key in ("free_thresh", "occupied_thresh"))
    for key, threshold in (("free_thresh", free), ("occupied_thresh", occupied)):
        if not 0 <= threshold <= 1:
            raise invalid(key, entries[key], "a number from 0 to 1")
    if free > occupied:
        raise invalid("free_thresh", entries["free_thresh"], f"at most occupied_thresh, which is {occupied}")
    return free, occupied


def _mode(entries: _Entries) -> str:
    mode = _text(entries["mode"]) if "mode" in entries else "trinary"
    if mode not in _MODES:
        raise invalid("mode", entries["mode"], "trinary, scale or raw")
    return mode


def _text(node: Node) -> str:
    """Text of a scalar without the blanks around it, which a block scalar has. Empty if the node is not a scalar."""
    return node.value.strip() if isinstance(node, ScalarNode) else ""


def _number(node: Node) -> float:
    """Value of a scalar as a number; NaN if it is not a number. As yaml-cpp, it takes 0.05e0, but neither 0_05 nor 1:30."""
    text = _text(node)
    try:
        return math.nan if "_" in text else float(text)
    except ValueError:
        return math.nan


def _describe(grid: OccupancyGrid, image_name: str, mode: str, layer_name: str | None) -> str:
    description: dict[str, Any] = {
        "image": image_name,
        "mode": mode,
        "resolution": grid.resolution,
        "origin": [float(coordinate) for coordinate in grid.origin],
        "negate": 0,
        **_SAVED_THRESHOLDS,
    }
    if layer_name is not None:
        description["materials"] = described(grid, layer_name)
    # default_flow_style=None writes the origin on one line. safe_dump writes floats with all their digits.
    return yaml.safe_dump(description, sort_keys=False, default_flow_style=None, allow_unicode=True)


# --- Pixels and cells ---


def _cells_from_image(image: MapImage, description: _Description, *, is_averaged: bool) -> _Cells:
    if image.alpha is not None and is_averaged and description.mode == "trinary":
        shades = 3 * image.grey[::-1].astype(np.int16) + image.alpha[::-1]
        cells_of_shades: _Cells = np.take(_cell_by_shade(np.arange(1021) / 1020, description), shades)
        return cells_of_shades
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
    return _cell_by_shade(greys / 255, description)


def _cell_by_shade(shades: NDArray[np.float64], description: _Description) -> _Cells:
    """Values of cells (N,) int8 for shades (N,) from 0, black, to 1, white, in trinary and scale mode."""
    free, occupied = description.free_thresh, description.occupied_thresh
    occupancy = shades if description.negate else 1 - shades
    between = np.full(len(shades), -1.0)
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
