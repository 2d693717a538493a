"""Alignment: the shift and the yaw of a log's frame that explain its scans best."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid, Pose
from ..logs import ScanLog
from ..quoting import quoted
from .scoring import BASE_CAP, Scans, offsets

REACH = (1.0, 0.2)
"""Default of the largest shift in x and y [m], and of the largest yaw [rad]."""

MOST_POSES = 12_000_000
"""Largest number of poses of the frame that are tried at first."""

_COARSEST, _FINEST = 0.4, 0.001  # steps of the shift [m]
_COARSE_SCANS, _FINE_SCANS = 16, 64
_COARSE_BEAMS, _FINE_BEAMS = 45, 180
_KEPT = 32  # candidates that go to the next level
_CHUNK = 2_000


@dataclass(frozen=True)
class Alignment:
    """Where a log's frame lies in the map.

    Attributes:
        map_from_log: Pose of the log's frame in the map frame.
        shift: How far the centre of the log's poses moved: x, y [m].
        yaw: How far the poses turned about their centre [rad].
        error_before: Mean error of the beams before, each error at most `scoring.BASE_CAP` [m].
        error_after: That error after.
        is_at_limit: True if the shift or the yaw is the largest that was searched. The log may lie farther away.
    """

    map_from_log: Pose
    shift: tuple[float, float]
    yaw: float
    error_before: float
    error_after: float
    is_at_limit: bool

    def report(self) -> dict[str, Any]:
        """Returns the attributes as values that JSON has."""
        return {
            "map_from_log": list(self.map_from_log),
            "shift": list(self.shift),
            "yaw": self.yaw,
            "error_before": self.error_before,
            "error_after": self.error_after,
            "is_at_limit": self.is_at_limit,
        }


def align_log(
    grid: OccupancyGrid,
    log: ScanLog,
    *,
    reach: tuple[float, float] = REACH,
    progress: Callable[[float], None] = lambda _: None,
) -> Alignment:
    """Returns the shift and the yaw of a log's frame with the least error of the beams, coarse to fine.

    A lattice of candidates is scored with some of the scans and beams. Around the best ones, a lattice of half the steps
    is scored with more of them, and so on, down to steps of 1 mm. One step of yaw moves the points that the scans saw about
    as far as one step of shift.

    Args:
        grid: The map.
        log: The log.
        reach: Largest shift in x and y [m], and largest yaw [rad].
        progress: Called repeatedly with the share of the work that is done, up to 1.

    Raises:
        ValueError: `reach` is negative, not finite, not two numbers, or needs more than `MOST_POSES` poses.
        TypeError: `reach` is not a sequence of numbers.
    """
    largest_shift, largest_yaw = _to_reach(reach)
    if not (0.0 <= largest_shift < math.inf and 0.0 <= largest_yaw <= math.pi):
        raise ValueError(f"reach must be at least 0 m and 0 to π rad, got {largest_shift} and {largest_yaw}")
    centre = log.poses[:, :2].mean(axis=0)
    lever = _lever(log, centre)
    step = min(_COARSEST, max(largest_shift / 2, _FINEST))
    yaw_step = step / lever
    steps, yaw_steps = math.ceil(largest_shift / step), math.ceil(largest_yaw / yaw_step)
    count = (2 * steps + 1) ** 2 * (2 * yaw_steps + 1)
    if count > MOST_POSES:
        raise ValueError(
            f"reach must need at most {MOST_POSES} poses, got {largest_shift}, {largest_yaw}, which needs {count}"
        )
    candidates = offsets(step, yaw_step, steps, yaw_steps)
    limits = np.array([largest_shift, largest_shift, largest_yaw])
    best, level = candidates[(np.abs(candidates) <= limits + 1e-12).all(axis=1)], 0
    levels = math.ceil(math.log2(step / _FINEST)) + 1
    while True:
        scans = min(_COARSE_SCANS * 2**level, _FINE_SCANS)
        score = _Score(grid, log, centre, scans, _FINE_BEAMS if level > 1 else _COARSE_BEAMS)
        scores = score(best, BASE_CAP + 2 * step, _part(progress, level, levels))
        best = best[np.argsort(scores, kind="stable")[:_KEPT]]
        level += 1
        if step <= _FINEST:
            break
        step, yaw_step = step / 2, yaw_step / 2
        around = (best[:, None] + offsets(step, yaw_step, 2, 2)).reshape(-1, 3)
        best = np.unique(np.clip(around.round(9), -limits, limits), axis=0)
    found = best[0]
    errors = score(np.array([np.zeros(3), found]), BASE_CAP)
    before, after = float(errors[0]), float(errors[1])
    progress(1.0)
    if after >= before:
        found, after = np.zeros(3), before
    turn = Pose(0.0, 0.0, float(found[2]))
    x, y, _ = turn * (*-centre, 0.0)
    map_from_log = Pose(float(centre[0] + found[0]) + x, float(centre[1] + found[1]) + y, float(found[2]))
    is_at_limit = bool((np.abs(found) >= limits - 1e-6)[limits > 0.0].any())
    return Alignment(map_from_log, (float(found[0]), float(found[1])), float(found[2]), before, after, is_at_limit)


def _to_reach(reach: object) -> tuple[float, float]:
    try:
        numbers = tuple(map(float, reach)) if not isinstance(reach, str) else None  # type: ignore[call-overload]
    except (TypeError, ValueError):
        numbers = None
    if numbers is None or len(numbers) != 2:
        kind = TypeError if numbers is None else ValueError
        raise kind(f"reach must be two numbers, the largest shift [m] and yaw [rad], got {quoted(reach)}")
    return numbers[0], numbers[1]


def moved(poses: NDArray[np.float64], map_from_log: Pose) -> NDArray[np.float64]:
    """Returns poses (N, 3) of the log's frame in the map frame."""
    x, y, yaw = map_from_log
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.column_stack(
        [
            x + cos * poses[:, 0] - sin * poses[:, 1],
            y + sin * poses[:, 0] + cos * poses[:, 1],
            poses[:, 2] + yaw,
        ]
    )


