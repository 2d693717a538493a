"""Floor plans to train on, and others to test on."""

from __future__ import annotations

from .._core import OccupancyGrid
from ..maps.floor_plans import floor_plan
from ..quoting import quoted


def training_plans(
    count: int, kind: str = "office", *, size: tuple[float, float] = (20.0, 15.0), resolution: float = 0.05
) -> list[OccupancyGrid]:
    """Returns floor plans to train on: those of the seeds 0, 2, 4 and so on.

    Args:
        count: Number of plans, at least 1.
        kind: Kind of the plans, as in `floor_plan`.
        size: Width and height [m].
        resolution: Side of a cell [m].

    Raises:
        ValueError: An argument is out of range.
        TypeError: An argument has the wrong type.
    """
    return _plans(count, 0, kind, size, resolution)


def unseen_plans(
    count: int, kind: str = "office", *, size: tuple[float, float] = (20.0, 15.0), resolution: float = 0.05
) -> list[OccupancyGrid]:
    """Returns floor plans to test on, none of which is a training plan: those of the seeds 1, 3, 5 and so on.

    Args:
        count: Number of plans, at least 1.
        kind: Kind of the plans, as in `floor_plan`.
        size: Width and height [m].
        resolution: Side of a cell [m].

    Raises:
        ValueError: An argument is out of range.
        TypeError: An argument has the wrong type.
    """
    return _plans(count, 1, kind, size, resolution)


def _plans(count: int, first: int, kind: str, size: tuple[float, float], resolution: float) -> list[OccupancyGrid]:
    if count < 1:
        raise ValueError(f"count must be at least 1, got {quoted(count)}")
    return [floor_plan(kind, seed=first + 2 * index, size=size, resolution=resolution) for index in range(count)]
