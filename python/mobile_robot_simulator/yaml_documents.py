"""YAML documents: parses YAML text to a graph of nodes that know their lines.

The nodes keep their scalars as text and their aliases as references. So a reader decides what a scalar means, and a small
file stays small. The parser is PyYAML's. It also takes what yaml-cpp, the parser of Nav2, takes:

- tabs between tokens;
- control characters, and bytes that are not UTF-8;
- for maps, `%` lines of any kind, such as the `%YAML:1.0` of OpenCV, and words at the end that belong to nothing.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml
from yaml.composer import Composer, ComposerError
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.resolver import BaseResolver
from yaml.scanner import Scanner

from .quoting import quoted, shortened

__all__ = ["MappingNode", "Node", "ScalarNode", "SequenceNode", "entries_of", "invalid", "parse", "text_of", "value_of"]

MAX_DEPTH = 50
"""Largest number of nodes inside each other. yaml-cpp allows 500."""

_TRUE = {"Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"}
_FALSE = {"N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"}
_NULL = {"", "~", "null", "Null", "NULL"}
_INTEGER = re.compile(r"[+-]?(0[xX][0-9a-fA-F]{1,32}|[0-9]{1,39})")
_FLOAT = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_SPECIAL = re.compile(r"[+-]?\.(inf|Inf|INF|nan|NaN|NAN)")
_BREAKS = str.maketrans("\t\x85\u2028\u2029", "    ")
_DIRECTIVE = re.compile(r"^%", re.MULTILINE)
_STRAY_END = re.compile(r"(?<=\n)[\w\x01-\x1f][^:#\[\]{},\"']*\Z")


class _Document(Reader, Scanner, Parser, Composer, BaseResolver):
    """The first document of a YAML stream."""

    def __init__(self, text: str, *, allow_aliases: bool) -> None:
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        Composer.__init__(self)
        BaseResolver.__init__(self)
        self._allow_aliases = allow_aliases
        self._depth = 0

    def check_printable(self, data: str) -> None:
        """Accepts every character."""

    def compose_node(self, parent: Node | None, index: Any) -> Node | None:
        """Composes a node, unless it is too deep or an alias that is not allowed."""
        if self._depth == MAX_DEPTH:
            problem = f"a value must be inside at most {MAX_DEPTH} others, got more"
            raise ComposerError(None, None, problem, self._next_mark())
        if not self._allow_aliases and self.check_event(yaml.AliasEvent):
            raise ComposerError(None, None, "aliases are not supported, as in ROS", self._next_mark())
        self._depth += 1
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def _next_mark(self) -> Any:
        return self.peek_event().start_mark  # type: ignore[no-untyped-call]

    def first(self) -> Node | None:
        """Returns the root of the first document, None if there is none. Does not look behind this document."""
        self.get_event()  # type: ignore[no-untyped-call]
        if self.check_event(yaml.StreamEndEvent):
            return None
        self.get_event()  # type: ignore[no-untyped-call]
        return self.compose_node(None, None)

    def has_more(self) -> bool:
        """Returns True if there is another document."""
        self.get_event()  # type: ignore[no-untyped-call]
        return not self.check_event(yaml.StreamEndEvent)


def parse(text: str, path: str | Path | None = None, *, as_nav2: bool = False) -> Node | None:
    """Returns the root node of a YAML document, None if the text is empty.

    Args:
        text: The text.
        path: The file, for error messages. None leaves it out.
        as_nav2: Allow aliases, and ignore everything behind the first document and words at the end, as yaml-cpp 0.8 does.
            By default all of these are errors. The parameter files of ROS 2 have no aliases either.

    Raises:
        ValueError: The text is not YAML, or it is nested too deeply. The message gives the line.
    """
    # A tab can be a blank between tokens only, because the indentation of YAML has no tabs. Each character keeps its place.
    text = text.translate(_BREAKS)
    if as_nav2:
        text = _STRAY_END.sub("", _DIRECTIVE.sub("#", text))
    document = _Document(text, allow_aliases=as_nav2)
    where = "" if path is None else f"{path}: "
    try:
        root = document.first()
        has_more = root is not None and not as_nav2 and document.has_more()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise ValueError(f"{where}not valid YAML: {line}{shortened(error.problem or error.context)}") from None
    except (ValueError, OverflowError) as error:  # an escape such as "\\UFFFFFFFF", which is no character
        raise ValueError(f"{where}not valid YAML: line {document.line + 1}: {shortened(error)}") from None
    if has_more:
        raise ValueError(f"{where}must contain one YAML document, got more")
    return root


def entries_of(node: MappingNode, path: str | Path | None = None) -> dict[str, Node]:
    """Returns the values of a mapping by key.

    Raises:
        ValueError: A key is not a scalar, or is there twice.
    """
    where = "" if path is None else f"{path}: "
    entries: dict[str, Node] = {}
    lines: dict[str, int] = {}
    for key, value in node.value:
        line = key.start_mark.line + 1
        if not isinstance(key, ScalarNode):
            raise ValueError(f"{where}line {line}: a key must be a single word, got {text_of(key)}")
        if key.value in entries:
            first = lines[key.value]
            raise ValueError(f"{where}line {line}: {quoted(key.value)} must be given once, got it in line {first} too")
        entries[key.value] = value
        lines[key.value] = line
    return entries


def value_of(node: Node | None) -> Any:
    """Returns the value of a node as the parameter files of ROS 2 define it.

    Words such as `yes` and `off` are truth values, 0x10 and 1e7 are numbers, and quoted text is text. In contrast to ROS 2,
    `null` and `~` are None, and the items of a list may have several types.

    Args:
        node: A node without aliases. None stands for an empty document.
    """
    if isinstance(node, SequenceNode):
        return [value_of(item) for item in node.value]
    if isinstance(node, MappingNode):
        return {key: value_of(value) for key, value in entries_of(node).items()}
    if not isinstance(node, ScalarNode):
        return None
    return node.value if node.style else _plain_value(node.value)


def _plain_value(text: str) -> bool | int | float | str | None:
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    if _INTEGER.fullmatch(text):
        digits = text.lstrip("+-")
        # As in C, a leading 0 means base 8. With an 8 or 9 behind it, the number is decimal.
        base = 16 if digits[1:2] in ("x", "X") else 8 if digits[0] == "0" and not set("89") & set(digits) else 10
        return int(text, base)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _SPECIAL.fullmatch(text):
        return float(text.replace(".", ""))
    return None if text in _NULL else text


def text_of(node: Node) -> str:
    """Returns a node as the file has it, quoted and cut. An alias shows what it stands for."""
    if isinstance(node, ScalarNode):
        return quoted(node.value)
    start, end = node.start_mark, node.end_mark
    source = start.buffer[start.pointer : end.pointer] if start.buffer is not None else ""
    return quoted(" ".join(source[:1000].split()))


def invalid(key: str, node: Node, needed: str) -> ValueError:
    """Returns an error: what is needed for a key, what the file has, and where."""
    return ValueError(f"{key} must be {needed}, got {text_of(node)} in line {node.start_mark.line + 1}")
