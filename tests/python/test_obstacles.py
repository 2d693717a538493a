"""obstacles: scans, batches of scans and rays see obstacles and cells together."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs

DISC = mrs.Shape.disc(0.5)


def test_scans_batches_and_rays_see_the_same_obstacles(room: mrs.OccupancyGrid) -> None:
    scanner = mrs.LaserScanner(fov=2 * math.pi, beam_count=8)
    obstacles = [(DISC, (-2.0, 0.0, 1.0)), (mrs.Shape.rectangle(1.0, 1.0), mrs.Pose(0.0, 3.0, 0.0))]
    pose = mrs.Pose(0.0, 0.0, 0.0)
    ranges = scanner.scan(room, pose, obstacles=obstacles)
    # Beam 0 points backwards, beam 6 points to the left.
    assert (ranges[0], ranges[6]) == pytest.approx((1.5, 2.5), abs=1e-6)
    alone = scanner.scan(room, pose)
    assert np.array_equal(np.delete(ranges, [0, 6]), np.delete(alone, [0, 6]))
    assert np.array_equal(scanner.scan_batch(room, np.array([[0.0, 0.0, 0.0]]), obstacles=obstacles)[0], ranges)
    rays = np.array([[0.0, 0.0, angle] for angle in scanner.angles])
    assert mrs.cast_rays(room, rays, 30.0, obstacles=obstacles) == pytest.approx(ranges, abs=1e-6)


def test_a_scanner_inside_an_obstacle_reads_zero(room: mrs.OccupancyGrid) -> None:
    ranges = mrs.LaserScanner().scan(room, (0.1, 0.1, 0.0), obstacles=[(DISC, (0.0, 0.0, 0.0))])
    assert not ranges.any()


def test_an_empty_list_of_obstacles_changes_nothing(room: mrs.OccupancyGrid) -> None:
    scanner = mrs.LaserScanner()
    assert np.array_equal(scanner.scan(room, (0, 0, 0), obstacles=()), scanner.scan(room, (0, 0, 0)))


@pytest.mark.parametrize(
    ("obstacles", "error", "message"),
    [
        (3, TypeError, r"obstacles must be a sequence of \(Shape, pose\), got int"),
        ([DISC], TypeError, r"obstacles must be a sequence of \(Shape, pose\), got Shape"),
        ([(1, (0, 0, 0))], TypeError, r"obstacles must be a sequence of \(Shape, pose\), got int"),
        ([(DISC, (0, 0))], ValueError, r"a pose must be three numbers \(x, y, yaw\)"),
        ([(DISC, (0, math.nan, 0))], ValueError, "y must be finite, got NaN"),
    ],
)
def test_invalid_obstacles_are_rejected(
    room: mrs.OccupancyGrid, obstacles: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        mrs.LaserScanner().scan(room, (0, 0, 0), obstacles=obstacles)
