"""XML documents of maps: SDF and SVG."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from ..user_files import read_text

__all__ = ["read_xml"]

_LIMIT = 2**26


def read_xml(path: Path) -> ElementTree.Element:
    """Returns the root of an XML document.

    White space before the declaration and `frame=>` in a tag are accepted, because worlds of DynaBARN have both and Gazebo
    reads them. The declared encoding is ignored; see `user_files.read_text` for the one used.

    Args:
        path: The file.

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is not well-formed, or defines entities, which could make it very large.
    """
    text = read_text(path, _LIMIT).encode("utf-8", "surrogateescape").decode("utf-8", "replace").strip()
    if "<!ENTITY" in text:
        raise ValueError(f"{path}: must define no entities")
    try:
        return ElementTree.fromstring(re.sub(r"\bframe=\s*>", "frame=''>", text))
    except ElementTree.ParseError as error:
        raise ValueError(f"{path}: not valid XML: {error}") from None
