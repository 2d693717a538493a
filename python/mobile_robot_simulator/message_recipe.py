"""MessageRecipe: builds messages of one type, or only gives the values of their fields to those who need no message."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import fields
from functools import cache, partial
from itertools import count
from typing import Any, Generic, TypeVar, get_args, get_origin, get_type_hints

from .messages import Message

M = TypeVar("M", bound=Message)

Split = Callable[..., tuple[Hashable, tuple[float, ...]]]
"""What many messages have in common, and the numbers in which they differ: seconds, nanoseconds and floats."""


class MessageRecipe(Generic[M]):
    """A function that builds messages of one type. It can also give their values alone, which costs far less.

    Args:
        kind: Class of the messages.
        values: Function that returns the values of the fields in the order of the definition. In place of an inner message
            come its values; in place of a list of messages comes a list of tuples of values.
        split: None, or a function that takes the arguments of a call in place of `values`. It returns what many messages
            have in common, which must be hashable, and the numbers in which they differ: seconds, nanoseconds and floats.
            `values` then takes the two, each number as an argument of its own, and puts them into their places unchanged.

    Attributes:
        kind: Class of the messages.
        values: Returns the values of the fields for the arguments of a call.
        split: As given.
        join: The function `values`, as given.
    """

    def __init__(self, kind: type[M], values: Callable[..., tuple[Any, ...]], split: Split | None = None) -> None:
        self.kind, self.split, self.join = kind, split, values
        self.values = values if split is None else partial(_values, split, values)
        self.__doc__ = values.__doc__
        self._build: Callable[[tuple[Any, ...]], M] = _builder(kind)  # type: ignore[arg-type]

    def __call__(self, *arguments: Any) -> M:
        """Returns the message whose values the function returns for these arguments."""
        return self._build(self.values(*arguments))


def recipe(kind: type[M], split: Split | None = None) -> Callable[[Callable[..., tuple[Any, ...]]], MessageRecipe[M]]:
    """Makes a `MessageRecipe` of the function below it."""
    return lambda values: MessageRecipe(kind, values, split)


def _values(split: Split, join: Callable[..., tuple[Any, ...]], *arguments: Any) -> tuple[Any, ...]:
    common, numbers = split(*arguments)
    return join(common, *numbers)


@cache
def _builder(kind: type[Message]) -> Callable[[tuple[Any, ...]], Any]:
    """Returns a function that builds a message from its values.

    Its text is put together here, as that of `__init__` in dataclasses is, because loops over the fields take longer.
    """
    names: dict[str, Any] = {}
    variables: list[str] = []
    result = _expression(kind, names, variables, count())
    exec(f"def build(values):\n {', '.join(variables)}, = values\n return {result}", names)
    build: Callable[[tuple[Any, ...]], Any] = names["build"]
    return build


def _expression(kind: type[Message], names: dict[str, Any], variables: list[str], numbers: count[int]) -> str:
    """Returns the text that builds a message from the variables that hold its values."""
    hints, parts = get_type_hints(kind), []
    name = f"kind{next(numbers)}"
    names[name] = kind
    for item in fields(kind):
        hint = hints[item.name]
        if isinstance(hint, type) and issubclass(hint, Message):
            parts.append(_expression(hint, names, variables, numbers))
            continue
        variables.append(variable := f"value{len(variables)}")
        if get_origin(hint) is list and issubclass(inner := get_args(hint)[0], Message):
            names[f"build_{variable}"] = _builder(inner)
            variable = f"[build_{variable}(each) for each in {variable}]"
        parts.append(variable)
    return f"{name}({', '.join(parts)})"
