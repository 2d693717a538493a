"""Refinement: for each scan of a log, the pose nearby that explains it best."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid
from ..logs import ScanLog
from .scoring import BASE_CAP, Scans, offsets

REACH = (0.3, 0.09)
"""Largest change in x and y [m], and in yaw [rad]."""

_LIMITS = np.array([REACH[0], *REACH])
_LEVELS = 7  # steps from 0.1 m and 0.03 rad to 1.6 mm and 0.5 mrad
_COARSE_BEAMS, _FINE_BEAMS = 60, 180
_CHUNK = 64


@dataclass(frozen=True)
class Refinement:
    """How the pose of each scan was changed.

    Attributes:
        poses: (N, 3) float64, the changed poses: x, y [m], yaw [rad].
        changes: (N, 3) float64, what was added: x, y [m], yaw [rad], in the map frame.
        errors_before: (N,) float64, mean error of the beams of each scan before, each error at most `scoring.BASE_CAP` [m].
        errors_after: (N,) float64, that error after. It is never larger.
        is_at_limit: (N,) bool, True if the change is the largest that was searched. The right pose may be farther away.
    """

    poses: NDArray[np.float64]
    changes: NDArray[np.float64]
    errors_before: NDArray[np.float64]
    errors_after: NDArray[np.float64]
    is_at_limit: NDArray[np.bool_]

    @property
    def distances(self) -> NDArray[np.float64]:
        """How far each pose was moved, (N,) float64 [m]."""
        return np.hypot(self.changes[:, 0], self.changes[:, 1])

    def report(self) -> dict[str, Any]:
        """Returns a summary of the changes, and all poses, as values that JSON has."""
        yaws = np.abs(self.changes[:, 2])
        return {
            "distance": {"median": float(np.median(self.distances)), "largest": float(self.distances.max())},
            "yaw": {"median": float(np.median(yaws)), "largest": float(yaws.max())},
            "error_before": float(self.errors_before.mean()),
            "error_after": float(self.errors_after.mean()),
            "at_limit": int(self.is_at_limit.sum()),
            "poses": self.poses.tolist(),
        }


def refine_poses(
    grid: OccupancyGrid,
    log: ScanLog,
    poses: NDArray[np.float64],
    *,
    progress: Callable[[float], None] = lambda _: None,
) -> Refinement:
    """Returns for each scan the pose within `REACH` with the least error of the beams, coarse to fine.

    Of equally good poses, the first one found is kept, which is the nearest on its lattice. So a pose stays where it is if
    the scan says nothing, such as one without returns in an empty map.

    Args:
        grid: The map.
        log: The log.
        poses: (N, 3) float64, poses of the scans on the map: x, y [m], yaw [rad].
        progress: Called repeatedly with the share of the scans that are done, up to 1.
    """
    found = np.empty_like(poses)
    before, after = np.empty(len(poses)), np.empty(len(poses))
    for first in range(0, len(poses), _CHUNK):
        rows = slice(first, min(first + _CHUNK, len(poses)))
        indices = np.arange(rows.start, rows.stop)
        coarse, fine = (Scans.of_log(grid, log, indices, most) for most in (_COARSE_BEAMS, _FINE_BEAMS))
        changes = np.zeros_like(poses[rows])
        step, yaw_step = REACH[0] / 3, REACH[1] / 3
        for level in range(_LEVELS):
            scans, reach = (coarse, 3) if level == 0 else (fine, 2)
            candidates = np.clip(changes[:, None] + offsets(step, yaw_step, reach, reach), -_LIMITS, _LIMITS)
            scores = scans.score(poses[rows, None] + candidates, BASE_CAP + 2 * step)
            best = scores.argmin(axis=1)
            changes = candidates[np.arange(len(changes)), best]
            step, yaw_step = step / 2, yaw_step / 2
        both = fine.score(np.stack([poses[rows], poses[rows] + changes], axis=1), BASE_CAP)
        changes[both[:, 1] >= both[:, 0]] = 0.0
        found[rows] = changes
        before[rows], after[rows] = both[:, 0], both.min(axis=1)
        progress(rows.stop / len(poses))
    is_at_limit: NDArray[np.bool_] = np.any(np.abs(found) >= _LIMITS - 1e-6, axis=1)
    return Refinement(poses + found, found, before, after, is_at_limit)
