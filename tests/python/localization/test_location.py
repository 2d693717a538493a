"""locate: finds where in a map a scan was taken, or says that two places look the same."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.localization import locate

NOISE = mrs.BeamModel(sigma_hit=0.03, lambda_short=1.0, z_hit=0.9, z_short=0.03, z_max=0.02, z_rand=0.05)
LASER = mrs.LaserScanner(beam_count=181, mount=(0.1, 0.0, 0.2))


def errors(found: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """Returns the distance [m] and the angle [rad] between two poses."""
    return math.hypot(*(found - true)[:2]), abs(math.remainder(found[2] - true[2], math.tau))


@pytest.mark.parametrize("seed", range(1, 5))
def test_a_robot_is_found_anywhere_in_an_office(seed: int) -> None:
    grid = mrs.floor_plan("office", seed=seed, size=(20.0, 15.0))
    poses = grid.draw_free_poses(3, radius=0.3, seed=seed)
    for pose, scan in zip(poses, LASER.scan_batch(grid, poses, noise=NOISE, seed=seed), strict=True):
        location = locate(grid, LASER, LASER.mark_invalid(scan), noise=NOISE)
        distance, angle = errors(location.poses[0], pose)
        assert (distance < 0.1 and angle < math.radians(2.0)) or location.margin < 5.0


def test_two_places_that_look_the_same_have_no_margin() -> None:
    # A closed room with a niche, twice.
    room = np.zeros((60, 50), np.int8)
    room[[0, -1], :] = room[:, [0, -1]] = 100
    room[20:30, 1:12] = 100
    grid = mrs.OccupancyGrid(np.hstack((room, room)), resolution=0.1, origin=(1.0, 2.0, 0.4))
    pose = grid.origin * mrs.Pose(3.0, 4.0, 1.0)
    scan = LASER.scan(grid, pose)
    location = locate(grid, LASER, scan, noise=NOISE)
    assert location.margin < 1.0
    other = grid.origin * mrs.Pose(8.0, 4.0, 1.0)
    for place in (pose, other):
        assert min(errors(found, np.array(tuple(place)))[0] for found in location.poses[:2]) < 0.02
    assert repr(location).startswith("Location((")


def test_progress_ends_at_one_and_threads_do_not_matter() -> None:
    grid = mrs.floor_plan("office", seed=1, size=(20.0, 15.0))
    scan = LASER.scan(grid, (10.0, 7.0, 0.0))
    shares: list[float] = []
    one = locate(grid, LASER, scan, noise=NOISE, progress=shares.append, threads=1)
    two = locate(grid, LASER, scan, noise=NOISE, threads=2)
    assert shares == sorted(shares) and shares[-1] == 1.0 and len(shares) > 5
    assert one.poses.tobytes() == two.poses.tobytes()
    assert one.log_likelihoods.tobytes() == two.log_likelihoods.tobytes()
    assert (np.diff(one.log_likelihoods) <= 0.0).all()
    # Other places are kept, so that the margin compares with one of them.
    assert len(one.poses) > 5 and 0.0 < one.margin < math.inf


def test_bad_input_is_named() -> None:
    grid = mrs.floor_plan("office", seed=1, size=(20.0, 15.0))
    with pytest.raises(ValueError, match=r"ranges must have shape \(181,\), got \(5,\)"):
        locate(grid, LASER, np.ones(5, np.float32), noise=NOISE)
    scan = np.full(181, np.inf, np.float32)
    scan[:3] = np.nan
    with pytest.raises(ValueError, match="one return, got 3 readings that are NaN and 178 of at least max_range, 30 m"):
        locate(grid, LASER, scan, noise=NOISE)
    full = mrs.OccupancyGrid(np.full((50, 50), 100, np.int8), resolution=0.1)
    with pytest.raises(ValueError, match="the map must have a free cell"):
        locate(full, LASER, np.ones(181, np.float32), noise=NOISE)


@pytest.mark.parametrize(
    "mount", [(-0.2, 0.3, 0.0, math.pi, 0.0, 1.0), (0.1, 0.0, 0.8, 0.0, 0.1, 2.0)], ids=["upside down", "tilted"]
)
def test_a_scanner_with_a_mount_in_space_is_found(mount: tuple[float, ...]) -> None:
    grid = mrs.floor_plan("office", seed=3, size=(12.0, 9.0))
    laser = mrs.LaserScanner(fov=4.0, beam_count=91, mount=mount)
    for pose in grid.draw_free_poses(2, radius=0.3, seed=3):
        scan = laser.scan_batch(grid, [pose], noise=NOISE, seed=1)[0]
        distance, angle = errors(locate(grid, laser, scan, noise=NOISE).poses[0], pose)
        assert distance < 0.1 and angle < math.radians(2.0)


@pytest.mark.parametrize(
    "field", [{"fov": 2.0 * math.pi, "beam_count": 360}, {"angle_min": 2.0, "angle_max": -2.0, "beam_count": 50}]
)
def test_beams_all_around_and_clockwise_ones_are_found(field: dict[str, float]) -> None:
    grid = mrs.floor_plan("office", seed=4, size=(12.0, 9.0))
    laser = mrs.LaserScanner(**{"fov": None, **field}, mount=(0.2, -0.1, -2.5))
    for pose in grid.draw_free_poses(2, radius=0.3, seed=3):
        scan = laser.scan_batch(grid, [pose], noise=NOISE, seed=1)[0]
        distance, angle = errors(locate(grid, laser, scan, noise=NOISE).poses[0], pose)
        assert distance < 0.1 and angle < math.radians(2.0)
