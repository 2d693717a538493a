"""Scores: how badly poses explain scans."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid
from ..logs import ScanLog
from .beams import Beams

BASE_CAP = 0.2
"""Error of a beam above which it counts no more, at the finest step [m]. From right poses, few beams have a larger one."""

_CHUNK = 4_000_000


class Scans:
    """Scans that poses are scored against.

    Args:
        grid: The map.
        beams: Beams of the scans.
        readings: (N, B) float32, measured ranges with the marks of REP-117 [m].
    """

    def __init__(self, grid: OccupancyGrid, beams: Beams, readings: NDArray[np.float32]) -> None:
        self._grid, self._beams = grid, beams
        self._is_used = ~np.isnan(readings) & (readings != -np.inf)
        self._readings = np.where(self._is_used, np.minimum(readings, np.float32(beams.max_range)), np.float32(0.0))
        self.counts = self._is_used.sum(axis=1)

    @classmethod
    def of_log(cls, grid: OccupancyGrid, log: ScanLog, rows: NDArray[np.intp], most: int) -> Scans:
        """Returns some scans of a log, with every k-th beam so that about `most` are left.

        Args:
            grid: The map.
            log: The log.
            rows: (N,) indices of the scans.
            most: Number of beams; up to twice as many are left.
        """
        step = max(1, len(log.angles) // most)
        return cls(grid, Beams.of_log(log).every(step), np.ascontiguousarray(log.ranges[rows, ::step]))

    def score(self, poses: NDArray[np.float64], cap: float) -> NDArray[np.float64]:
        """Returns the mean error of the beams of each scan from each of its poses. A beam's error counts at most `cap`.

        A beam without a return has the error between `max_range` and the simulated range.

        Args:
            poses: (N, K, 3) float64, K poses of the scanner for each scan: x, y [m], yaw [rad].
            cap: Largest error of a beam [m].

        Returns:
            (N, K) float64 [m]; 0 for a scan in which no beam can be used.
        """
        count, each, _ = poses.shape
        scores = np.empty((count, each))
        step = max(1, _CHUNK // (each * len(self._beams)))
        for first in range(0, count, step):
            rows = slice(first, first + step)
            ranges = self._beams.cast(self._grid, poses[rows].reshape(-1, 3)).reshape(-1, each, len(self._beams))
            ranges -= self._readings[rows, None, :]
            np.abs(ranges, out=ranges)
            np.minimum(ranges, np.float32(cap), out=ranges)
            sums = np.einsum("nkb,nb->nk", ranges, self._is_used[rows].astype(np.float32))
            scores[rows] = sums / np.maximum(self.counts[rows, None], 1)
        return scores


def offsets(step: float, yaw_step: float, reach: int, yaw_reach: int) -> NDArray[np.float64]:
    """Returns a lattice of offsets around 0, the smallest first, so that the smallest of equally good ones is found first.

    Args:
        step: Distance between neighbours in x and y [m].
        yaw_step: Distance between neighbours in yaw [rad].
        reach: Number of steps to each side in x and y.
        yaw_reach: Number of steps to each side in yaw.

    Returns:
        (K, 3) float64: x, y [m], yaw [rad].
    """
    flat, turns = np.arange(-reach, reach + 1.0), np.arange(-yaw_reach, yaw_reach + 1.0)
    lattice = np.stack(np.meshgrid(flat, flat, turns, indexing="ij"), axis=-1).reshape(-1, 3)
    lattice = lattice[np.argsort((lattice**2).sum(axis=1), kind="stable")]
    scaled: NDArray[np.float64] = lattice * np.array([step, step, yaw_step])
    return scaled
