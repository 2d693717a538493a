"""Location: the poses from which a scan was most likely taken, found by scoring poses all over the map."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, LaserScanner, OccupancyGrid
from .everywhere import SPACING, TURN, best_everywhere

COARSE_SIGMA = 0.3
"""Standard deviation of the hit part at first [m], which forgives the distance to the nearest of these poses."""

BEAMS = (100, 200, 200)
"""Number of beams, at most, that are scored after the first halvings of the distances; then all are."""

KEPT = (3000, 1000, 500, 250, 120, 120)
"""Number of poses that are kept before each halving; in a large map, more before the first, see `KEPT_AT_FIRST`."""

KEPT_AT_FIRST = 64
"""Of the best poses everywhere, one in this many is kept in a large map, because from the nearest of them, distant walls are
missed by more than `COARSE_SIGMA`."""

KEPT_OF_PLACE = 4
"""Number of poses, at most, that are kept of one place, so that other places are not lost."""

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

    Poses in all free cells, 0.25 m and 2.5° apart, are scored with a wide beam model and some of the beams. Around the best
    of them, the distances are halved again and again, soon with all beams, until they are below 5 mm. The last scores are
    those of `noise`.

    Args:
        grid: Map. The scanner can be above cells that are known and free.
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
    if isinstance(laser, LaserScanner) and isinstance(ranges, np.ndarray) and ranges.shape != (laser.beam_count,):
        raise ValueError(f"ranges must have shape ({laser.beam_count},), got {ranges.shape}")
    laser.log_likelihood(grid, np.empty((0, 3)), ranges, noise=noise, threads=threads)  # Checks the arguments.
    if not np.any(ranges < laser.max_range):
        failed = np.count_nonzero(np.isnan(ranges))
        far = f"{len(ranges) - failed} of at least max_range, {laser.max_range:g} m"
        raise ValueError(f"ranges must have at least one return, got {failed} readings that are NaN and {far}")
    if progress is None:
        progress = _ignore
    poses, scores = best_everywhere(
        grid, laser, ranges, _wide(COARSE_SIGMA), progress=lambda share: progress(0.6 * share), threads=threads
    )
    spacing, turn = SPACING, TURN
    for halving, kept in enumerate((max(KEPT[0], len(poses) // KEPT_AT_FIRST), *KEPT[1:])):
        best = poses[_best_of_surroundings(poses, scores, spacing, turn)[:kept]]
        spacing, turn = 0.5 * spacing, 0.5 * turn
        poses = _around(best, spacing, turn)
        model = _wide(max(COARSE_SIGMA * 0.5 ** (halving + 1), noise.sigma_hit))
        beams = math.ceil(laser.beam_count / BEAMS[halving]) if halving < len(BEAMS) else None
        scores = laser.log_likelihood(grid, poses, ranges, noise=model, beams=beams, threads=threads)
        progress(0.6 + 0.4 * (halving + 1) / len(KEPT))
    scores = laser.log_likelihood(grid, poses, ranges, noise=noise, threads=threads)
    return _places(poses, scores)


def _ignore(share: float) -> None:
    """Ignores the share of the work that is done."""


def _wide(sigma: float) -> BeamModel:
    """Returns a beam model that forgives wrong readings."""
    return BeamModel(sigma_hit=sigma, z_hit=0.75, z_short=0.0, z_max=0.05, z_rand=0.2)


def _around(poses: NDArray[np.float64], spacing: float, turn: float) -> NDArray[np.float64]:
    """Returns poses at and around each pose: 3 by 3 positions with 3 headings."""
    steps = np.array([-1.0, 0.0, 1.0])
    offsets = np.stack(np.meshgrid(steps * spacing, steps * spacing, steps * turn), axis=-1).reshape(-1, 3)
    around: NDArray[np.float64] = (poses[:, np.newaxis] + offsets).reshape(-1, 3)
    return around


def _best_of_surroundings(
    poses: NDArray[np.float64], scores: NDArray[np.floating], spacing: float, turn: float
) -> NDArray[np.intp]:
    """Returns the indices of poses, best first: one of those within a step or so, and a few of each place."""
    order = np.argsort(-scores, kind="stable")
    best = order[_first_of_each(_boxes(poses[order], spacing, turn))]
    places = _boxes(poses[best], *APART)
    by_place = np.argsort(places, kind="stable")
    starts = np.flatnonzero(np.diff(places[by_place], prepend=-1))
    rank = np.empty(len(best), np.intp)
    rank[by_place] = np.arange(len(best)) - np.repeat(starts, np.diff(starts, append=len(best)))
    return best[rank < KEPT_OF_PLACE]


def _first_of_each(numbers: NDArray[np.int64]) -> NDArray[np.intp]:
    """Returns the indices at which a number stands for the first time."""
    return np.sort(np.unique(numbers, return_index=True)[1])


def _boxes(poses: NDArray[np.float64], length: float, turn: float) -> NDArray[np.int64]:
    """Returns the number of the box that each pose is in, (N,), of boxes with this length [m] and turn [rad]."""
    boxes = np.floor(poses / (length, length, turn)).astype(np.int64)
    boxes -= boxes.min(axis=0)
    columns, rows, turns = boxes.T
    _, height, headings = boxes.max(axis=0) + 1
    numbers: NDArray[np.int64] = (columns * height + rows) * headings + turns
    return numbers


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
