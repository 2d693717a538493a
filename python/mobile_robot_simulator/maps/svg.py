"""SVG drawings as maps; needs svgelements, of the extra `worlds`.

Source: https://www.w3.org/TR/SVG11/. What is dark on white paper is an obstacle: a dark line is a wall, a dark fill an area.
"""

from __future__ import annotations

import io
import math
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted, shortened
from .cell_map import CellMap
from .drawing import Drawing
from .xml_document import read_xml

__all__ = ["read_svg"]

_NAMESPACE = "{http://www.w3.org/2000/svg}"
_MAX_PIECES = 10_000
"""Largest number of chords of one curve."""


def read_svg(path: Path, resolution: float, unit: float | None) -> CellMap:
    """Returns the cells of an SVG drawing. Lines are walls without thickness, fills are areas, if they are dark.

    Dark is what is darker than half on white paper. The point (x, y) of the drawing, in the units of its view box, is at
    (x, -y) times `unit`. Curves are drawn as chords of at most half a cell.

    Args:
        path: The file.
        resolution: Side of a cell [m].
        unit: Length of a unit of the view box [m]; None means 1 m.

    Raises:
        ImportError: svgelements is not installed.
        OSError: The file cannot be read.
        ValueError: The file is malformed, has nothing to draw, or the grid would be too large.
    """
    try:
        import svgelements
    except ImportError as error:
        raise ImportError("SVG needs svgelements: pip install 'mobile-robot-simulator[worlds]'") from error
    drawing = Drawing()
    root, scale = read_xml(path), 1.0 if unit is None else unit
    if root.tag != f"{_NAMESPACE}svg":
        raise ValueError(f"{path}: the first element must be svg of {_NAMESPACE.strip('{}')}, got {quoted(root.tag)}")
    try:
        svg = svgelements.SVG.parse(io.BytesIO(_drawn_only(root)), reify=True, on_error="raise")
        to_units = ~svgelements.Matrix(svg.viewbox_transform)
        for element in svg.elements(lambda element: isinstance(element, svgelements.Shape)):
            _add(drawing, abs(svgelements.Path(element) * to_units), element, scale, resolution)
    except (ValueError, ArithmeticError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"{path}: not a valid drawing: {shortened(error)}") from None
    return drawing.cell_map(path, resolution)


def _drawn_only(root: ElementTree.Element) -> bytes:
    """Returns a document without masks and markers, with its symbols in `defs`: svgelements would draw them in place."""
    for parent in list(root.iter()):
        for index, child in enumerate(list(parent)):
            if child.tag in (f"{_NAMESPACE}mask", f"{_NAMESPACE}marker"):
                parent.remove(child)
            elif child.tag == f"{_NAMESPACE}symbol" and parent.tag != f"{_NAMESPACE}defs":
                parent.remove(child)
                definitions = ElementTree.Element(f"{_NAMESPACE}defs")
                definitions.append(child)
                parent.insert(index, definitions)
    return ElementTree.tostring(root)


def _add(drawing: Drawing, outline: Any, element: Any, scale: float, resolution: float) -> None:
    """Adds an element of a drawing. The outline is its path, in units of the view box."""
    values = element.values
    if values.get("visibility") in ("hidden", "collapse"):
        return
    is_wall, is_area = _is_dark(element.stroke), _is_dark(element.fill)
    if not is_wall and not is_area:
        return
    lines = [_points(part, scale, resolution) for part in outline.as_subpaths()]
    lines = [line for line in lines if len(line)]
    if is_area and lines:
        drawing.add_area(lines, is_even_odd=values.get("fill-rule") == "evenodd")
    if is_wall:
        for line in lines:
            drawing.add_wall(line)


def _is_dark(colour: Any) -> bool:
    """True if a colour with its opacity is darker than half on white paper."""
    return colour.value is not None and colour.opacity * (1.0 - colour.luma) > 0.5


def _points(part: Any, scale: float, resolution: float) -> NDArray[np.float64]:
    """Returns a connected part of a path as a polyline (N, 2) [m], with y up."""
    points: list[tuple[float, float]] = []
    for segment in part:
        if segment.end is None:
            continue
        if type(segment).__name__ in ("Move", "Line", "Close"):
            points.append((segment.end.x, segment.end.y))
        else:
            pieces = math.ceil(_length(segment) * scale / (resolution / 2))
            steps = np.linspace(0, 1, min(max(pieces, 4), _MAX_PIECES) + 1)[1:]
            points += [(x, y) for x, y in segment.npoint(steps)]
    return np.array(points, np.float64).reshape(-1, 2) * (scale, -scale)


def _length(curve: Any) -> float:
    """Returns an upper bound of the length of a curve: of its control polygon, or of an arc of its larger radius."""
    if type(curve).__name__ == "Arc":
        return float(max(abs(curve.rx), abs(curve.ry)) * abs(curve.sweep))
    names = ("start", "control", "control1", "control2", "end")
    corners = [getattr(curve, name) for name in names if hasattr(curve, name)]
    return sum(math.hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(corners))
