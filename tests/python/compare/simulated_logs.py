"""Logs that the simulator makes itself, with errors that are known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
from mobile_robot_simulator.logs import ScanLog

SEED = 7
LASER = mrs.LaserScanner(fov=4.0, beam_count=101, min_range=0.05, max_range=12.0)


def office() -> mrs.OccupancyGrid:
    """A generated office of 20 m x 15 m with cells of 0.05 m."""
    return mrs.floor_plan("office", seed=SEED, size=(20.0, 15.0), resolution=0.05)


def free_poses(grid: mrs.OccupancyGrid, count: int) -> NDArray[np.float64]:
    return grid.draw_free_poses(count, radius=0.4, seed=SEED)


def log_of(
    grid: mrs.OccupancyGrid,
    poses: NDArray[np.float64],
    *,
    noise: mrs.BeamModel | None = None,
    said: NDArray[np.float64] | None = None,
    laser: mrs.LaserScanner = LASER,
) -> ScanLog:
    """Returns a log of scans from `poses` on the grid, which says that they are from the poses `said`."""
    ranges = laser.scan_batch(grid, poses, noise=noise, seed=SEED if noise else None)
    count = len(poses)
    return ScanLog(
        path=Path("simulated.npz"),
        stamps=np.arange(count, dtype=np.int64) * 100_000_000,
        angles=laser.angles,
        ranges=laser.mark_invalid(ranges),
        poses=poses if said is None else said,
        frame="map",
        min_range=laser.min_range,
        max_range=laser.max_range,
        places=np.arange(count, dtype=np.int64),
        notes=(),
    )


def save(log: ScanLog, file: Path, *, without: str = "") -> Path:
    """Writes a log as an archive of NumPy arrays, without one of them if it is named."""
    names = ("poses", "ranges", "angles", "stamps", "min_range", "max_range")
    np.savez(file, **{name: getattr(log, name) for name in names if name != without})
    return file
