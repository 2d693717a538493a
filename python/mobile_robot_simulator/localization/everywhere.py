"""Poses all over a map, scored by how well a scan fits to them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, LaserScanner, OccupancyGrid
from ..quoting import quoted

SPACING = 0.25
"""Distance between the positions [m]."""

HEADINGS = 144
"""Number of headings at each position."""

TURN = 2.0 * math.pi / HEADINGS
"""Angle between two headings [rad]."""

MAX_BEAMS = 60
"""Number of beams that are scored at most."""

RANGES = 512
"""Number of ranges, evenly spaced, for which the likelihood of each reading is computed."""

SHARE = 16
"""One pose in this many is returned, the best ones."""

CHUNK = 256
"""Number of positions whose scores are computed at once, few enough for the cache of the processor."""


def best_everywhere(
    grid: OccupancyGrid,
    laser: LaserScanner,
    ranges: NDArray[np.float32],
    model: BeamModel,
    *,
    progress: Callable[[float], None],
    threads: int | None,
) -> tuple[NDArray[np.float64], NDArray[np.floating]]:
    """Returns the best sixteenth of the poses whose scanner is above a known free cell, `SPACING` and `TURN` apart.

    Args:
        grid: Map.
        laser: Scanner that took the scan.
        ranges: (beam_count,) float32, the readings [m].
        model: Beam model of the readings, which should forgive the distance to the nearest of the poses.
        progress: Called with the share of the work that is done.
        threads: Number of threads; None means one per core.

    Returns:
        Poses of the robot, (N, 3), rows (x, y, yaw) [m, m, rad], and their log-likelihoods, (N,).

    Raises:
        ValueError: The map has no free cell.
    """
    positions = _free_positions(grid)
    _, _, _, roll, pitch, _ = laser.mount_in_space
    score = _score_level if roll == pitch == 0.0 else _score_tilted
    scores = np.zeros((len(positions), HEADINGS), np.float32)
    for start in range(0, len(positions), CHUNK):
        part = slice(start, start + CHUNK)
        score(grid, laser, ranges, model, positions[part], scores[part], threads)
        progress(min(1.0, (start + CHUNK) / len(positions)))
    rank = scores.size - 1 - scores.size // SHARE
    least = np.partition(scores, rank, axis=None)[rank]
    position, heading = np.nonzero(scores >= least)
    return _poses_below(laser, positions[position], heading), scores[position, heading]


def _score_level(
    grid: OccupancyGrid,
    laser: LaserScanner,
    ranges: NDArray[np.float32],
    model: BeamModel,
    positions: NDArray[np.float64],
    scores: NDArray[np.float32],
    threads: int | None,
) -> None:
    """Adds the log-likelihood of a scan to the scores, (P, `HEADINGS`), of positions of a level scanner.

    The headings are as far apart as the rays of a fan that goes all around, so that one fan at each position gives the true
    ranges for all headings.
    """
    beams, angles = _beams_near_rays(laser)
    true_ranges = np.linspace(0.0, laser.max_range, RANGES, dtype=np.float32)
    likelihoods = model.likelihood(ranges[beams, np.newaxis], true_ranges, laser.max_range, min_range=laser.min_range)
    first_rays = (angles + HEADINGS // 2) % HEADINGS
    fan = LaserScanner(fov=2.0 * math.pi, beam_count=HEADINGS, min_range=laser.min_range, max_range=laser.max_range)
    rays = fan.scan_batch(grid, np.pad(positions, ((0, 0), (0, 1))), threads=threads)
    nearest = np.rint(rays * ((RANGES - 1) / laser.max_range)).astype(np.intp)
    nearest = np.concatenate((nearest, nearest), axis=1)
    for of_beam, first in zip(np.log(likelihoods).astype(np.float32), first_rays, strict=True):
        scores += of_beam[nearest[:, first : first + HEADINGS]]


def _score_tilted(
    grid: OccupancyGrid,
    laser: LaserScanner,
    ranges: NDArray[np.float32],
    model: BeamModel,
    positions: NDArray[np.float64],
    scores: NDArray[np.float32],
    threads: int | None,
) -> None:
    """Adds the log-likelihood of a scan to the scores, (P, `HEADINGS`), of positions of a scanner that is not level."""
    poses = _poses_below(laser, np.repeat(positions, HEADINGS, axis=0), np.tile(np.arange(HEADINGS), len(positions)))
    every = math.ceil(laser.beam_count / MAX_BEAMS)
    flat = laser.log_likelihood(grid, poses, ranges, noise=model, beams=every, threads=threads)
    scores += flat.reshape(scores.shape)


def _poses_below(laser: LaserScanner, positions: NDArray[np.float64], headings: NDArray[np.intp]) -> NDArray[np.float64]:
    """Returns the poses of the robot, (N, 3), for positions (N, 2) of its scanner and headings (N,) in units of `TURN`."""
    mount = laser.mount
    yaw = headings * TURN - mount.yaw
    sin, cos = np.sin(yaw), np.cos(yaw)
    x = positions[:, 0] - (cos * mount.x - sin * mount.y)
    y = positions[:, 1] - (sin * mount.x + cos * mount.y)
    return np.stack((x, y, yaw), axis=1)


def _free_positions(grid: OccupancyGrid) -> NDArray[np.float64]:
    """Returns the centres of free cells, about `SPACING` apart, (N, 2)."""
    every = max(1, round(SPACING / grid.resolution))
    cells = grid.cells[every // 2 :: every, every // 2 :: every]
    rows, cols = np.nonzero((cells >= 0) & (cells < grid.occupied_threshold))
    if not len(rows):
        raise ValueError(f"the map must have a free cell, got {quoted(grid)}")
    places = np.stack((cols, rows), axis=1) * every + every // 2 + 0.5
    x, y = places.T * grid.resolution
    origin = grid.origin
    sin, cos = math.sin(origin.yaw), math.cos(origin.yaw)
    return np.stack((origin.x + cos * x - sin * y, origin.y + sin * x + cos * y), axis=1)


def _beams_near_rays(laser: LaserScanner) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Returns the numbers of some beams, evenly spaced, and the angle of the ray nearest to each, in units of `TURN`."""
    turns = laser.angles / TURN
    nearest = np.rint(turns).astype(np.int64)
    order = np.lexsort((np.abs(turns - nearest), nearest))
    _, first = np.unique(nearest[order], return_index=True)
    beams = order[first][:: math.ceil(len(first) / MAX_BEAMS)]
    return beams, nearest[beams]
