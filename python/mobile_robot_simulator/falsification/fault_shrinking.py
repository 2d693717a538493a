"""Fault shrinking: makes the text of a fault smaller, that is shorter, weaker or with simpler numbers."""

from __future__ import annotations

import ast
from collections.abc import Iterator

__all__ = ["simpler_faults", "simpler_numbers", "smaller_faults"]

STRENGTHS = {"Push": "speed", "Slip": "share", "OdometryDrift": "alphas"}
"""First argument of some faults: the smaller, the weaker."""

SHARES = (0.5, 0.75)
"""Shares of a duration or a strength to try."""

SHORTEST, WEAKEST = 0.1, 0.001
"""Smallest duration [s] and smallest number of a strength that are tried."""


def smaller_faults(text: str) -> Iterator[str]:
    """Yields the text of a fault that ends earlier, or is weaker.

    Args:
        text: The fault, as a text that `--fault` takes.
    """
    for share in SHARES:
        call = _call(text)
        start, end = _named(call, "start"), _named(call, "end")
        if end is not None:
            begun = 0.0 if start is None else _value(start)
            earlier = round(begun + max(SHORTEST, round((_value(end) - begun) * share, 1)), 3)
            if earlier < _value(end):
                end.value = earlier
                yield ast.unparse(call)
    for share in SHARES:
        call = _call(text)
        numbers = _strength(call)
        weaker = [float(f"{_value(node) * share:.2g}") for node in numbers]
        if any(weaker) and all(number >= WEAKEST or not number for number in weaker):
            for node, number in zip(numbers, weaker, strict=True):
                node.value = number
            yield ast.unparse(call)


def simpler_faults(text: str) -> Iterator[str]:
    """Yields the text of a fault with one of its numbers simpler. It lasts no longer, and is no stronger.

    Args:
        text: The fault, as a text that `--fault` takes.
    """
    for index in range(len(_numbers(_call(text)))):
        call = _call(text)
        node, end = _numbers(call)[index], _named(call, "end")
        before, is_limited = _value(node), node is end or node in _strength(call)
        duration = None if end is None or node is not _named(call, "start") else _value(end) - before
        for number in simpler_numbers(before):
            if is_limited and number > before:
                continue
            if isinstance(node.value, int) and not number.is_integer():
                continue
            node.value = int(number) if isinstance(node.value, int) else number
            if duration is not None:
                assert end is not None
                end.value = round(number + duration, 3)
            yield ast.unparse(_WithoutMinusZero().visit(call))


def simpler_numbers(number: float) -> Iterator[float]:
    """Yields numbers near a number that take fewer characters, the shortest first.

    Args:
        number: The number.
    """
    seen = {number}
    for candidate in (0.0, round(number), round(2 * number) / 2, round(number, 1), round(number, 2), round(number, 3)):
        if candidate not in seen and len(f"{candidate:g}") < len(f"{number!r}".removesuffix(".0")):
            seen.add(candidate)
            yield float(candidate)


class _WithoutMinusZero(ast.NodeTransformer):
    """Writes -0.0 as 0.0."""

    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.expr:
        is_zero = isinstance(node.operand, ast.Constant) and node.operand.value == 0
        return node.operand if is_zero else node


def _call(text: str) -> ast.Call:
    call = ast.parse(text, mode="eval").body
    assert isinstance(call, ast.Call)
    return call


def _numbers(node: ast.AST) -> list[ast.Constant]:
    return [each for each in ast.walk(node) if isinstance(each, ast.Constant) and type(each.value) in (float, int)]


def _named(call: ast.Call, name: str) -> ast.Constant | None:
    """Returns the number of a named argument, None if it has none."""
    values = [keyword.value for keyword in call.keywords if keyword.arg == name]
    return next(iter(_numbers(values[0])), None) if values else None


def _strength(call: ast.Call) -> list[ast.Constant]:
    """Returns the numbers that say how strong a fault is; none for most kinds."""
    name = STRENGTHS.get(ast.unparse(call.func))
    if name is None:
        return []
    values = [keyword.value for keyword in call.keywords if keyword.arg == name] or call.args[:1]
    return [number for value in values for number in _numbers(value)]


def _value(node: ast.Constant) -> float:
    assert isinstance(node.value, float | int)
    return float(node.value)
