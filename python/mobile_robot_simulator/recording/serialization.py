"""Serializes messages in the encodings of ROS 1 and ROS 2."""

from __future__ import annotations

import struct
from collections.abc import Callable, Hashable, Iterator
from dataclasses import fields
from functools import cache, lru_cache, partial
from operator import attrgetter
from typing import Any

import numpy as np
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from ..message_recipe import MessageRecipe
from ..messages import Message
from .packer import Packer

TEMPLATES = 5_000
"""Number of templates that are kept. A robot has two, for its odometry and its transforms."""

ACKERMANN = {
    "ackermann_msgs/msg/AckermannDrive": "float32 steering_angle\nfloat32 steering_angle_velocity\nfloat32 speed\n"
    "float32 acceleration\nfloat32 jerk",
    "ackermann_msgs/msg/AckermannDriveStamped": "std_msgs/Header header\nackermann_msgs/AckermannDrive drive",
}
"""Definitions of the package ackermann_msgs, which rosbags does not have."""


def _register_ackermann(types: Typestore) -> Typestore:
    for name, definition in ACKERMANN.items():
        types.register(get_types_from_msg(definition, name))
    return types


@cache
def ros2_types() -> Typestore:
    """Returns the message definitions of ROS 2 Humble, and those of ackermann_msgs."""
    return _register_ackermann(get_typestore(Stores.ROS2_HUMBLE))


@cache
def ros1_types() -> Typestore:
    """Returns the message definitions of ROS 1 Noetic, and those that rosbags lacks: TFMessage and ackermann_msgs."""
    types = get_typestore(Stores.ROS1_NOETIC)
    types.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    return _register_ackermann(types)


def to_ros2_bytes(message: Message | partial[Message]) -> bytes:
    """Returns a message, or what a call builds, in the encoding of ROS 2, little-endian CDR.

    A message with a `MessageRecipe` is not built.

    Raises:
        TypeError: An array has another element type than the ROS message.
        ValueError: The ROS message cannot hold a value, or the type of the message is unknown.
    """
    if isinstance(message, partial):
        recipe: Any = message.func
        if type(recipe) is MessageRecipe and not message.keywords:
            try:
                if recipe.split is not None:
                    common, numbers = recipe.split(*message.args)
                    return _template(recipe, common, len(numbers))(*numbers)
                return _packer(recipe.kind).pack_values(recipe.values(*message.args))  # type: ignore[arg-type, union-attr]
            except Exception:  # the same again, with the message
                pass
        message = message()
    try:
        packer = _packer(type(message))  # type: ignore[arg-type]
        if packer is not None:
            return packer.pack(message)
    except Exception:  # rosbags says what is wrong
        pass
    try:
        # The argument is a class, which is hashable. Mypy rejects it, because instances of the class are not hashable.
        for name, array_of, dtype in _array_fields(type(message)):  # type: ignore[arg-type]
            if array_of(message).dtype != dtype:
                raise TypeError(f"{name} must have dtype {dtype}, got {array_of(message).dtype}")
        return bytes(ros2_types().serialize_cdr(message, message.ros_type, little_endian=True))
    except KeyError as error:
        raise ValueError(f"{message.ros_type} is not a known ROS type") from error
    except (AttributeError, OverflowError, SerdeError, ValueError, struct.error) as error:
        raise ValueError(f"cannot record this {message.ros_type}: {error}") from error


def to_ros1_bytes(message: Message | partial[Message]) -> memoryview:
    """Returns a message, or what a call builds, in the encoding of ROS 1. Raises the errors of `to_ros2_bytes`."""
    if isinstance(message, partial):
        message = message()
    return ros2_types().cdr_to_ros1(to_ros2_bytes(message), message.ros_type)


@cache
def _packer(kind: type[Message]) -> Packer | None:
    """Returns the packer of a class of messages, or None if there is none."""
    try:
        return Packer(ros2_types(), kind.ros_type)
    except (KeyError, NotImplementedError):
        return None


@lru_cache(TEMPLATES)
def _template(recipe: MessageRecipe[Any], common: Hashable, count: int) -> Callable[..., bytes]:
    """Returns the function that packs messages of a recipe that have something in common; see `Packer.template`."""
    packer = _packer(recipe.kind)  # type: ignore[arg-type]
    if packer is None:
        raise NotImplementedError
    return packer.template(recipe.join, common, count)


@cache
def _array_fields(kind: type[Message]) -> list[tuple[str, Callable[[Message], Any], np.dtype[Any]]]:
    """Returns name, getter and element type of each field that is an array.

    `to_ros2_bytes` checks the element types, because serialization would reinterpret the bytes of another type.
    """
    return [(name, attrgetter(name), value.dtype) for name, value in _leaf_fields(kind()) if isinstance(value, np.ndarray)]


def _leaf_fields(message: Message) -> Iterator[tuple[str, Any]]:
    """Yields dotted name and value of each field that is not itself a message."""
    for item in fields(message):
        value = getattr(message, item.name)
        if isinstance(value, Message):
            yield from ((f"{item.name}.{name}", inner) for name, inner in _leaf_fields(value))
        else:
            yield item.name, value
