"""Encoding: messages and services as clients of Foxglove read and write them, in CDR and JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from ..messages import Header, Message, Time
from ..quoting import quoted, shortened
from ..ros.conversion import ROSBAGS

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

M = TypeVar("M", bound=Message)

CDR, JSON = ENCODINGS = ("cdr", "json")
"""Encodings in which clients may publish and call services. Messages to clients are in CDR."""

_EMPTY = b"\x00\x01\x00\x00\x00"
"""A message without fields in CDR: ROS 2 gives it one byte."""

_NAMES: Mapping[Any, str] = {bool: "bool", float: "float64", str: "string"}
"""ROS types of the fields whose Python type leaves no choice."""


@cache
def _own_types() -> Typestore:
    """Returns the definitions of ROS 2 Humble, and those that the fields of classes describe, such as those of services."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_HUMBLE)


def _types_with(kind: type[Message]) -> Typestore:
    """Returns the definitions that recordings use if the type is among them, else `_own_types` with it.

    Raises:
        ValueError: The fields of the class do not tell their ROS types.
    """
    from ..recording.serialization import ros2_types

    if kind.ros_type in ros2_types().fielddefs:
        return ros2_types()
    types = _own_types()
    if kind.ros_type not in types.fielddefs:
        from rosbags.typesys import get_types_from_msg

        text = "\n".join(f"{ros_type} {name}" for name, ros_type in _described(kind))
        (described,) = get_types_from_msg(text, "unnamed/msg/Unnamed").values()
        types.register({kind.ros_type: described})
    return types


def definition_of(kind: type[Message]) -> str:
    """Returns the definition of a message class, with those of the messages in it, as a text for `ros2msg`.

    Raises:
        ValueError: ROS 2 Humble does not have the type, and the fields of the class do not tell their ROS types.
    """
    return str(_types_with(kind).generate_msgdef(kind.ros_type, ros_version=2)[0])


def _described(kind: type[Message]) -> Iterator[tuple[str, str]]:
    """Yields name and ROS type of each field of a class."""
    hints, empty = get_type_hints(kind), kind()
    for name in (each.name for each in fields(kind)):
        hint, value = hints[name], getattr(empty, name)
        if isinstance(value, np.ndarray):
            yield name, f"{value.dtype.name}[]"
        elif get_origin(hint) is list and issubclass(inner := get_args(hint)[0], Message):
            _types_with(inner)
            yield name, f"{inner.ros_type.replace('/msg/', '/')}[]"
        elif isinstance(value, Message):
            _types_with(type(value))
            yield name, value.ros_type.replace("/msg/", "/")
        elif hint in _NAMES:
            yield name, _NAMES[hint]
        else:
            raise ValueError(f"{kind.ros_type} is not part of ROS 2 Humble, and the ROS type of its field {name} is unknown")


def encoded(message: Message) -> bytes:
    """Returns a message in CDR, as in a recording.

    Raises:
        ValueError: The ROS message cannot hold a value, or there is no definition of the type.
        TypeError: An array has another element type than the ROS message.
    """
    from ..recording.serialization import ros2_types, to_ros2_bytes

    if not fields(message):
        return _EMPTY
    types = _types_with(type(message))
    if types is ros2_types():
        return bytes(to_ros2_bytes(message))
    try:
        return bytes(types.serialize_cdr(message, message.ros_type))
    except Exception as error:  # whatever a value that does not fit leads to
        raise ValueError(f"cannot send this {message.ros_type}: {shortened(error)}") from None


def decoded(data: bytes, kind: type[M], encoding: str) -> M:
    """Returns the message that a client sent.

    Args:
        data: What it sent.
        kind: Class of the message.
        encoding: One of `ENCODINGS`.

    Raises:
        ValueError: The bytes are not such a message.
    """
    if encoding == JSON:
        try:
            return _from_json(json.loads(data), kind, kind.ros_type)
        except RecursionError:
            raise ValueError(f"not a {kind.ros_type}: nested too deeply") from None
    if not fields(kind):
        return kind()
    types = _types_with(kind)
    try:
        return ROSBAGS.from_ros(types.deserialize_cdr(data, kind.ros_type), kind)
    except Exception as error:  # whatever the bytes of a damaged message lead to
        raise ValueError(f"not a {kind.ros_type}: {shortened(error) or type(error).__name__}") from None


def _from_json(value: Any, kind: type[M], where: str) -> M:
    """Returns the message that a JSON object describes. Fields that it does not have keep their defaults."""
    if not isinstance(value, Mapping):
        raise ValueError(f"{where} must be an object, got {quoted(value)}")
    if kind is Time:  # Foxglove says nsec
        value = {("nanosec" if name == "nsec" else name): each for name, each in value.items()}
    elif kind is Header:  # a header of ROS 1 counts messages
        value = {name: each for name, each in value.items() if name != "seq"}
    message, hints = kind(), get_type_hints(kind)
    names = [each.name for each in fields(kind)]
    for name, given in value.items():
        inside = f"{where}.{name}"
        if name not in names:
            raise ValueError(f"{inside} does not exist; {kind.ros_type} has {', '.join(names) or 'no fields'}")
        default = getattr(message, name)
        if isinstance(default, Message):
            given = _from_json(given, type(default), inside)
        elif isinstance(default, np.ndarray):
            given = _array(given, default.dtype, inside)
        elif isinstance(default, list) and isinstance(given, list) and issubclass(get_args(hints[name])[0], Message):
            given = [_from_json(each, get_args(hints[name])[0], f"{inside}[{i}]") for i, each in enumerate(given)]
        setattr(message, name, given)
    return message


def _array(value: Any, dtype: np.dtype[Any], where: str) -> np.ndarray[Any, Any]:
    try:
        return np.array(value, dtype)
    except (ValueError, TypeError, OverflowError) as error:
        raise ValueError(f"{where} must be a list of numbers ({dtype}): {shortened(error)}") from None
