"""Packer: packs messages of one type in the encoding of ROS 2, many times as fast as rosbags does."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

HEADER = b"\x00\x01\x00\x00"
"""First bytes of little-endian CDR."""

CODES = {
    "bool": "?",
    "byte": "B",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""Code of each type of numbers in `struct`."""

LAYOUTS = 256
"""Number of layouts that are kept for each type. Messages whose texts and arrays have the same lengths share one."""

TEXTS = 10_000
"""Number of texts that are kept with their bytes. Names of frames recur in each message."""

ARRAYS = 100
"""Number of arrays that are kept with their bytes for each field, if they can never change."""

_Taken: TypeAlias = tuple[list[str], list[str], list[str]]
"""Source text that takes a field from a message, or from a variable if it is `flat`: statements, values for `struct`, and
lengths of those that vary."""


@dataclass(frozen=True)
class _Number:
    code: str

    def take(self, source: str, name: str, names: dict[str, Any], flat: bool) -> _Taken:
        return [], [source], []

    def layout(self, lengths: Iterator[int], offset: int) -> tuple[str, int]:
        size = struct.calcsize(self.code)
        padding = -offset % size
        return f"{padding}x{self.code}", offset + padding + size


@dataclass(frozen=True)
class _Text:
    def take(self, source: str, name: str, names: dict[str, Any], flat: bool) -> _Taken:
        names["known_texts"], names["encoded"] = _known_texts, _encoded
        statements = [f"{name}_size, {name} = known_texts.get({source}) or encoded({source})"]
        return statements, [f"{name}_size", name], [f"{name}_size"]

    def layout(self, lengths: Iterator[int], offset: int) -> tuple[str, int]:
        # The size counts the zero at the end, with which `struct` fills up.
        size, padding = next(lengths), -offset % 4
        return f"{padding}xI{size}s", offset + padding + 4 + size


@dataclass(frozen=True)
class _Array:
    """An array of numbers. `count` is None if its length varies; then the length is written before the numbers."""

    dtype: np.dtype[Any]
    count: int | None

    def take(self, source: str, name: str, names: dict[str, Any], flat: bool) -> _Taken:
        known: dict[int, tuple[int, bytes, Any]] = {}
        names[f"{name}_known"], names[f"{name}_converted"] = known, partial(self._converted, known)
        convert = f"{name}_known.get(id({source})) or {name}_converted({source})"
        values = [f"{name}_data"] if self.count is not None else [f"{name}_length", f"{name}_data"]
        return [f"{name}_length, {name}_data, _ = {convert}"], values, [] if self.count is not None else [f"{name}_length"]

    def _converted(self, known: dict[int, tuple[int, bytes, Any]], array: Any) -> tuple[int, bytes, Any]:
        """Returns the length of an array, its bytes, and the array, and keeps them in `known` if it can never change."""
        if array.dtype != self.dtype or len(array.shape) != 1 or self.count not in (None, len(array)):
            raise ValueError("the array does not fit")
        result = len(array), array.tobytes(), array
        if type(array.base) is bytes and len(known) < ARRAYS:
            known[id(array)] = result
        return result

    def layout(self, lengths: Iterator[int], offset: int) -> tuple[str, int]:
        before, size, count = "", self.dtype.itemsize, self.count
        if count is None:
            count, padding = next(lengths), -offset % 4
            before, offset = f"{padding}xI", offset + padding + 4
        padding = -offset % size if count else 0
        return f"{before}{padding}x{count * size}s", offset + padding + count * size


@dataclass(frozen=True)
class _Messages:
    """A list of messages."""

    packer: Packer

    def take(self, source: str, name: str, names: dict[str, Any], flat: bool) -> _Taken:
        names[f"{name}_collect"] = self.packer.collect_values if flat else self.packer.collect
        statements = [
            f"{name}_values, {name}_lengths = [len({source})], [len({source})]",
            f"for item in {source}:",
            f"  values, lengths = {name}_collect(item); {name}_values += values; {name}_lengths += lengths",
        ]
        return statements, [f"*{name}_values"], [f"*{name}_lengths"]

    def layout(self, lengths: Iterator[int], offset: int) -> tuple[str, int]:
        count, padding = next(lengths), -offset % 4
        codes, offset = [f"{padding}xI"], offset + padding + 4
        for _ in range(count):
            code, offset = self.packer.layout(lengths, offset)
            codes.append(code)
        return "".join(codes), offset


