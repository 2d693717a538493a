"""Actions as they come from policies."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted


def checked_actions(actions: Any, shape: tuple[int, ...], name: str | None = "environment") -> NDArray[Any]:
    """Returns actions as an array.

    Args:
        actions: Actions (N, A), one row for each environment.
        shape: The shape that they must have.
        name: What a row is called in errors; None if there is one environment only.

    Raises:
        ValueError: The shape is wrong, or a number is not finite.
        TypeError: They are no array of real numbers.
    """
    try:
        array = np.asarray(actions)
    except ValueError:
        raise ValueError(f"actions must have shape {shape if name else shape[1:]}, got rows of different lengths") from None
    if array.dtype.kind not in "fiub":
        raise TypeError(f"actions must be an array of real numbers, got {array.dtype} in {quoted(actions)}")
    if array.shape != shape:
        got, needed = (array.shape, shape) if name else (array.shape[1:], shape[1:])
        raise ValueError(f"actions must have shape {needed}, got {got}")
    if not (finite := np.isfinite(array)).all():
        row = int(finite.all(axis=1).argmin())
        where = f" for {name} {row}" if name else ""
        raise ValueError(f"actions must be finite, got {array[row].tolist()}{where}")
    return array
