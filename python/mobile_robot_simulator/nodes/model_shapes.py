"""Reads the outline of an obstacle from a model in URDF or SDF."""

from __future__ import annotations

from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from .._core import Shape
from ..quoting import quoted

SHAPES = ("box", "cylinder", "sphere")
"""Elements of a geometry that an obstacle can have."""


def shape_of_model(xml: str) -> Shape:
    """Returns the outline that a model has on the floor: a rectangle or a disc.

    Args:
        xml: URDF or SDF with one box, cylinder or sphere as its collision geometry or, without one, as its visual geometry.
            It stands upright at the origin of the model, at any height.

    Raises:
        ValueError: It is not XML, it has another geometry or several, or the shape is turned or moved aside.
    """
    if "<!" in xml.replace("<!--", ""):
        raise ValueError("the model must have no document type and no CDATA")
    try:
        root = ElementTree.fromstring(xml.strip())
    except ElementTree.ParseError as error:
        raise ValueError(f"the model must be URDF or SDF: {error}") from None
    for kind in ("collision", "visual"):
        geometries = [geometry for part in root.iter(kind) for geometry in part.iter("geometry")]
        if geometries:
            break
    if len(geometries) != 1:
        raise ValueError(f"the model must have one geometry, it has {len(geometries)}")
    for offset in (*root.iter("pose"), *root.iter("origin")):
        _check_offset(offset)
    for name in SHAPES:
        element = geometries[0].find(name)
        if element is not None:
            return _shape(name, element)
    raise ValueError(f"the geometry must be a box, a cylinder or a sphere, got {[child.tag for child in geometries[0]]}")


def _shape(name: str, element: Element) -> Shape:
    if name == "box":
        length, width, _ = _numbers(element, "size", 3)
        return Shape.rectangle(length, width)
    return Shape.disc(*_numbers(element, "radius", 1))


def _check_offset(element: Element) -> None:
    """Refuses a pose (SDF: x y z roll pitch yaw as text; URDF: attributes) that does more than lift the shape."""
    is_sdf = element.tag == "pose"
    text = element.text or "" if is_sdf else f"{element.get('xyz', '0 0 0')} {element.get('rpy', '0 0 0')}"
    numbers = _floats(text, element.tag)
    if any(number != 0.0 for index, number in enumerate(numbers) if index != 2):
        raise ValueError(f"the shape must stand upright at the origin of the model, got {element.tag} {quoted(text)}")


def _numbers(element: Element, name: str, count: int) -> list[float]:
    """Returns the numbers of an attribute (URDF) or of the element of that name (SDF)."""
    text = element.get(name) or element.findtext(name) or ""
    numbers = _floats(text, name)
    if len(numbers) != count:
        raise ValueError(f"the {name} of a {element.tag} must have {count} numbers, got {quoted(text)}")
    return numbers


def _floats(text: str, name: str) -> list[float]:
    try:
        return [float(part) for part in text.split()]
    except ValueError:
        raise ValueError(f"{name} must be numbers, got {quoted(text)}") from None
