"""Episode: the scans of a drive, in the order of time."""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.typing import NDArray

from .plan import Plan
from .scenes import Column, columns_of

__all__ = ["ACTION", "Episode", "columns_of_episodes"]

ACTION = "commands"
"""Column of the actions."""


class Episode(NamedTuple):
    """The scans of a drive, in the order of time."""

    scene: int
    """Number of its scene in its split."""

    map: str
    """Name of its map."""

    rows: dict[str, NDArray[Any]]
    """Rows of each column of `columns_of_episodes`."""


def columns_of_episodes(plan: Plan) -> dict[str, Column]:
    """Returns the columns that an episode has, actions among them. A number in a row has shape (1,)."""
    columns = {name: column for name, column in columns_of(plan).items() if name != "scene"}
    return {name: column._replace(shape=column.shape or (1,)) for name, column in columns.items()}
