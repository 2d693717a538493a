"""Reference implementations for comparison with the fast code. They are simple enough to check by reading."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import mobile_robot_simulator as mrs

TOLERANCE = 1e-9
"""Largest error of a range before it is rounded to float32 [m]."""

CORNER = 1e-9
"""A ray that passes a corner of a square at less than this distance [cells] may hit or miss the square."""

PARALLEL = 1e-6
"""A ray is parallel to the grid lines if a component of its unit direction is smaller than this."""

Ray = tuple[float, float, float]


class Bounds(NamedTuple):
    """Smallest and largest correct range of each ray. They differ only for rays through a corner."""

    smallest: NDArray[np.float64]
    largest: NDArray[np.float64]

    @property
    def is_unique(self) -> NDArray[np.bool_]:
        """True for each ray with only one correct range."""
        return np.abs(self.largest - self.smallest) <= TOLERANCE


def blocking_squares(grid: mrs.OccupancyGrid) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Left and lower edges of the blocking squares [cells]."""
    blocks = grid.cells >= grid.occupied_threshold
    if grid.unknown == "occupied":
        blocks |= grid.cells < 0
    rows, cols = np.nonzero(blocks)
    return cols.astype(float), rows.astype(float)


def ray_in_cells(grid: mrs.OccupancyGrid, ray: Ray) -> Ray:
    """Converts a ray from the map frame to the frame of the grid, with lengths in cells."""
    dx, dy = ray[0] - grid.origin.x, ray[1] - grid.origin.y
    cos, sin = math.cos(grid.origin.yaw), math.sin(grid.origin.yaw)
    x, y = cos * dx + sin * dy, -sin * dx + cos * dy
    return x / grid.resolution, y / grid.resolution, ray[2] - grid.origin.yaw


def slab(
    low: NDArray[np.float64], side: float, start: float, step: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distances at which a ray enters and leaves each strip from `low` to `low + side` of one axis."""
    if step == 0.0:
        inside = (low <= start) & (start < low + side)
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    with np.errstate(over="ignore"):
        one, other = (low - start) / step, (low + side - start) / step
    return np.minimum(one, other), np.maximum(one, other)


def cast(grid: mrs.OccupancyGrid, rays: NDArray[np.float64] | list[Ray], max_range: float) -> Bounds:
    """Intersects each ray with every blocking square and takes the nearest.

    Squares enlarged by `CORNER` give the smallest correct range, shrunk ones the largest.
    """
    cols, rows = blocking_squares(grid)
    bounds = []
    for ray in rays:
        x, y, angle = ray_in_cells(grid, tuple(map(float, ray)))
        dx, dy = math.cos(angle), math.sin(angle)
        x_in, y_in = slab(cols, 1.0, x, dx)[0], slab(rows, 1.0, y, dy)[0]
        nearest = []
        for grown in (CORNER, -CORNER):
            x_near, x_far = slab(cols - grown, 1.0 + 2.0 * grown, x, dx)
            y_near, y_far = slab(rows - grown, 1.0 + 2.0 * grown, y, dy)
            met = (np.maximum(x_near, y_near) <= np.minimum(x_far, y_far)) & (np.minimum(x_far, y_far) >= 0.0)
            # A ray along a grid line crosses it at a place that depends on rounding. Such a ray is compared with the grown
            # square; any other ray enters at the exact square.
            enter = np.maximum(x_in if abs(dx) > PARALLEL else x_near, y_in if abs(dy) > PARALLEL else y_near)
            nearest.append(min(np.min(np.maximum(enter, 0.0)[met], initial=np.inf) * grid.resolution, max_range))
        bounds.append(nearest)
    smallest, largest = np.array(bounds).reshape(-1, 2).T
    return Bounds(smallest, largest)


def scanner_rays(laser: mrs.LaserScanner, pose: Ray | mrs.Pose) -> list[Ray]:
    """Beams of a scanner on a robot as rays in the map frame."""
    x, y, yaw = pose
    mount_x, mount_y, mount_yaw = laser.mount
    x += math.cos(yaw) * mount_x - math.sin(yaw) * mount_y
    y += math.sin(yaw) * mount_x + math.cos(yaw) * mount_y
    return [(x, y, yaw + mount_yaw + angle) for angle in laser.angles.tolist()]


def assert_ranges(found: NDArray[np.float32], bounds: Bounds) -> None:
    """Asserts that the ranges are correct to `TOLERANCE` before they are rounded to float32."""
    assert found.dtype == np.float32
    assert found.shape == bounds.smallest.shape
    too_short = found < (bounds.smallest - TOLERANCE).astype(np.float32)
    too_long = found > (bounds.largest + TOLERANCE).astype(np.float32)
    wrong = np.flatnonzero(too_short | too_long | np.isnan(found))
    detail = [(int(i), float(found[i]), bounds.smallest[i], bounds.largest[i]) for i in wrong[:5]]
    assert not wrong.size, f"{wrong.size} of {found.size} ranges are wrong: (index, found, smallest, largest) {detail}"


def message_of(error: BaseException) -> str:
    """Message of an error and its notes."""
    return "\n".join([str(error), *getattr(error, "__notes__", ())])


def normal_cdf(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distribution function of the standard normal distribution."""
    return np.array([0.5 * math.erfc(-value / math.sqrt(2.0)) for value in np.ravel(x)]).reshape(np.shape(x))


def reading_cdf(z: NDArray[np.float64], noise: mrs.BeamModel, true_range: float, max_range: float, *, hits: bool) -> NDArray:
    """Probability of a reading of at most z < max_range (Probabilistic Robotics, table 6.1, each part normalised).

    Readings are not rounded.

    If the beam hits nothing (`hits` is False), its hit part is all at max_range.
    """
    sigma, rate = max(noise.sigma_hit, noise.range_sigma_base + noise.range_sigma_per_metre * true_range), noise.lambda_short
    center = min(max(true_range + noise.range_offset, 0.0), max_range)
    total = noise.z_rand * z / max_range
    if hits:
        low, high = normal_cdf(np.array([-center / sigma, (max_range - center) / sigma]))
        total = total + noise.z_hit * (normal_cdf((z - center) / sigma) - low) / (high - low)
    if true_range == 0.0:
        return total + noise.z_short
    return total + noise.z_short * np.expm1(-rate * np.minimum(z, true_range)) / math.expm1(-rate * true_range)
