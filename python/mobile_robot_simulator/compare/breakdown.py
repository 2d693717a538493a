"""Breakdowns: the residuals by range, by incidence, by beam and by place."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .residuals import Spread

RANGES = (0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, math.inf)
"""Limits of the bands of simulated ranges [m]."""

INCIDENCES = tuple(math.radians(15.0 * k) for k in range(7))
"""Limits of the bands of incidence [rad]."""

PATCH = 0.5
"""Side of the squares of the map whose beams are taken together [m]."""

WRONG = 0.2
"""A beam whose residual is larger than this is wrong [m]."""

MOST_PLACES = 20
"""Number of places that are listed."""


@dataclass(frozen=True)
class Band:
    """The residuals of the beams whose range, or incidence, is in a band.

    Attributes:
        low: Lower limit, which belongs to the band.
        high: Upper limit. It belongs to the next band.
        spread: Spread of their residuals.
    """

    low: float
    high: float
    spread: Spread


def bands(values: NDArray[np.float32], by: NDArray[np.float32], limits: tuple[float, ...]) -> list[Band]:
    """Returns the bands that have residuals.

    Args:
        values: Residuals of any shape [m]. NaN is left out.
        by: What decides the band, of the same shape.
        limits: Limits of the bands, growing. The last one belongs to the last band.
    """
    is_known = ~np.isnan(values)
    values, by = values[is_known], by[is_known]
    found = []
    for low, high in itertools.pairwise(limits):
        in_band = (by >= low) & ((by <= high) if high == limits[-1] else (by < high))
        if in_band.any():
            found.append(Band(low, high, Spread.of(values[in_band])))
    return found


@dataclass(frozen=True)
class Place:
    """A square of the map in which beams ended.

    Attributes:
        x: Middle of the square in the map frame [m].
        y: Middle of the square in the map frame [m].
        count: Number of beams that ended there.
        wrong: Number of those with a residual larger than `WRONG`.
        median: Median of the residuals of the wrong ones [m]. Negative: something stands there that the map does not have.
            Positive: the map has something before it that is not there.
    """

    x: float
    y: float
    count: int
    wrong: int
    median: float


def wrong_places(values: NDArray[np.float32], ends: NDArray[np.float64]) -> list[Place]:
    """Returns the squares of side `PATCH` in which most wrong beams ended, the worst first, at most `MOST_PLACES`.

    Args:
        values: (N,) float32, residuals without NaN [m].
        ends: (N, 2) float64, where the real beams ended in the map frame [m].
    """
    squares, square, counts = np.unique(np.floor(ends / PATCH), axis=0, return_inverse=True, return_counts=True)
    is_wrong = np.abs(values) > WRONG
    square = square.reshape(-1)
    wrong = np.bincount(square[is_wrong], minlength=len(squares))
    worst = np.argsort(-wrong, kind="stable")[:MOST_PLACES]
    return [
        Place(
            x=float(squares[k, 0] + 0.5) * PATCH,
            y=float(squares[k, 1] + 0.5) * PATCH,
            count=int(counts[k]),
            wrong=int(wrong[k]),
            median=float(np.median(values[is_wrong & (square == k)])),
        )
        for k in worst
        if wrong[k]
    ]


@dataclass(frozen=True)
class Breakdown:
    """The residuals by range, by incidence, by beam and by place.

    Attributes:
        by_range: By simulated range [m].
        by_incidence: By the angle between the beam and the normal of the simulated wall [rad].
        by_beam: For each beam of a scan.
        places: Where most beams are wrong, the worst first.
    """

    by_range: list[Band]
    by_incidence: list[Band]
    by_beam: list[Spread]
    places: list[Place]

    def report(self) -> dict[str, Any]:
        """Returns the attributes as values that JSON has; None stands for a number that is not known or not finite."""
        return {
            "by_range": [_band(band) for band in self.by_range],
            "by_incidence": [_band(band) for band in self.by_incidence],
            "by_beam": [spread.report() for spread in self.by_beam],
            "places": [vars(place) for place in self.places],
        }


def _band(band: Band) -> dict[str, Any]:
    return {"low": band.low, "high": band.high if math.isfinite(band.high) else None, **band.spread.report()}
