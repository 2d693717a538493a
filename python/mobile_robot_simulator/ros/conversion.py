"""Our messages to those of a ROS installation and back, field by field; arrays go as blocks of memory."""

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
class Dialect:
    """How one ROS differs from the other in its Python messages.

    pack: an array as the field takes it whose present value is given second.
    """

    pack: Callable[[Any, Any], Any]
    seconds: str = "sec"
    nanoseconds: str = "nanosec"
    wrap: Callable[[type], type] = field(default=lambda kind: kind)

    def find(self, ros_type: str) -> Any:
        """The installation's class for a type such as nav_msgs/msg/Odometry.

        raises: ImportError if the installation has no such type.
        """
        package, section, name = ros_type.split("/")
        return getattr(import_module(f"{package}.{section}"), name)

    def find_message(self, ros_type: str) -> Any:
        """The class for messages of a type, as it is published and subscribed to."""
        return self.wrap(self.find(ros_type))

    def to_ros(self, message: Message, kind: Any) -> Any:
        """The installation's message, of the class given, with what one of ours holds."""
        return self.fill(kind(), message)

    def fill(self, target: Any, message: Message) -> Any:
        """The installation's message given, filled with what one of ours holds."""
        if isinstance(message, Time):
            setattr(target, self.seconds, message.sec)
            setattr(target, self.nanoseconds, message.nanosec)
            return target
        for name, _, _ in _plan(type(message)):  # type: ignore[arg-type]
            value = getattr(message, name)
            if isinstance(value, Message):
                self.fill(getattr(target, name), value)
            elif isinstance(value, np.ndarray):
                setattr(target, name, self.pack(value, getattr(target, name)))
            elif isinstance(value, list):
                items = getattr(target, name)
                if len(items) != len(value):
                    items = [self.find(item.ros_type)() for item in value]
                    setattr(target, name, items)
                for item, filling in zip(items, value, strict=True):
                    self.fill(item, filling)
            else:
                setattr(target, name, value)
        return target

    def from_ros(self, message: Any, kind: type[M]) -> M:
        """Our message, of the class given, with what one of the installation's holds. Arrays may share its memory."""
        if kind is Time:
            moment = Time(getattr(message, self.seconds), getattr(message, self.nanoseconds))
            return cast(M, moment)
        values = []
        for name, inner, dtype in _plan(kind):  # type: ignore[arg-type]
            value = getattr(message, name)
            if dtype is not None:
                value = np.asarray(value, dtype)
            elif isinstance(value, list):
                value = [self.from_ros(item, inner) for item in value]
            elif inner is not None:
                value = self.from_ros(value, inner)
            values.append(value)
        return kind(*values)


@cache
def _plan(kind: type[Message]) -> list[tuple[str, Any, np.dtype[Any] | None]]:
    """Fields of a kind of message: name, class of the messages in it, element type of the array that it is."""
    hints, empty = get_type_hints(kind), kind()
    plan: list[tuple[str, Any, np.dtype[Any] | None]] = []
    for name in (each.name for each in fields(kind)):
        value = getattr(empty, name)
        if isinstance(value, list):
            plan.append((name, get_args(hints[name])[0], None))
        elif isinstance(value, np.ndarray):
            plan.append((name, None, value.dtype))
        else:
            plan.append((name, type(value) if isinstance(value, Message) else None, None))
    return plan
