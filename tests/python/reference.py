"""What the fast code is held against: too plain to be wrong."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import mobile_robot_simulator as mrs

TOLERANCE = 1e-9
"""How far [m] a range may be from the reference before it is rounded to float32."""

CORNER = 1e-9
"""Rays that pass a corner of a square this near, in cells, may meet it or not."""

PARALLEL = 1e-6
"""A component of a unit vector below which a ray runs along the grid lines."""

Ray = tuple[float, float, float]


class Bounds(NamedTuple):
    """The least and the greatest range that is right; they differ only for a ray through a corner."""

    least: NDArray[np.float64]
    greatest: NDArray[np.float64]

    @property
    def clear(self) -> NDArray[np.bool_]:
        """The rays of which only one range is right."""
        return np.abs(self.greatest - self.least) <= TOLERANCE


def blocking_squares(grid: mrs.OccupancyGrid) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Left and lower edges of the blocking squares, in cells."""
    blocks = grid.cells >= grid.occupied_threshold
    if grid.unknown == "occupied":
        blocks |= grid.cells < 0
    rows, cols = np.nonzero(blocks)
    return cols.astype(float), rows.astype(float)


def ray_in_cells(grid: mrs.OccupancyGrid, ray: Ray) -> Ray:
    """A ray of the map frame in the frame of the grid, lengths in cells."""
    dx, dy = ray[0] - grid.origin.x, ray[1] - grid.origin.y
    cos, sin = math.cos(grid.origin.yaw), math.sin(grid.origin.yaw)
    x, y = cos * dx + sin * dy, -sin * dx + cos * dy
    return x / grid.resolution, y / grid.resolution, ray[2] - grid.origin.yaw


def slab(
    low: NDArray[np.float64], side: float, start: float, step: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where a ray enters and leaves the strips from `low` to `low + side` along one axis."""
    if step == 0.0:
        inside = (low <= start) & (start < low + side)
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    with np.errstate(over="ignore"):
        one, other = (low - start) / step, (low + side - start) / step
    return np.minimum(one, other), np.maximum(one, other)


def cast(grid: mrs.OccupancyGrid, rays: NDArray[np.float64] | list[Ray], max_range: float) -> Bounds:
    """Intersects each ray with every blocking square and takes the nearest."""
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
            # Rounding decides when a ray along a grid line crosses it.
            enter = np.maximum(x_in if abs(dx) > PARALLEL else x_near, y_in if abs(dy) > PARALLEL else y_near)
            nearest.append(min(np.min(np.maximum(enter, 0.0)[met], initial=np.inf) * grid.resolution, max_range))
        bounds.append(nearest)
    least, greatest = np.array(bounds).reshape(-1, 2).T
    return Bounds(least, greatest)


def scanner_rays(laser: mrs.LaserScanner, pose: Ray | mrs.Pose) -> list[Ray]:
    """The beams of a scanner on a robot, as rays of the map frame."""
    x, y, yaw = pose
    mount_x, mount_y, mount_yaw = laser.mount
    x += math.cos(yaw) * mount_x - math.sin(yaw) * mount_y
    y += math.sin(yaw) * mount_x + math.cos(yaw) * mount_y
    return [(x, y, yaw + mount_yaw + angle) for angle in laser.angles.tolist()]


def assert_ranges(found: NDArray[np.float32], bounds: Bounds) -> None:
    """Ranges are right to 1e-9 m before they are rounded to float32."""
    assert found.dtype == np.float32
    assert found.shape == bounds.least.shape
    too_short = found < (bounds.least - TOLERANCE).astype(np.float32)
    too_long = found > (bounds.greatest + TOLERANCE).astype(np.float32)
    wrong = np.flatnonzero(too_short | too_long | np.isnan(found))
    detail = [(int(i), float(found[i]), bounds.least[i], bounds.greatest[i]) for i in wrong[:5]]
    assert not wrong.size, f"{wrong.size} of {found.size} ranges are wrong: (index, found, least, greatest) {detail}"


def said(error: BaseException) -> str:
    """All that an error says, its notes included."""
    return "\n".join([str(error), *getattr(error, "__notes__", ())])


def normal_cdf(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """The distribution function of the standard normal."""
    return np.array([0.5 * math.erfc(-value / math.sqrt(2.0)) for value in np.ravel(x)]).reshape(np.shape(x))


def reading_cdf(z: NDArray[np.float64], noise: mrs.BeamModel, true_range: float, max_range: float, *, hits: bool) -> NDArray:
    """Probability of a reading of at most z < max_range (Probabilistic Robotics, table 6.1, each part normalised).

    The hit part of a beam that hits nothing lies at max_range.
    """
    sigma, rate = noise.sigma_hit, noise.lambda_short
    total = noise.z_rand * z / max_range
    if hits:
        low, high = normal_cdf(np.array([-true_range / sigma, (max_range - true_range) / sigma]))
        total = total + noise.z_hit * (normal_cdf((z - true_range) / sigma) - low) / (high - low)
    if true_range == 0.0:
        return total + noise.z_short
    return total + noise.z_short * np.expm1(-rate * np.minimum(z, true_range)) / math.expm1(-rate * true_range)
