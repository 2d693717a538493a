"""Residuals: measured ranges less simulated ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

NEAR = (0.05, 0.10, 0.20)
"""Sizes of residuals within which a share is reported [m]."""

BIN = 0.01
"""Width of a bin of the histogram [m]."""

LARGEST_BIN = 0.5
"""The bins of the histogram go from minus this residual to this one [m]."""


@dataclass(frozen=True)
class Spread:
    """Size of some residuals.

    Attributes:
        count: Number of residuals.
        median: Median [m]; positive if real returns are farther than simulated ones. NaN without residuals.
        mad: Median of the absolute deviations from the median [m]. For normal errors, sigma is 1.4826 times as large.
        within: Shares of the residuals whose size is at most 0.05, 0.10 and 0.20 m, by that size.
    """

    count: int
    median: float
    mad: float
    within: dict[float, float]

    @classmethod
    def of(cls, values: NDArray[np.float32]) -> Spread:
        """Returns the spread of residuals [m] of any shape. NaN is left out."""
        values = values[~np.isnan(values)]
        if not len(values):
            return cls(0, np.nan, np.nan, dict.fromkeys(NEAR, np.nan))
        median, size = np.median(values), np.abs(values)
        mad = np.median(np.abs(values - median))
        return cls(len(values), float(median), float(mad), {near: float((size <= near).mean()) for near in NEAR})

    def report(self) -> dict[str, Any]:
        """Returns the attributes as values that JSON has. None stands for NaN."""
        known = self.count > 0
        return {
            "count": self.count,
            "median": self.median if known else None,
            "mad": self.mad if known else None,
            "within": {f"{near:.2f}": share if known else None for near, share in self.within.items()},
        }


class Residuals:
    """Measured ranges less simulated ones, and what became of the beams without one of the two.

    Args:
        readings: (N, B) float32, measured ranges with the marks of REP-117 [m].
        simulated: (N, B) float32, true ranges on the map [m]. Exactly `max_range` means no return.
        max_range: Range from which on a beam has no return [m].

    Attributes:
        values: (N, B) float32, the residuals [m]. NaN where the log or the simulation has no return.
        counts: Number of beams by what became of them: `both` have a return in the log and in the simulation, `log_only` and
            `simulation_only` in one of the two, `none` in neither. `near` read less than the smallest range, `failed` NaN.
    """

    def __init__(self, readings: NDArray[np.float32], simulated: NDArray[np.float32], max_range: float) -> None:
        is_return, hits = np.isfinite(readings), simulated < max_range
        both, missed = is_return & hits, readings == np.inf
        self.values = np.full_like(readings, np.nan)
        np.subtract(readings, simulated, out=self.values, where=both)
        counts = {
            "both": both,
            "log_only": is_return & ~hits,
            "simulation_only": missed & hits,
            "none": missed & ~hits,
            "near": readings == -np.inf,
            "failed": np.isnan(readings),
        }
        self.counts = {name: int(mask.sum()) for name, mask in counts.items()}

    @property
    def spread(self) -> Spread:
        """Spread of all residuals."""
        return Spread.of(self.values)

    def histogram(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Returns the edges of the bins [m], (K + 1,), and the number of residuals in each, (K,).

        Residuals beyond the ends are in no bin.
        """
        half = round(LARGEST_BIN / BIN)
        edges = np.arange(-half, half + 1, dtype=np.float64) * BIN
        values = self.values[~np.isnan(self.values)]
        return edges, np.histogram(values, edges)[0].astype(np.int64)
