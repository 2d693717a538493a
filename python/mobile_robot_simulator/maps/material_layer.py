"""The materials of a map's cells: the optional key `materials` of a map_server YAML file, and its image.

Nav2 and ROS 1 ignore the key. It has these entries:

- `image`: path of an 8-bit image of the size of the map's, absolute or relative to the YAML file; the grey of a pixel is the
  number of a material;
- `table`: the material of each number, from 0 on: a name such as glass, or the arguments of `Material` by name, such as
  {kind: glass, reflectivity: 0.1}. Default: [wall, glass, mirror, dark].
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._core import Material, OccupancyGrid
from ..quoting import quoted
from ..yaml_documents import MappingNode, Node, ScalarNode, SequenceNode, entries_of, invalid, value_of
from .map_image import read_image

NAMES = ("wall", "glass", "mirror", "dark")
"""The names of materials, in the order of the table that a layer has by default."""

_ENTRIES = ("image", "table")
_ARGUMENTS = ("kind", "reflectivity", "return_chance", "return_angle")


class MaterialLayer(NamedTuple):
    """The materials of the cells of a map."""

    numbers: NDArray[np.uint8]
    """(H, W), row 0 at the bottom."""

    table: tuple[Material, ...]
    """The material of each number."""


def read_layer(node: Node, path: Path, shape: tuple[int, ...]) -> MaterialLayer:
    """Returns the materials that a map_server YAML file describes.

    Args:
        node: The value of the key `materials`.
        path: The YAML file.
        shape: Rows and columns of the map.

    Raises:
        OSError: The image cannot be read.
        ValueError: An entry is unknown, missing or invalid, or the image is invalid or of another size than the map's.
    """
    needed = "a mapping with the key image"
    if not isinstance(node, MappingNode):
        raise ValueError(f"{path}: {invalid('materials', node, needed)}")
    entries = entries_of(node, path)
    if unknown := [key for key in entries if key not in _ENTRIES]:
        raise ValueError(f"{path}: materials must have the keys {' and '.join(_ENTRIES)} only, got {quoted(unknown[0])}")
    image = entries.get("image")
    if not isinstance(image, ScalarNode) or not image.value.strip():
        raise ValueError(
            f"{path}: {invalid('materials', node, needed) if image is None else invalid('image', image, 'a path')}"
        )
    place = path.parent / os.fsdecode(image.value.strip().encode("utf-8", "surrogateescape"))
    numbers = read_image(place, path).grey[::-1]
    if numbers.shape != shape:
        size = " x ".join(map(str, reversed(numbers.shape)))
        raise ValueError(
            f"{place}: the image must have {shape[1]} x {shape[0]} pixels, as that of the map {path}, got {size}"
        )
    try:
        table = _table(entries["table"]) if "table" in entries else tuple(map(Material.named, NAMES))
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from None
    return MaterialLayer(numbers, table)


def described(grid: OccupancyGrid, image: str) -> dict[str, Any]:
    """Returns the value of the key `materials` for a grid that has materials, and the name of their image."""
    assert grid.material_table is not None
    return {"image": image, "table": [_described(material) for material in grid.material_table]}


def _table(node: Node) -> tuple[Material, ...]:
    if not isinstance(node, SequenceNode) or not node.value:
        raise invalid("table", node, "a list of materials")
    return tuple(map(_material, node.value))


def _material(node: Node) -> Material:
    if isinstance(node, ScalarNode):
        return Material.named(node.value.strip())
    if not isinstance(node, MappingNode) or not all(isinstance(value, ScalarNode) for _, value in node.value):
        raise invalid("a material", node, f"a name or a mapping of {', '.join(_ARGUMENTS)}")
    arguments = {key: value_of(value) for key, value in entries_of(node).items()}
    if unknown := [key for key in arguments if key not in _ARGUMENTS]:
        raise ValueError(f"a material must have {', '.join(_ARGUMENTS)} only, got {quoted(unknown[0])}")
    return Material(**arguments)


def _described(material: Material) -> str | dict[str, Any]:
    """Returns the name of a material, or its arguments if it has none."""
    for name in NAMES:
        if Material.named(name) == material:
            return name
    return {name: getattr(material, name) for name in _ARGUMENTS}
