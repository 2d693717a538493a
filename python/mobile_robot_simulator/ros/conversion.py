"""MessageConverter: converts our messages to those of a ROS installation and back, field by field."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cache
from importlib import import_module
from typing import Any, TypeVar, cast, get_args, get_type_hints

import numpy as np

from ..messages import Message, Time

M = TypeVar("M", bound=Message)


@dataclass(frozen=True)
class MessageConverter:
    """Converts messages for one ROS version. The fields say how its Python messages differ from those of the other version.

    Args:
        pack_array: Converts a NumPy array for a field of a ROS message. Called with the array and the field's current value.
        seconds: Attribute of a ROS time that holds the seconds.
        nanoseconds: Attribute of a ROS time that holds the nanoseconds.
        wrap_message_type: Returns the class to publish and subscribe with, given the message class of the ROS installation.
    """

    pack_array: Callable[[Any, Any], Any]
    seconds: str = "sec"
    nanoseconds: str = "nanosec"
    wrap_message_type: Callable[[type], type] = field(default=lambda message_type: message_type)

    def find_type(self, ros_type: str) -> Any:
        """Returns the class of a message or service in the ROS installation.

        Args:
            ros_type: Name with package and kind, such as nav_msgs/msg/Odometry.

        Raises:
            ImportError: The package is not installed.
            AttributeError: The package has no such type.
        """
        package, kind, name = ros_type.split("/")
        return getattr(import_module(f"{package}.{kind}"), name)

    def find_message_type(self, ros_type: str) -> Any:
        """Returns the class to publish and subscribe with. Arguments and errors as in `find_type`."""
        return self.wrap_message_type(self.find_type(ros_type))

    def to_ros(self, message: Message, ros_class: Any) -> Any:
        """Returns a new ROS message of the class, with the values of one of our messages."""
        return self.fill(ros_class(), message)

    def fill(self, ros_message: Any, message: Message) -> Any:
        """Copies the values of one of our messages into a ROS message, and returns the ROS message.

        Filling the same ROS message again and again is faster than making new ones.

        Args:
            ros_message: ROS message of the same type. Lists in it are kept if their length fits.
            message: Our message.
        """
        if isinstance(message, Time):
            setattr(ros_message, self.seconds, message.sec)
            setattr(ros_message, self.nanoseconds, message.nanosec)
            return ros_message
        for name, _, _ in _field_plan(type(message)):  # type: ignore[arg-type]
            value = getattr(message, name)
            if isinstance(value, Message):
                self.fill(getattr(ros_message, name), value)
            elif isinstance(value, np.ndarray):
                setattr(ros_message, name, self.pack_array(value, getattr(ros_message, name)))
            elif isinstance(value, list) and not (value and isinstance(value[0], Message)):
                setattr(ros_message, name, list(value))
            elif isinstance(value, list):
                ros_items = getattr(ros_message, name)
                if len(ros_items) != len(value):
                    ros_items = [self.find_type(item.ros_type)() for item in value]
                    setattr(ros_message, name, ros_items)
                for ros_item, item in zip(ros_items, value, strict=True):
                    self.fill(ros_item, item)
            else:
                setattr(ros_message, name, value)
        return ros_message

    def from_ros(self, ros_message: Any, message_class: type[M]) -> M:
        """Returns our message with the values of a ROS message. Its arrays may share memory with the ROS message.

        Args:
            ros_message: ROS message.
            message_class: Class of our message of the same type.
        """
        if message_class is Time:
            time = Time(getattr(ros_message, self.seconds), getattr(ros_message, self.nanoseconds))
            return cast(M, time)
        values = []
        for name, inner_class, dtype in _field_plan(message_class):  # type: ignore[arg-type]
            if name in message_class.optional and not hasattr(ros_message, name):
                values.append(getattr(message_class(), name))
                continue
            value = getattr(ros_message, name)
            if dtype is not None:
                value = np.asarray(value, dtype)
            elif isinstance(value, list):
                value = list(value) if inner_class is None else [self.from_ros(item, inner_class) for item in value]
            elif inner_class is not None:
                value = self.from_ros(value, inner_class)
            values.append(value)
        return message_class(*values)


ROSBAGS = MessageConverter(lambda array, _: array)
"""Converts messages that rosbags has read."""


@cache
def _field_plan(message_class: type[Message]) -> list[tuple[str, Any, np.dtype[Any] | None]]:
    """Returns for each field: its name, the class of the message(s) in it or None, the dtype of its array or None."""
    hints, empty = get_type_hints(message_class), message_class()
    plan: list[tuple[str, Any, np.dtype[Any] | None]] = []
    for name in (each.name for each in fields(message_class)):
        value = getattr(empty, name)
        if isinstance(value, list):
            (item,) = get_args(hints[name])
            plan.append((name, item if issubclass(item, Message) else None, None))
        elif isinstance(value, np.ndarray):
            plan.append((name, None, value.dtype))
        else:
            plan.append((name, type(value) if isinstance(value, Message) else None, None))
    return plan
