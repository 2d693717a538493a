"""Reads faults that are written as text, as in `--fault "Drop('/scan', probability=0.1)"`."""

from __future__ import annotations

import ast
import inspect
from typing import Any

from ..parameters import unknown_name
from ..quoting import quoted
from ..simulation.fault import Fault
from .messages import Blackout, BlockedSector, Delay, Drop, Duplicate, Reorder, StuckRanges
from .robots import ClockJump, OdometryDrift, Outage, Push, Slip

FAULTS: dict[str, type[Fault]] = {
    kind.__name__: kind
    for kind in (
        Blackout,
        BlockedSector,
        ClockJump,
        Delay,
        Drop,
        Duplicate,
        OdometryDrift,
        Outage,
        Push,
        Reorder,
        Slip,
        StuckRanges,
    )
}
"""Classes of faults, by name."""


def read_fault(text: str) -> Fault:
    """Returns the fault that a text describes. Nothing in the text is evaluated.

    Args:
        text: A call of a class in `mobile_robot_simulator.faults`, as in Python. All arguments are literals.

    Raises:
        ValueError: The text is not such a call, or an argument is missing, unknown or invalid. The message quotes the text.
    """
    if not isinstance(text, str):
        raise ValueError(f"a fault must be a text such as \"Drop('/scan', probability=0.1)\", got {quoted(text)}")
    try:
        return _read(text)
    except (ValueError, TypeError, RecursionError, MemoryError) as error:
        raise ValueError(f"fault {quoted(text)}: {error}") from None


def _read(text: str) -> Fault:
    needed = "must be a call such as Drop('/scan', probability=0.1)"
    try:
        call = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError) as error:
        raise ValueError(f"{needed}, not {getattr(error, 'msg', error)}") from None
    if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
        raise ValueError(needed)
    name = call.func.id
    if name not in FAULTS:
        raise ValueError(unknown_name(name, FAULTS, kind="fault"))
    kind = FAULTS[name]
    positional = [_literal(argument) for argument in call.args]
    named = {keyword.arg: _literal(keyword.value) for keyword in call.keywords if keyword.arg is not None}
    if len(named) != len(call.keywords):
        raise ValueError(f"the arguments of {name} must be written out, without **")
    known = _names_of_arguments(kind)
    for argument in named:
        if argument not in known:
            raise ValueError(unknown_name(argument, known, kind=f"argument of {name}"))
    inspect.signature(kind).bind(*positional, **named)
    return kind(*positional, **named)


def _literal(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError):
        raise ValueError(f"arguments must be numbers, texts, lists or None, got {ast.unparse(node)}") from None


def _names_of_arguments(kind: type[Fault]) -> list[str]:
    """Returns the names of all arguments of a class, with those that it passes on to its base class."""
    names: dict[str, None] = {}
    for base in kind.__mro__:
        if "__init__" not in vars(base):
            continue
        arguments = list(inspect.signature(vars(base)["__init__"]).parameters.values())[1:]
        names.update({argument.name: None for argument in arguments if argument.kind is not argument.VAR_KEYWORD})
        if not any(argument.kind is argument.VAR_KEYWORD for argument in arguments):
            break
    return list(names)
