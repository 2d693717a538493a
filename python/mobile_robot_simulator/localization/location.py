"""Location: the poses from which a scan was most likely taken, found by scoring poses all over the map."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, LaserScanner, OccupancyGrid
from ..quoting import quoted

SPACING = 0.25
"""Distance between the positions that are scored at first [m]."""

HEADINGS = 72
"""Number of headings that are scored at each of them."""

COARSE_SIGMA = 0.3
"""Standard deviation of the hit part at first [m], which forgives the distance to the nearest of these poses."""

COARSE_BEAMS = 60
"""Number of beams, at most, that are scored at first."""

KEPT = (2000, 1000, 500, 250, 120)
"""Number of poses that are kept before each halving of the distances but the first, each the best of its surroundings."""

KEPT_AT_FIRST = 64
"""Before the first halving, one pose in this many is kept, because from the nearest of the first poses, distant walls are
missed by more than `COARSE_SIGMA`. In a small map it is at least the first of `KEPT`."""

KEPT_OF_PLACE = 4
"""Number of poses, at most, that are kept of one place, so that other places are not lost."""

CHUNK = 100_000
"""Number of poses that are scored between two calls of the progress callback."""

APART = (0.5, math.radians(10.0))
"""Poses that are farther apart than this, in position [m] or heading [rad], are different places."""


@dataclass(frozen=True, slots=True, eq=False)
class Location:
    """The poses from which a scan was most likely taken.

    Attributes:
        poses: (N, 3) float64, rows (x, y, yaw) in the map frame [m, m, rad], the likeliest first. Each is the best of its
            surroundings.
        log_likelihoods: (N,) float64, the log-likelihood of each, all beams counted.
    """

    poses: NDArray[np.float64]
    log_likelihoods: NDArray[np.float64]

    @property
    def margin(self) -> float:
        """By how much the first log-likelihood exceeds the second, infinite if there is no second.

        Near 0, two places look the same, and the scan cannot tell which one is right.
        """
        return float(self.log_likelihoods[0] - self.log_likelihoods[1]) if len(self.poses) > 1 else math.inf

    def __repr__(self) -> str:
        x, y, yaw = self.poses[0]
        return f"Location(({x:.3f}, {y:.3f}, {yaw:.4f}), {len(self.poses)} places, margin {self.margin:.1f})"


def locate(
    grid: OccupancyGrid,
    laser: LaserScanner,
    ranges: NDArray[np.float32],
    *,
    noise: BeamModel,
    progress: Callable[[float], None] | None = None,
    threads: int | None = None,
) -> Location:
    """Finds where in a map a scan was taken, with nothing else known.

    Poses in all free cells, 0.25 m and 5° apart, are scored with a wide beam model and some of the beams. Around the best of
    them, the distances are halved again and again, soon with all beams, until they are below 5 mm. The last scores are
    those of `noise`.

    Args:
        grid: Map. The robot can be in cells that are known and free.
        laser: Scanner that took the scan, with its mount.
        ranges: (beam_count,) float32, the readings [m], as measured or as a `LaserScan` message has them.
        noise: Beam model of the readings.
        progress: Called with the share of the work that is done, 0 to 1.
        threads: Number of threads; None means one per core. The result does not depend on it.

    Returns:
        The likeliest pose of each place, at most 20 places.

    Raises:
        ValueError: The shape of `ranges` is wrong, no reading counts, or the map has no free cell.
        TypeError: An argument has the wrong type or dtype.

    Examples:
        >>> import mobile_robot_simulator as mrs
        >>> from mobile_robot_simulator.localization import locate
        >>> grid, laser = mrs.floor_plan("office", seed=1, size=(20.0, 15.0)), mrs.LaserScanner()
        >>> noise = mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1)
        >>> scan = laser.scan_batch(grid, [(6.0, 9.0, 1.0)], noise=noise, seed=1)[0]
        >>> found = locate(grid, laser, scan, noise=noise)
        >>> [round(float(number), 1) for number in found.poses[0]]
        [6.0, 9.0, 1.0]
    """
    if not np.any(ranges < laser.max_range):
        raise ValueError(f"ranges must have at least one return, got {quoted(ranges)}")
    poses = _poses_everywhere(grid)
    step = math.ceil(laser.beam_count / COARSE_BEAMS)
    scores = np.empty(len(poses))
    for start in range(0, len(poses), CHUNK):
        part = slice(start, start + CHUNK)
        laser.log_likelihood(
            grid, poses[part], ranges, noise=_wide(COARSE_SIGMA), beams=step, threads=threads, out=scores[part]
        )
        if progress is not None:
            progress(0.9 * min(1.0, (start + CHUNK) / len(poses)))
    spacing, turn = SPACING, 2.0 * math.pi / HEADINGS
    for halving, kept in enumerate((max(KEPT[0], len(poses) // KEPT_AT_FIRST), *KEPT)):
        best = poses[_best_of_surroundings(poses, scores, spacing, turn)[:kept]]
        spacing, turn = 0.5 * spacing, 0.5 * turn
        poses = _around(best, spacing, turn)
        model = _wide(max(COARSE_SIGMA * 0.5 ** (halving + 1), noise.sigma_hit))
        beams = step if halving == 0 else None
        scores = laser.log_likelihood(grid, poses, ranges, noise=model, beams=beams, threads=threads)
        if progress is not None:
            progress(0.9 + 0.1 * halving / len(KEPT))
    scores = laser.log_likelihood(grid, poses, ranges, noise=noise, threads=threads)
    return _places(poses, scores)


def _wide(sigma: float) -> BeamModel:
    """Returns a beam model that forgives wrong readings."""
    return BeamModel(sigma_hit=sigma, z_hit=0.75, z_short=0.0, z_max=0.05, z_rand=0.2)


def _poses_everywhere(grid: OccupancyGrid) -> NDArray[np.float64]:
    """Returns poses in all free cells, `SPACING` apart, with all headings, (N, 3)."""
    every = max(1, round(SPACING / grid.resolution))
    cells = grid.cells[every // 2 :: every, every // 2 :: every]
    rows, cols = np.nonzero((cells >= 0) & (cells < grid.occupied_threshold))
    if not len(rows):
        raise ValueError(f"the map must have a free cell, got {quoted(grid)}")
    places = np.stack((cols, rows), axis=1) * every + every // 2 + 0.5
    x, y = places.T * grid.resolution
    origin = grid.origin
    sin, cos = math.sin(origin.yaw), math.cos(origin.yaw)
    positions = np.stack((origin.x + cos * x - sin * y, origin.y + sin * x + cos * y), axis=1)
    headings = np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS)
    return np.column_stack((np.repeat(positions, HEADINGS, axis=0), np.tile(headings, len(positions))))


def _around(poses: NDArray[np.float64], spacing: float, turn: float) -> NDArray[np.float64]:
    """Returns poses at and around each pose: 3 by 3 positions with 3 headings."""
    steps = np.array([-1.0, 0.0, 1.0])
    offsets = np.stack(np.meshgrid(steps * spacing, steps * spacing, steps * turn), axis=-1).reshape(-1, 3)
    around: NDArray[np.float64] = (poses[:, np.newaxis] + offsets).reshape(-1, 3)
    return around


def _best_of_surroundings(poses: NDArray[np.float64], scores: NDArray[np.float64], spacing: float, turn: float) -> list[int]:
    """Returns the indices of poses that are the best within two steps or so, best first, with a few of each place."""
    order = np.argsort(-scores, kind="stable")
    _, first = np.unique(_boxes(poses[order], 2.0 * spacing, 2.0 * turn), axis=0, return_index=True)
    best = order[np.sort(first)].tolist()
    kept_of: Counter[tuple[float, ...]] = Counter()
    kept = []
    for index, place in zip(best, map(tuple, _boxes(poses[best], *APART).tolist()), strict=True):
        kept_of[place] += 1
        if kept_of[place] <= KEPT_OF_PLACE:
            kept.append(index)
    return kept


def _boxes(poses: NDArray[np.float64], length: float, turn: float) -> NDArray[np.float64]:
    """Returns the number of the box that each pose is in, (N, 3), of boxes with this length [m] and turn [rad]."""
    boxes: NDArray[np.float64] = np.floor(poses / (length, length, turn))
    return boxes


def _places(poses: NDArray[np.float64], scores: NDArray[np.float64]) -> Location:
    """Returns the best pose of each place; the likeliest 20 places."""
    found: list[int] = []
    for index in np.argsort(-scores, kind="stable").tolist():
        x, y, yaw = np.abs(poses[found] - poses[index]).T
        turn = np.abs(np.remainder(yaw + math.pi, 2.0 * math.pi) - math.pi)
        if np.all((np.hypot(x, y) > APART[0]) | (turn > APART[1])):
            found.append(index)
        if len(found) == 20:
            break
    chosen = poses[found]
    chosen[:, 2] = np.remainder(chosen[:, 2] + math.pi, 2.0 * math.pi) - math.pi
    return Location(chosen, scores[found])