def _part(progress: Callable[[float], None], level: int, levels: int) -> Callable[[float], None]:
    return lambda share: progress((level + share) / levels)


def _lever(log: ScanLog, centre: NDArray[np.float64]) -> float:
    """Returns how far the points that the scans saw are from the centre of the poses: the median, at least 1 m."""
    finite = log.ranges[np.isfinite(log.ranges)]
    seen = float(np.median(finite)) if len(finite) else 0.0
    return max(1.0, math.hypot(seen, float(np.median(np.hypot(*(log.poses[:, :2] - centre).T)))))


class _Score:
    """Mean error of some scans and beams of a log, as a function of shift and yaw."""

    def __init__(
        self, grid: OccupancyGrid, log: ScanLog, centre: NDArray[np.float64], scan_count: int, beam_count: int
    ) -> None:
        rows = np.unique(np.linspace(0, len(log.ranges) - 1, scan_count).round().astype(int))
        self._poses, self._centre = log.poses[rows], centre
        self._scans = Scans.of_log(grid, log, rows, beam_count)

    def __call__(
        self, candidates: NDArray[np.float64], cap: float, progress: Callable[[float], None] = lambda _: None
    ) -> NDArray[np.float64]:
        """Returns the scores (K,) of candidates (K, 3): x, y [m], yaw [rad]."""
        scores = np.empty(len(candidates))
        for first in range(0, len(candidates), _CHUNK):
            rows = slice(first, first + _CHUNK)
            dx, dy, dyaw = candidates[rows].T
            cos, sin = np.cos(dyaw), np.sin(dyaw)
            x, y = (self._poses[:, :2] - self._centre).T[..., None]
            poses = np.stack(
                [
                    self._centre[0] + dx + cos * x - sin * y,
                    self._centre[1] + dy + sin * x + cos * y,
                    self._poses[:, 2:] + dyaw,
                ],
                axis=-1,
            )
            weights = self._scans.counts / max(1, self._scans.counts.sum())
            scores[rows] = weights @ self._scans.score(poses, cap)
            progress(min(1.0, rows.stop / len(candidates)))
        return scores
