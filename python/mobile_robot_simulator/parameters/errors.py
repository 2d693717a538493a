"""Messages about values that are wrong and names that are unknown."""

from __future__ import annotations

import re
from collections.abc import Iterable

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from ..quoting import nearest, quoted


def unknown_name(name: str, known: Iterable[str], kind: str = "parameter") -> str:
    """Returns an error message for an unknown name, with the nearest known name if one is similar."""
    known = list(known)
    near = nearest(name, known)
    return f"unknown {kind} {quoted(name)}; " + (
        f"did you mean {near[0]!r}?" if near else f"known {kind}s: {', '.join(known)}"
    )


def explain(error: ValidationError, known: Iterable[str]) -> str:
    """Returns all errors as one text, separated by semicolons. Each gives the parameter, the requirement and the value."""
    messages = []
    for detail in error.errors(include_url=False):
        name = "".join(f"[{part}]" if isinstance(part, int) else part for part in detail["loc"])
        if detail["type"] == "extra_forbidden":
            messages.append(unknown_name(name, known))
        elif detail["type"] == "missing":
            messages.append(f"{name} is required")
        elif name:
            messages.append(f"{name} must {_requirement(detail)}, got {quoted(detail['input'])}")
        else:
            messages.append(detail["msg"].removeprefix("Value error, "))
    return "; ".join(messages)


def _requirement(detail: ErrorDetails) -> str:
    """Returns what a value must be, from a message such as "Input should be a valid number, unable to parse string"."""
    if detail["type"] == "int_parsing_size":
        return "be a valid integer"
    message = detail["msg"].removeprefix("Value error, ")
    if detail["type"] in ("bool_parsing", "float_parsing", "int_from_float", "int_parsing"):
        message = message.partition(", ")[0]
    return re.sub(r"^\w+ should ", "", message)