class Packer:
    """Packs messages of one type in little-endian CDR, with one call of `struct` for a whole message.

    A message is packed by a function whose text is put together here, as that of `__init__` in dataclasses
    is, because loops over the fields take five times as long.

    Args:
        types: Definitions of the messages.
        ros_type: Name of the type.

    Attributes:
        pack: Returns a message as bytes. Raises an exception of any type if a value does not fit its field.
        collect: Returns the values of a message in the order of its layout, and the lengths of those that vary.
        pack_values: As `pack`, for the values of a message; see `MessageRecipe`.
        collect_values: As `collect`, for the values of a message.

    Raises:
        KeyError: The type is unknown.
        NotImplementedError: The type has a field of a kind that this class does not know, such as a list of texts.
    """

    def __init__(self, types: Typestore, ros_type: str) -> None:
        self._fields: list[Any] = []
        self._packs: dict[tuple[int, ...], Callable[..., bytes]] = {}
        names: dict[str, Any] = {"header": HEADER, "packs": self._packs, "new_pack": self._new_pack}
        self.collect, self.pack = self._functions(types, ros_type, names, flat=False)
        self.collect_values, self.pack_values = self._functions(types, ros_type, dict(names), flat=True)

    def _functions(
        self, types: Typestore, ros_type: str, names: dict[str, Any], flat: bool
    ) -> tuple[Callable[[Any], tuple[tuple[Any, ...], tuple[int, ...]]], Callable[[Any], bytes]]:
        """Returns `collect` and `pack`, for messages or, if `flat`, for values."""
        self._fields, variables = [], list[str]()
        statements, values, lengths = self._take(types, ros_type, "message", names, variables if flat else None)
        if flat:
            statements.insert(0, f"{', '.join(variables)}, = message")
        all_values, all_lengths = ("".join(f"{each}, " for each in items) for items in (values, lengths))
        for function, result in (
            ("collect", f"return ({all_values}), ({all_lengths})"),
            ("pack", f"lengths = ({all_lengths})\n return (packs.get(lengths) or new_pack(lengths))(header, {all_values})"),
        ):
            exec("\n ".join([f"def {function}(message):", *statements, result]), names)
        return names["collect"], names["pack"]

    def template(self, join: Callable[..., tuple[Any, ...]], common: Any, count: int) -> Callable[..., bytes]:
        """Returns a function that packs what `join(common, *numbers)` returns. It takes the numbers.

        Everything else is packed once. Where the numbers stand is found with numbers that stand for them.

        Args:
            join: As in `MessageRecipe`: puts the numbers into their places as they are.
            common: What the messages have in common.
            count: Number of numbers: seconds, nanoseconds and floats.

        Raises:
            ValueError: `join` does more with the numbers than to put them into their places.
        """
        codes = ["i", "I", *"d" * (count - 2)]
        first, second = _marks(0x5A3C_0001, 3.0, codes), _marks(0x6B4D_1001, -7.0, codes)
        data = self.pack_values(join(common, *first))
        places = sorted(
            (found.start(), codes[index], index)
            for index, mark in enumerate(first)
            for found in re.finditer(re.escape(struct.pack(f"<{codes[index]}", mark)), data)
        )
        names: dict[str, Any] = {}
        layout, values, end = "<", list[str](), 0
        for place, code, index in places:
            if place > end:
                layout, names[f"bytes{end}"] = f"{layout}{place - end}s", data[end:place]
                values.append(f"bytes{end}")
            layout, end = layout + code, place + struct.calcsize(code)
            values.append(f"number{index}")
        names["pack"], names["rest"] = struct.Struct(f"{layout}{len(data) - end}s").pack, data[end:]
        numbers = ", ".join(f"number{index}" for index in range(count))
        exec(f"def fill({numbers}): return pack({', '.join(values)}, rest)", names)
        fill: Callable[..., bytes] = names["fill"]
        if fill(*second) != self.pack_values(join(common, *second)):
            raise ValueError("the numbers must be put into their places as they are")
        return fill

    def layout(self, lengths: Iterator[int], offset: int) -> tuple[str, int]:
        """Returns the codes of a message at an offset, and the offset after it.

        Args:
            lengths: Lengths of texts, arrays and lists, in the order of the fields.
            offset: Where the message begins.
        """
        codes = []
        for field in self._fields:
            code, offset = field.layout(lengths, offset)
            codes.append(code)
        return "".join(codes), offset

    def _new_pack(self, lengths: tuple[int, ...]) -> Callable[..., bytes]:
        if len(self._packs) >= LAYOUTS:
            self._packs.clear()
        pack = self._packs[lengths] = struct.Struct(f"<4s{self.layout(iter(lengths), 0)[0]}").pack
        return pack

    def _take(
        self, types: Typestore, ros_type: str, message: str, names: dict[str, Any], variables: list[str] | None
    ) -> _Taken:
        """Returns the source text that takes the fields of a message, and appends them to the fields of the packer.

        Args:
            types: Definitions of the messages.
            ros_type: Name of the type of the message.
            message: Name of the variable that holds the message.
            names: Objects that the text uses, by name.
            variables: None to take the fields from the message. Else each field is in a variable, whose name is appended.
        """
        taken: _Taken = ([], [], [])
        for name, (node, content) in types.get_msgdef(ros_type).fields:
            source, variable = f"{message}.{name}", f"{message}_{name}"
            if node == Nodetype.NAME:
                if variables is None:
                    taken[0].append(f"{variable} = {source}")
                parts = self._take(types, str(content), variable, names, variables)
            else:
                self._fields.append(field := _field(types, node, content))
                if variables is not None:
                    variables.append(source := variable)
                parts = field.take(source, variable, names, variables is not None)
            for all_parts, part in zip(taken, parts, strict=True):
                all_parts.extend(part)
        return taken


_known_texts: dict[str, tuple[int, bytes]] = {}
"""The bytes of texts, and their number with the zero at the end."""


def _marks(start: int, divisor: float, codes: list[str]) -> list[float]:
    """Returns numbers whose bytes occur nowhere else in a message."""
    return [start + index if code in "iI" else (start + index) / divisor for index, code in enumerate(codes)]


def _encoded(text: str) -> tuple[int, bytes]:
    """Returns the number of bytes of a text with the zero at the end, and the bytes, and keeps them."""
    data = text.encode()
    if len(_known_texts) < TEXTS:
        _known_texts[text] = len(data) + 1, data
    return len(data) + 1, data


def _field(types: Typestore, node: Nodetype, content: Any) -> Any:
    if node == Nodetype.BASE:
        kind, _ = content
        if kind == "string":
            return _Text()
        if kind in CODES:
            return _Number(CODES[kind])
    else:
        (inner, kind), count = content
        if inner == Nodetype.BASE and kind[0] in CODES:
            return _Array(np.dtype(f"<{CODES[kind[0]]}"), count if node == Nodetype.ARRAY else None)
        if inner == Nodetype.NAME and node == Nodetype.SEQUENCE:
            return _Messages(Packer(types, str(kind)))
    raise NotImplementedError(f"{node} of {content}")
