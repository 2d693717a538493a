"""Types of values that parameters of several nodes have, with their checks."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field


def reject_bool(value: object) -> object:
    """Rejects booleans, which would otherwise pass as 0 and 1."""
    if isinstance(value, bool):
        raise ValueError("Input should be a number")
    return value


def numbers(*names: str) -> BeforeValidator:
    """Returns a validator that rejects anything but a sequence of as many items as there are names."""

    def check(value: object) -> object:
        items = value.tolist() if isinstance(value, np.ndarray) else value
        if not isinstance(items, Sequence) or isinstance(items, str) or len(items) != len(names):
            raise ValueError(f"Input should be {len(names)} numbers [{', '.join(names)}]")
        return items

    return BeforeValidator(check)


def _check_seed(value: int) -> int:
    if not 0 <= value < 2**64:
        raise ValueError("Input should be in 0..2**64 - 1")
    return value


def is_topic_name(name: str) -> bool:
    """Returns True if a name is valid for topics and services in ROS."""
    return bool(re.fullmatch(r"[/~]?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", name, re.ASCII))


def _check_topic(name: str) -> str:
    """Rejects names that are not valid for topics and services in ROS."""
    if not is_topic_name(name):
        raise ValueError("Input should be a name such as /scan")
    return name


def names_of(one: str, other: str) -> Callable[[object], object]:
    """Returns a validator that rejects what is not a list of different names that ROS accepts in a namespace.

    Args:
        one: An example of a name, for the error.
        other: Another example.
    """

    def check(names: object) -> object:
        is_list = isinstance(names, list | tuple) and all(isinstance(name, str) for name in names)
        if not is_list or not all(re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) for name in names):  # type: ignore[attr-defined]
            raise ValueError(f"Input should be a list of names such as [{one}, {other}]")
        if len(set(names)) < len(names):  # type: ignore[call-overload, arg-type]
            raise ValueError("Input should be a list of different names")
        return names

    return check


Number = Annotated[float, BeforeValidator(reject_bool), Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0.0, le=1e6)]
Rate = Annotated[Number, Field(gt=0.0, le=1e6)]
Weight = Annotated[Number, Field(ge=0.0)]
Count = Annotated[int, BeforeValidator(reject_bool)]
Seed = Annotated[Count, AfterValidator(_check_seed)]
Name = Annotated[str, Field(min_length=1)]
Topic = Annotated[str, AfterValidator(_check_topic)]
OptionalTopic = Annotated[str, AfterValidator(lambda name: name and _check_topic(name))]
