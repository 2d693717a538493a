"""DXF drawings as maps; needs ezdxf, of the extra `worlds`.

Source: the documentation of ezdxf, https://ezdxf.readthedocs.io, and that of DXF by Autodesk.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quoting import shortened
from ..user_files import read_bytes
from .cell_map import CellMap
from .drawing import Drawing

__all__ = ["read_dxf"]

_LIMIT = 2**28
_BINARY = b"AutoCAD Binary DXF"
_MAX_DEPTH = 32
_LINES = frozenset(("LINE", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ARC", "ELLIPSE", "SPLINE"))
_AREAS = frozenset(("SOLID", "TRACE"))


def read_dxf(path: Path, resolution: float, unit: float | None) -> CellMap:
    """Returns the cells of a DXF drawing, seen from above.

    Lines, polylines, circles, arcs, ellipses and splines of the model space are walls without thickness; solids and solid
    hatches are areas. Blocks are read too. Layers that are off or frozen, and everything else, are left out: texts,
    dimensions, hatches with a pattern, images. Curves are drawn as chords that deviate by at most 1/16 of a cell.

    Args:
        path: The file, as text or binary.
        resolution: Side of a cell [m].
        unit: Length of a unit of the drawing [m]. None means the one that the drawing gives in $INSUNITS, or 1 m if it
            gives none.

    Raises:
        ImportError: ezdxf is not installed.
        OSError: The file cannot be read.
        ValueError: The file is malformed, has nothing to draw, or the grid would be too large.
    """
    try:
        import ezdxf.recover
        import ezdxf.units
        from ezdxf.document import Drawing as Document
        from ezdxf.enums import InsertUnits
        from ezdxf.lldxf.const import DXFError
        from ezdxf.lldxf.tagger import binary_tags_loader
    except ImportError as error:
        raise ImportError("DXF needs ezdxf: pip install 'mobile-robot-simulator[worlds]'") from error
    data = read_bytes(path, _LIMIT)
    try:
        if data.startswith(_BINARY):
            document = Document.load(binary_tags_loader(data, errors="surrogateescape"))
        else:
            document, _ = ezdxf.recover.read(io.BytesIO(data))
        scale = unit or (
            ezdxf.units.conversion_factor(InsertUnits(document.units), InsertUnits.Meters) if document.units else 1.0
        )
        hidden = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
        drawing = Drawing()
        for entity in _entities(document.modelspace(), hidden, 0):
            _add(drawing, entity, scale, resolution)
    except DXFError as error:
        raise ValueError(f"{path}: not a valid DXF drawing: {shortened(error)}") from None
    # ezdxf raises any of these for damaged entities.
    except (ValueError, ArithmeticError, LookupError, TypeError, AttributeError, EOFError, struct.error) as error:
        raise ValueError(f"{path}: cannot be drawn: {shortened(error)}") from None
    return drawing.cell_map(path, resolution)


def _entities(entities: Iterable[Any], hidden: set[str], depth: int) -> Iterator[Any]:
    """Yields the entities on visible layers, those of blocks too."""
    if depth > _MAX_DEPTH:
        raise ValueError(f"blocks must be nested at most {_MAX_DEPTH} times")
    for entity in entities:
        if entity.dxf.layer.lower() in hidden or entity.dxf.get("invisible", 0):
            continue
        if entity.dxftype() == "INSERT":
            for insert in entity.multi_insert() if entity.mcount > 1 else (entity,):
                yield from _entities(insert.virtual_entities(), hidden, depth + 1)
        else:
            yield entity


def _add(drawing: Drawing, entity: Any, scale: float, resolution: float) -> None:
    from ezdxf import path

    kind = entity.dxftype()
    if kind in _LINES:
        drawing.add_wall(_points(path.make_path(entity), scale, resolution))
    elif kind in _AREAS:
        drawing.add_area([_points(path.make_path(entity), scale, resolution)], is_even_odd=True)
    elif kind == "HATCH" and entity.dxf.solid_fill:
        rings = [_points(ring, scale, resolution) for ring in path.from_hatch(entity)]
        if rings := [ring for ring in rings if len(ring)]:
            drawing.add_area(rings, is_even_odd=True)


def _points(outline: Any, scale: float, resolution: float) -> NDArray[np.float64]:
    """Returns a path of ezdxf as a polyline (N, 2) [m]."""
    corners = [(corner.x, corner.y) for corner in outline.flattening(resolution / 16 / scale)]
    return np.array(corners, np.float64).reshape(-1, 2) * scale
