"""Beams: the beams of a log's scanner, cast on a map."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._core import LaserScanner, OccupancyGrid, cast_rays
from ..logs import ScanLog

EVEN = 1e-4
"""Largest distance of an angle from an even spacing at which the beams still count as evenly spaced [rad]."""

_CHUNK = 2_000_000


class Beams:
    """The beams of a scanner, which may be unevenly spaced.

    Args:
        angles: (B,) float64, directions of the beams in the scanner's frame [rad].
        max_range: Range of a beam that hits nothing [m].

    Raises:
        ValueError: An angle is not finite, or `max_range` is not positive and finite.
    """

    def __init__(self, angles: NDArray[np.float64], max_range: float) -> None:
        self.angles, self.max_range = angles, max_range
        self._scanner = _even_scanner(angles, max_range)

    @classmethod
    def of_log(cls, log: ScanLog) -> Beams:
        """Returns the beams of a log's scanner."""
        return cls(log.angles, log.max_range)

    def __len__(self) -> int:
        return len(self.angles)

    def every(self, step: int) -> Beams:
        """Returns every `step`-th of the beams, from the first one on."""
        return Beams(self.angles[::step], self.max_range)

    def cast(
        self, grid: OccupancyGrid, poses: NDArray[np.float64], *, progress: Callable[[float], None] = lambda _: None
    ) -> NDArray[np.float32]:
        """Returns the true ranges of one scan from each pose.

        Args:
            grid: Map to scan.
            poses: (N, 3) float64, poses of the scanner in the map frame: x, y [m], yaw [rad].
            progress: Called repeatedly with the share of the scans that are done, up to 1.

        Returns:
            (N, B) float32 [m]. Exactly `max_range` means no return.
        """
        ranges = np.empty((len(poses), len(self)), np.float32)
        step = max(1, _CHUNK // len(self))
        for first in range(0, len(poses), step):
            rows = slice(first, min(first + step, len(poses)))
            if self._scanner is not None:
                self._scanner.scan_batch(grid, poses[rows], out=ranges[rows])
            else:
                rays = np.repeat(poses[rows], len(self), axis=0)
                rays[:, 2] += np.tile(self.angles, len(poses[rows]))
                cast_rays(grid, rays, self.max_range, out=ranges[rows].reshape(-1))
            progress(rows.stop / len(poses))
        return ranges


def _even_scanner(angles: NDArray[np.float64], max_range: float) -> LaserScanner | None:
    """Returns a scanner with these angles, or None if they are not evenly spaced."""
    if len(angles) < 2:
        return None
    step = (angles[-1] - angles[0]) / (len(angles) - 1)
    if step == 0.0 or np.abs(angles - (angles[0] + step * np.arange(len(angles)))).max() > EVEN:
        return None
    try:
        return LaserScanner(
            angle_min=angles[0], angle_increment=step, beam_count=len(angles), min_range=0.0, max_range=max_range
        )
    except ValueError:  # The angles go beyond what a scanner has, for example more than one turn.
        return None
