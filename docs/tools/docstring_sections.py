"""A griffe extension for sections of docstrings that griffe would show as coloured boxes.

`Example:` becomes a section of examples. A section with a title of our own, such as `Commands:`, becomes a paragraph that
starts with the title in bold.
"""

from __future__ import annotations

import re
from inspect import cleandoc
from typing import Any

import griffe

KNOWN = ("Args", "Attributes", "Examples", "Raises", "Returns", "Yields")
SECTION = re.compile(r"^([A-Z][\w ]*):\n((?:[ ]{4}.*(?:\n|$)|\n(?=[ ]{4}))+)", re.MULTILINE)


class DocstringSections(griffe.Extension):
    """Rewrites docstrings before they are parsed."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Rewrites the docstring of an object."""
        if obj.docstring is not None:
            obj.docstring.value = SECTION.sub(rewritten, obj.docstring.value)


def rewritten(section: re.Match[str]) -> str:
    """Returns a section as `Examples:` or, if its title is not in `KNOWN`, as a paragraph with a bold title."""
    title, body = section.groups()
    if title in KNOWN:
        return section.group()
    if title == "Example":
        return f"Examples:\n{body}"
    return f"\n**{title}.** {cleandoc(body)}\n\n"
