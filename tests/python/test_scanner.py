"""scanner: beams, single scans, batches of scans, and the marking of invalid ranges."""

from __future__ import annotations

import copy
import math
import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
import reference
from map_folders import maps

PI = math.pi
POSES_SEED = 11
NOISE_SEED = 7
NOISY = mrs.BeamModel(sigma_hit=0.05, lambda_short=0.5, z_hit=0.6, z_short=0.2, z_max=0.1, z_rand=0.1)


def poses_in(grid: mrs.OccupancyGrid, count: int, seed: int = POSES_SEED) -> NDArray[np.float64]:
    """Random poses on and around a grid whose origin has yaw 0."""
    rng = np.random.default_rng(seed)
    size = np.array(grid.shape[::-1]) * grid.resolution
    positions = np.array([grid.origin.x, grid.origin.y]) + rng.uniform(-0.1, 1.1, (count, 2)) * size
    return np.column_stack([positions, rng.uniform(-7.0, 7.0, count)])


# --- Beams ---


def test_defaults_are_roughly_a_sick_s300() -> None:
    laser = mrs.LaserScanner()
    assert (laser.fov, laser.beam_count, laser.min_range, laser.max_range) == (4.71, 541, 0.05, 30.0)
    assert laser.mount == mrs.Pose()


@pytest.mark.parametrize(
    ("fov", "beam_count", "increment"),
    [
        (4.71, 541, 4.71 / 540),
        (PI, 2, PI),
        (1.0, 3, 0.5),
        (1e-3, 1_000, 1e-3 / 999),
        (2 * PI, 360, 2 * PI / 360),
        (2 * PI, 2, PI),
        (6.2832, 4, 6.2832 / 4),
        (2 * PI - 1.9e-5, 4, (2 * PI - 1.9e-5) / 4),
        (2 * PI - 2.1e-5, 4, (2 * PI - 2.1e-5) / 3),
    ],
)
def test_beams_spread_evenly_over_the_field_of_view(fov: float, beam_count: int, increment: float) -> None:
    laser = mrs.LaserScanner(fov=fov, beam_count=beam_count)
    assert laser.angle_increment == pytest.approx(increment, rel=1e-15)
    assert laser.angle_min == -fov / 2
    assert laser.angle_max == laser.angle_min + (beam_count - 1) * laser.angle_increment
    assert laser.angles.shape == (beam_count,)
    assert laser.angles.dtype == np.float64
    assert np.array_equal(laser.angles, laser.angle_min + np.arange(beam_count) * laser.angle_increment)
    assert laser.scan(mrs.OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0), (0.0, 0.0, 0.0)).shape == (beam_count,)


def test_both_ends_of_the_field_of_view_have_a_beam() -> None:
    laser = mrs.LaserScanner(fov=3.0, beam_count=7)
    assert laser.angles[[0, -1]] == pytest.approx([-1.5, 1.5], abs=1e-15)


@pytest.mark.parametrize("beam_count", [2, 3, 360, 1081])
def test_no_beam_of_a_full_circle_is_repeated(beam_count: int) -> None:
    angles = mrs.LaserScanner(fov=2 * PI, beam_count=beam_count).angles
    assert angles[0] + 2 * PI == pytest.approx(angles[-1] + 2 * PI / beam_count, abs=1e-12)


@pytest.mark.parametrize("fov", [0.1, 4.71, 2 * PI])
def test_a_single_beam_points_ahead(post: mrs.OccupancyGrid, fov: float) -> None:
    laser = mrs.LaserScanner(fov=fov, beam_count=1)
    assert laser.angles.tolist() == [0.0]
    assert laser.scan(post, (0.5, 2.5, 0.0)).tolist() == [1.5]


@pytest.mark.parametrize(
    "layout",
    [
        {"fov": 0.5},
        {"fov": 4.71},
        {"fov": 2 * PI},
        {"angle_min": -3.1416, "angle_max": 3.1416},
        {"angle_min": 0.0, "angle_max": 6.28319},
        {"angle_min": 3.14159, "angle_max": -3.14159},
        {"angle_min": 1.0, "angle_max": -0.5},
        {"angle_min": -1.0, "angle_increment": 0.01},
        {"angle_min": -1.0, "angle_increment": -0.01},
    ],
)
@pytest.mark.parametrize("beam_count", [2, 181, 541])
def test_programs_count_the_beams_of_each_layout(layout: dict[str, float], beam_count: int) -> None:
    """slam_toolbox, AMCL and laser_geometry count this way; messages hold float32."""
    laser = mrs.LaserScanner(beam_count=beam_count, **layout)
    low, high, step = map(np.float32, (laser.angle_min, laser.angle_max, laser.angle_increment))
    assert round((laser.angle_max - laser.angle_min) / laser.angle_increment) + 1 == beam_count
    assert round(float((high - low) / step)) + 1 == beam_count


def test_beams_can_have_any_field() -> None:
    ends = mrs.LaserScanner(angle_min=-0.5, angle_max=1.0, beam_count=4)
    assert ends.angles.tolist() == [-0.5, 0.0, 0.5, 1.0]
    assert mrs.LaserScanner(angle_min=-0.5, angle_increment=0.5, beam_count=4).angles.tolist() == ends.angles.tolist()
    assert mrs.LaserScanner(angle_min=0.0, angle_max=2 * PI, beam_count=4).angles == pytest.approx([0, PI / 2, PI, 1.5 * PI])
    assert mrs.LaserScanner(angle_min=PI, angle_max=-PI, beam_count=4).angles == pytest.approx([PI, PI / 2, 0, -PI / 2])
    assert (ends.fov, mrs.LaserScanner(angle_min=1.0, angle_max=-0.5).fov) == (1.5, 1.5)


def test_a_clockwise_scan_is_the_reversed_scan_of_the_other_direction(room: mrs.OccupancyGrid) -> None:
    obstacles = [(mrs.Shape.disc(0.3), (2.0, 1.0, 0.0))]
    poses = [(1.2, 1.0, 0.3), (2.2, 2.1, -2.0)]
    for low, high in ((-1.0, 2.0), (-2.355, 2.355), (0.1, 6.0)):
        up = mrs.LaserScanner(angle_min=low, angle_max=high, beam_count=333)
        down = mrs.LaserScanner(angle_min=high, angle_max=low, beam_count=333)
        assert np.array_equal(down.angles, up.angles[::-1])
        scans = [laser.scan_batch(room, poses, obstacles=obstacles) for laser in (up, down)]
        assert np.array_equal(scans[0], scans[1][:, ::-1])


# --- Ranges ---


def test_beams_go_counter_clockwise(post: mrs.OccupancyGrid) -> None:
    laser = mrs.LaserScanner(fov=PI, beam_count=3, max_range=9.0)
    assert laser.scan(post, (2.5, 0.5, PI / 2)).tolist() == [9.0, 1.5, 9.0]
    assert laser.scan(post, (2.5, 0.5, 0.0)).tolist() == [9.0, 9.0, 1.5]
    assert laser.scan(post, (2.5, 0.5, PI)).tolist() == [1.5, 9.0, 9.0]


def test_the_mount_moves_and_turns_the_beams(post: mrs.OccupancyGrid) -> None:
    ahead = mrs.LaserScanner(fov=1.0, beam_count=1, max_range=9.0, mount=(0.5, 0.0, 0.0))
    assert ahead.scan(post, (0.5, 2.5, 0.0)).tolist() == [1.0]
    aside = mrs.LaserScanner(fov=1.0, beam_count=1, max_range=9.0, mount=(0.25, 2.0, -PI / 2))
    assert aside.scan(post, (2.5, 2.5, 0.0)).tolist() == [1.5]
    assert aside.scan(post, (2.5, 2.5, PI)).tolist() == [1.5]
    assert aside.scan(post, (4.5, 2.5, PI / 2)).tolist() == [0.0]


def test_a_scanner_can_be_mounted_upside_down_or_tilted(post: mrs.OccupancyGrid) -> None:
    level = mrs.LaserScanner(fov=2.0, beam_count=5, max_range=9.0, mount=(0.1, 0.0, 0.2))
    turned = mrs.LaserScanner(fov=2.0, beam_count=5, max_range=9.0, mount=(0.1, 0.0, 0.3, PI, 0.0, 0.2))
    assert turned.scan(post, (0.5, 2.5, 0.0)).tolist() == level.scan(post, (0.5, 2.5, 0.0)).tolist()[::-1]
    ahead = mrs.LaserScanner(beam_count=1, max_range=9.0, mount=(0.0, 0.0, 0.0, 0.0, PI / 3, 0.0))
    assert ahead.scan(post, (0.5, 2.5, 0.0)).tolist() == pytest.approx([2.0 * 1.5])
    above_the_floor = mrs.LaserScanner(beam_count=1, max_range=9.0, mount=(0.0, 0.0, 0.5, 0.0, PI / 3, 0.0))
    assert above_the_floor.scan(post, (0.5, 2.5, 0.0)).tolist() == pytest.approx([0.5 / math.sin(PI / 3)])


def test_a_mount_can_be_given_in_three_ways() -> None:
    plane, space = mrs.LaserScanner(mount=(0.1, 0.2, 0.3)), mrs.LaserScanner(mount=(0.1, 0.2, 0.0, 0.0, 0.0, 0.3))
    assert plane.mount_in_space == space.mount_in_space == (0.1, 0.2, 0.0, 0.0, 0.0, 0.3)
    assert plane.mount == space.mount == mrs.Pose(0.1, 0.2, 0.3)
    assert repr(plane) == repr(space) and repr(plane).endswith("mount=(0.1, 0.2, 0.3))")
    tilted = mrs.LaserScanner(mount=(0.1, 0.2, 0.4, 0.5, -0.6, 0.7))
    turned = mrs.LaserScanner(mount=(0.1, 0.2, 0.4, *tilted.mount_quaternion))
    assert turned.mount_in_space == pytest.approx(tilted.mount_in_space, abs=1e-15)
    copied = pickle.loads(pickle.dumps(tilted))
    assert copied.mount_in_space == tilted.mount_in_space and repr(copied) == repr(tilted)
    assert repr(tilted).endswith("mount=(0.1, 0.2, 0.4, 0.5, -0.6, 0.7))")


def test_all_ranges_in_a_wall_are_zero(post: mrs.OccupancyGrid) -> None:
    assert not mrs.LaserScanner(fov=2 * PI, beam_count=64).scan(post, (2.5, 2.5, 0.3)).any()


def test_min_range_changes_no_range(post: mrs.OccupancyGrid) -> None:
    laser = mrs.LaserScanner(fov=1.0, beam_count=1, min_range=2.0, max_range=9.0)
    assert laser.scan(post, (0.5, 2.5, 0.0)).tolist() == [1.5]


@pytest.mark.parametrize("mount", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.5)])
@pytest.mark.parametrize("origin", [(-10.0, -8.0, 0.0), (2.0, 3.0, 0.9), (0.0, 0.0, -3.0)])
def test_scans_agree_with_the_reference(
    room: mrs.OccupancyGrid, origin: tuple[float, float, float], mount: tuple[float, float, float]
) -> None:
    grid = mrs.OccupancyGrid(room.cells, resolution=0.1, origin=origin)
    laser = mrs.LaserScanner(beam_count=91, max_range=12.0, mount=mount)
    for pose in poses_in(grid, 10).tolist():
        bounds = reference.cast(grid, reference.scanner_rays(laser, tuple(pose)), 12.0)
        reference.assert_ranges(laser.scan(grid, tuple(pose)), bounds)


MAPS = maps(
    carried=["office", "office_turned", "cave_turned"],
    real=["nav2_tb3_sandbox/map.yaml", "radish_intel/map_logframe.yaml", "mit_basement_fixed/map.yaml"],
)


@pytest.mark.parametrize("path", MAPS)
def test_scans_of_whole_maps_agree_with_the_reference(path: Path) -> None:
    grid = mrs.load_map(path)
    laser = mrs.LaserScanner(fov=2 * PI, beam_count=24, max_range=30.0)
    poses = [grid.draw_free_pose(radius=0.1, seed=seed) for seed in range(3)]
    ranges = laser.scan_batch(grid, np.array([tuple(pose) for pose in poses]))
    assert (ranges < 30.0).mean() > 0.5
    for pose, row in zip(poses, ranges, strict=True):
        reference.assert_ranges(row, reference.cast(grid, reference.scanner_rays(laser, pose), 30.0))


def test_a_turned_world_gives_the_same_scan(room: mrs.OccupancyGrid) -> None:
    laser = mrs.LaserScanner(beam_count=541)
    turned = mrs.OccupancyGrid(room.cells, resolution=0.1, origin=mrs.Pose(3.0, 4.0, 1.0) * room.origin)
    for pose in poses_in(room, 20).tolist():
        there = mrs.Pose(3.0, 4.0, 1.0) * mrs.Pose(*pose)
        same = np.isclose(laser.scan(turned, there), laser.scan(room, tuple(pose)), rtol=1e-6, atol=1e-6)
        assert same.mean() > 0.99


def test_a_scan_equals_the_cast_rays(room: mrs.OccupancyGrid) -> None:
    laser = mrs.LaserScanner(beam_count=181, mount=(0.2, 0.1, 0.3))
    pose = (1.0, -2.0, 0.4)
    rays = np.array(reference.scanner_rays(laser, pose))
    assert np.allclose(laser.scan(room, pose), mrs.cast_rays(room, rays, laser.max_range), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    "pose", [(1e300, 0.0, 0.0), (0.0, -1.7e308, 3.0), (0.0, 0.0, 1.7e308), (1.7e308, 1.7e308, -1.7e308)]
)
def test_scans_from_huge_poses_are_valid(room: mrs.OccupancyGrid, pose: tuple[float, float, float]) -> None:
    for mount in ((0.0, 0.0, 0.0), (1e308, -1e308, 1.7e308)):
        laser = mrs.LaserScanner(beam_count=31, mount=mount)
        for noise in (None, NOISY):
            ranges = laser.scan_batch(room, np.array([pose]), noise=noise, seed=NOISE_SEED)
            assert ((ranges >= 0.0) & (ranges <= 30.0)).all()


# --- Batches ---


@pytest.mark.parametrize("mount", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.5)])
def test_a_batch_equals_a_loop(room: mrs.OccupancyGrid, mount: tuple[float, float, float]) -> None:
    laser = mrs.LaserScanner(beam_count=101, mount=mount)
    poses = poses_in(room, 64)
    batch = laser.scan_batch(room, poses)
    assert (batch.shape, batch.dtype, batch.flags.c_contiguous) == ((64, 101), np.float32, True)
    assert np.array_equal(batch, [laser.scan(room, tuple(pose)) for pose in poses.tolist()])


def test_no_poses_give_no_scans(room: mrs.OccupancyGrid) -> None:
    ranges = mrs.LaserScanner(beam_count=7).scan_batch(room, np.zeros((0, 3)), noise=NOISY, seed=NOISE_SEED)
    assert (ranges.shape, ranges.dtype) == ((0, 7), np.float32)


@pytest.mark.parametrize("noise", [None, NOISY], ids=["exact", "noisy"])
@pytest.mark.parametrize("threads", [1, 2, 8, None])
@pytest.mark.parametrize("chunks", [1, 3, 50])
def test_threads_and_chunks_change_no_byte(
    room: mrs.OccupancyGrid, noise: mrs.BeamModel | None, threads: int | None, chunks: int
) -> None:
    laser, poses = mrs.LaserScanner(beam_count=181), poses_in(room, 200)
    whole = laser.scan_batch(room, poses, noise=noise, seed=NOISE_SEED, first_index=5, threads=1)
    parts, index = [], 5
    for part in np.array_split(poses, chunks):
        parts.append(laser.scan_batch(room, part, noise=noise, seed=NOISE_SEED, first_index=index, threads=threads))
        index += len(part)
    assert np.concatenate(parts).tobytes() == whole.tobytes()


def test_only_seed_and_index_determine_the_noise(room: mrs.OccupancyGrid) -> None:
    laser, poses = mrs.LaserScanner(beam_count=31), poses_in(room, 8)
    batch = laser.scan_batch(room, poses, noise=NOISY, seed=NOISE_SEED)
    others = poses.copy()
    others[:5] = 0.0
    assert np.array_equal(laser.scan_batch(room, others, noise=NOISY, seed=NOISE_SEED)[5:], batch[5:])
    assert np.array_equal(laser.scan_batch(room, poses[3:4], noise=NOISY, seed=NOISE_SEED, first_index=3)[0], batch[3])


@pytest.mark.parametrize(
    "change", [{"seed": NOISE_SEED + 1}, {"first_index": 1}, {"seed": 2**64 - 1}, {"first_index": 2**64 - 1}]
)
def test_another_seed_or_index_gives_other_noise(room: mrs.OccupancyGrid, change: dict[str, int]) -> None:
    laser, pose = mrs.LaserScanner(beam_count=200), np.zeros((1, 3))
    one = laser.scan_batch(room, pose, noise=NOISY, **{"seed": NOISE_SEED, "first_index": 0})
    other = laser.scan_batch(room, pose, noise=NOISY, **{"seed": NOISE_SEED, "first_index": 0, **change})
    assert (one != other).mean() > 0.7


def test_seed_and_index_default_to_zero(room: mrs.OccupancyGrid) -> None:
    laser, pose = mrs.LaserScanner(beam_count=50), np.zeros((1, 3))
    plain = laser.scan_batch(room, pose, noise=NOISY, seed=0)
    assert np.array_equal(plain, laser.scan_batch(room, pose, noise=NOISY, seed=0, first_index=0))
    assert np.array_equal(plain, laser.scan_batch(room, pose, noise=NOISY, seed=np.uint64(0), first_index=None))


def test_other_python_threads_run_during_a_batch(room: mrs.OccupancyGrid) -> None:
    """While a batch runs, another thread is never blocked for half of the duration of the batch."""
    laser, poses = mrs.LaserScanner(beam_count=541), poses_in(room, 8_000)
    span: list[float] = []

    def scan() -> None:
        span.append(time.perf_counter())
        laser.scan_batch(room, poses, noise=NOISY, seed=NOISE_SEED, threads=1)
        span.append(time.perf_counter())

    worker = threading.Thread(target=scan)
    steps = []
    worker.start()
    while worker.is_alive():
        steps.append(time.perf_counter())
    worker.join()
    begin, end = span
    assert sum(begin < step < end for step in steps) > 100
    assert max(np.diff([begin, *(step for step in steps if begin < step < end), end])) < 0.5 * (end - begin)


def test_threads_can_share_a_grid_from_its_first_scan() -> None:
    cells = (np.random.default_rng(POSES_SEED).random((300, 300)) < 0.02).astype(np.int8) * 100
    laser, barrier = mrs.LaserScanner(beam_count=91), threading.Barrier(4)

    def scan(grid: mrs.OccupancyGrid, found: dict[int, NDArray[np.float32]], worker: int) -> None:
        barrier.wait()
        found[worker] = laser.scan_batch(grid, poses_in(grid, 50), threads=2)

    for _ in range(5):
        grid = mrs.OccupancyGrid(cells, resolution=0.1)
        found: dict[int, NDArray[np.float32]] = {}
        workers = [threading.Thread(target=scan, args=(grid, found, worker)) for worker in range(4)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        assert all(np.array_equal(ranges, found[0]) for ranges in found.values())


FORK = """
import multiprocessing, os, sys
import numpy as np
import mobile_robot_simulator as mrs

cells = np.zeros((100, 100), np.int8)
cells[[0, -1], :] = cells[:, [0, -1]] = 100
grid = mrs.OccupancyGrid(cells, resolution=0.1)
laser = mrs.LaserScanner()
poses = np.random.default_rng(1).uniform(1.0, 9.0, (500, 3))

def scan(threads):
    return laser.scan_batch(grid, poses, noise=mrs.BeamModel(), seed=1, threads=threads).tobytes()

expected = scan(2)
assert scan(None) == expected
if sys.argv[1] == "fork":
    child = os.fork()
    if child == 0:
        os._exit(0 if all(scan(threads) == expected for threads in (2, None, 3, 1)) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
else:
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map(scan, [2, None, 3, 1]) == [expected] * 4
assert scan(2) == expected
print("done")
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
@pytest.mark.parametrize("way", ["fork", "pool"])
def test_a_forked_process_can_scan(way: str) -> None:
    """A forked process does not inherit the worker threads of its parent."""
    done = subprocess.run([sys.executable, "-c", FORK, way], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (0, "done\n"), done.stderr


# --- Out ---


def test_out_is_written_in_place_and_returned(room: mrs.OccupancyGrid) -> None:
    laser, poses = mrs.LaserScanner(beam_count=31), poses_in(room, 12)
    whole = np.full((14, 31), -7.0, np.float32)
    out = whole[1:13]
    assert laser.scan_batch(room, poses, out=out) is out
    assert np.array_equal(out, laser.scan_batch(room, poses))
    assert (whole[[0, -1]] == -7.0).all()


def test_out_can_be_used_again(room: mrs.OccupancyGrid) -> None:
    laser, poses = mrs.LaserScanner(beam_count=31), poses_in(room, 12)
    out = np.empty((12, 31), np.float32)
    first = laser.scan_batch(room, poses, noise=NOISY, seed=NOISE_SEED, out=out).copy()
    assert np.array_equal(laser.scan_batch(room, poses, noise=NOISY, seed=NOISE_SEED, out=out), first)


@pytest.mark.parametrize("bases", [1, 2])
def test_out_may_overlap_the_poses(room: mrs.OccupancyGrid, bases: int) -> None:
    laser, poses = mrs.LaserScanner(beam_count=6), poses_in(room, 40)
    expected = laser.scan_batch(room, poses)
    buffer = bytearray(poses.tobytes())
    shared = np.frombuffer(buffer).reshape(40, 3)
    out = shared.view(np.float32) if bases == 1 else np.frombuffer(buffer, np.float32).reshape(40, 6)
    assert np.array_equal(laser.scan_batch(room, shared, out=out, threads=1), expected)


@pytest.mark.parametrize(
    "convert",
    [
        lambda poses: [tuple(map(float, pose)) for pose in poses],
        lambda poses: [mrs.Pose(*map(float, pose)) for pose in poses],
        lambda poses: poses.astype(np.float32),
        lambda poses: poses.astype(">f8"),
        lambda poses: poses.astype(np.int16),
        lambda poses: Wrapped(poses),
        lambda poses: Exported(poses),
        lambda poses: poses.view(Lying),
    ],
    ids=["tuples", "poses", "float32", "big-endian", "int16", "__array__", "DLPack", "subclass"],
)
def test_poses_can_be_anything_that_numpy_converts_without_loss(room: mrs.OccupancyGrid, convert: Any) -> None:
    # Whole numbers, which every type here holds exactly.
    laser, poses = mrs.LaserScanner(beam_count=6), np.array([[2.0, 1.0, 0.0], [3.0, 2.0, 1.0]])
    assert np.array_equal(laser.scan_batch(room, convert(poses)), laser.scan_batch(room, poses))


class Wrapped:
    """Offers an array by `__array__`."""

    def __init__(self, array: Any) -> None:
        self.array = array

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.array


class Exported:
    """Offers an array by DLPack only."""

    def __init__(self, array: Any) -> None:
        self.array = array

    def __dlpack__(self, **options: Any) -> Any:
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self) -> Any:
        return self.array.__dlpack_device__()


class Lying(np.ndarray[Any, Any]):
    """An array with wrong attributes."""

    shape = (7, 7, 7)  # type: ignore[assignment]
    flags = None  # type: ignore[assignment]
    ndim = -3  # type: ignore[assignment,misc]

    def astype(self, *_: Any, **__: Any) -> Any:
        return "no array"

    copy = astype  # type: ignore[assignment]


@pytest.mark.parametrize("threads", [1, 2, None])
def test_all_rays_are_checked_before_any_is_cast(room: mrs.OccupancyGrid, threads: int | None) -> None:
    rays = np.tile(poses_in(room, 100), (100, 1))
    rays[-1, 1] = np.inf
    out = np.full(10_000, -7.0, np.float32)
    with pytest.raises(ValueError, match=r"rays must be finite, got \[.*inf.*\] in row 9999"):
        mrs.cast_rays(room, rays, 9.0, threads=threads, out=out)
    assert (out == -7.0).all()


def test_rays_are_not_copied(room: mrs.OccupancyGrid) -> None:
    resource = pytest.importorskip("resource")
    rays = np.tile(poses_in(room, 1000), (1000, 1))
    out = mrs.cast_rays(room, rays, 9.0)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    mrs.cast_rays(room, rays, 9.0, out=out)
    # A copy would cause 5859 page faults, one for each page of 4 KiB.
    assert resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before < 1000


def locked(array: NDArray[Any]) -> NDArray[Any]:
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    ("out", "error", "message"),
    [
        (np.zeros((2, 5), np.float32), ValueError, "out must have shape (2, 4), got (2, 5)"),
        (np.zeros((4, 2), np.float32), ValueError, "out must have shape (2, 4), got (4, 2)"),
        (np.zeros(8, np.float32), ValueError, "out must have shape (2, 4), got (8,)"),
        (np.zeros((1, 2, 4), np.float32), ValueError, "out must have shape (2, 4), got (1, 2, 4)"),
        (np.zeros((2, 4)), TypeError, "out must have dtype float32, got float64"),
        (np.zeros((2, 4), ">f4"), TypeError, "out must have dtype float32, got >f4"),
        (np.zeros((2, 4), np.int32), TypeError, "out must have dtype float32, got int32"),
        (np.zeros((4, 2), np.float32).T, ValueError, "out must be in C order"),
        (np.zeros((2, 8), np.float32)[:, ::2], ValueError, "out must be in C order"),
        (np.zeros((2, 4), np.float32)[::-1], ValueError, "out must be in C order"),
        (locked(np.zeros((2, 4), np.float32)), ValueError, "out must be writeable"),
        (np.broadcast_to(np.zeros(4, np.float32), (2, 4)), ValueError, "out must be"),
        (np.frombuffer(bytearray(33), np.float32, offset=1).reshape(2, 4), ValueError, "out must be aligned"),
        ([[0.0] * 4] * 2, TypeError, "out must be a NumPy array of float32, got list"),
        (bytearray(32), TypeError, "out must be a NumPy array of float32, got bytearray"),
    ],
)
def test_invalid_outs_are_rejected(post: mrs.OccupancyGrid, out: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        mrs.LaserScanner(beam_count=4).scan_batch(post, np.zeros((2, 3)), out=out)
    assert message in reference.message_of(caught.value)


def test_invalid_poses_leave_out_unchanged(post: mrs.OccupancyGrid) -> None:
    out = np.full((2, 4), -7.0, np.float32)
    with pytest.raises(ValueError, match="finite"):
        mrs.LaserScanner(beam_count=4).scan_batch(post, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, math.nan]]), out=out)
    assert (out == -7.0).all()


# --- Invalid ranges and end points ---


@pytest.mark.parametrize(("no_return", "missing"), [("inf", math.inf), ("max", 30.0), ("below_max", np.float32(29.9))])
def test_invalid_ranges_are_marked_as_in_rep_117(no_return: str, missing: float) -> None:
    laser = mrs.LaserScanner(min_range=0.5)
    readings = np.array([0.0, 0.25, np.nextafter(np.float32(0.5), np.float32(0)), 0.5, 1.0, 29.5, 30.0], np.float32)
    marked = laser.mark_invalid(readings, no_return=no_return)
    assert marked.dtype == np.float32
    assert marked.tolist() == [-math.inf, -math.inf, -math.inf, 0.5, 1.0, 29.5, missing]
    assert readings[0] == 0.0


def test_below_max_is_at_least_the_smallest_valid_range() -> None:
    laser = mrs.LaserScanner(min_range=0.5, max_range=0.55)
    assert laser.mark_invalid(np.array([0.55], np.float32), no_return="below_max").tolist() == [0.5]


def test_a_missing_return_is_infinite_by_default() -> None:
    laser = mrs.LaserScanner(max_range=0.3, min_range=0.1)
    readings = np.array([[0.1, 0.3], [0.3, 0.2]], np.float32)
    assert np.array_equal(laser.mark_invalid(readings), np.array([[0.1, np.inf], [np.inf, 0.2]], np.float32))


def test_marked_scans_have_a_range_or_an_infinity(room: mrs.OccupancyGrid) -> None:
    laser = mrs.LaserScanner(min_range=1.0, max_range=7.0)
    ranges = laser.scan_batch(room, poses_in(room, 50), noise=NOISY, seed=NOISE_SEED)
    marked = laser.mark_invalid(ranges)
    assert np.array_equal(np.isposinf(marked), ranges == 7.0)
    assert np.array_equal(np.isneginf(marked), ranges < 1.0)
    assert np.isposinf(marked).any() and np.isneginf(marked).any() and np.isfinite(marked).any()


def test_every_memory_layout_is_marked_correctly() -> None:
    laser = mrs.LaserScanner(min_range=0.5)
    readings = np.random.default_rng(1).uniform(0.0, 30.0, (4, 6)).astype(np.float32)
    records = np.zeros(4, [("label", "i1"), ("ranges", "f4", (6,))])
    records["ranges"] = readings
    for view in (readings, np.asfortranarray(readings), readings[::-1][::-1], records["ranges"]):
        assert np.array_equal(laser.mark_invalid(view), laser.mark_invalid(readings))


def test_quantized_readings_are_the_nearest_multiples_of_a_power_of_two() -> None:
    laser = mrs.LaserScanner(max_range=30.0003)
    top = np.float32(30.0003)
    below = np.nextafter(top, np.float32(0))
    readings = np.random.default_rng(1).uniform(0.0, 30.0, 100_000).astype(np.float32)
    readings = np.concatenate([readings, np.array([0.0, 30.0, below, top, 40.0, np.inf, -np.inf, np.nan], np.float32)])
    found = laser.quantize(readings, 0.001)
    expected = [float(x) if not abs(x) < top else min(round(float(x) * 1024), 30 * 1024) / 1024 for x in readings]
    assert found.dtype == np.float32 and np.array_equal(found, expected, equal_nan=True)
    assert np.abs(found[:100_001] - readings[:100_001].astype(np.float64)).max() <= 0.5 / 1024
    assert np.array_equal(laser.quantize(found, 0.001), found, equal_nan=True)
    other = np.empty_like(readings)
    assert laser.quantize(readings, 0.001, out=other) is other and np.array_equal(other, found, equal_nan=True)
    assert laser.quantize(readings, 0.001, out=readings) is readings and np.array_equal(readings, found, equal_nan=True)


def test_out_of_quantize_is_another_array_or_the_readings_themselves() -> None:
    laser, readings = mrs.LaserScanner(), np.full((4, 3), 0.3, np.float32)
    with pytest.raises(ValueError, match="out must be writeable, got a read-only array or one that is already in use"):
        laser.quantize(readings[:2], 0.5, out=readings[1:3])
    with pytest.raises(ValueError, match=r"out must have shape \(4, 3\), got \(3, 4\)"):
        laser.quantize(readings, 0.5, out=np.empty((3, 4), np.float32))
    with pytest.raises(ValueError, match="out must be in C order"):
        laser.quantize(readings.T, 0.5, out=readings.T)
    with pytest.raises(TypeError, match="out must have dtype float32, got float64"):
        laser.quantize(readings, 0.5, out=np.empty((4, 3)))
    with pytest.raises(TypeError, match="out must be a NumPy array of float32, got list"):
        laser.quantize(readings, 0.5, out=[0.3])  # type: ignore[arg-type]
    assert (readings == np.float32(0.3)).all()


@pytest.mark.parametrize("step", [0.0, -1.0, 1e-7, 1.5, math.nan, math.inf])
def test_a_step_that_is_out_of_range(step: float) -> None:
    with pytest.raises(ValueError, match=r"step must be in 1e-6..1 m, got"):
        mrs.LaserScanner().quantize(np.zeros(3, np.float32), step)


def test_end_points_are_at_the_ends_of_the_beams(post: mrs.OccupancyGrid) -> None:
    laser = mrs.LaserScanner(fov=PI, beam_count=3, max_range=9.0, mount=(0.5, 0.0, 0.0))
    ranges = laser.scan(post, (2.5, 0.0, PI / 2))
    assert laser.end_points((2.5, 0.0, PI / 2), ranges) == pytest.approx(np.array([[2.5, 2.0]]))
    assert laser.end_points((2.5, 0.0, PI / 2), laser.mark_invalid(ranges)) == pytest.approx(np.array([[2.5, 2.0]]))
    for no_return in ("inf", "max"):
        nothing = laser.mark_invalid(np.array([9.0, 0.01, 9.0], np.float32), no_return=no_return)
        assert laser.end_points((0.0, 0.0, 0.0), nothing).shape == (0, 2)


# --- Invalid arguments ---


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"fov": 0.0}, ValueError, "fov must be in (0, 2π] radians, got 0"),
        ({"fov": -1.0}, ValueError, "fov must be in (0, 2π] radians, got -1"),
        ({"fov": 6.3}, ValueError, "fov must be in (0, 2π] radians, got 6.3"),
        ({"fov": 2 * PI + 3e-5}, ValueError, "fov must be in (0, 2π] radians"),
        ({"fov": math.nan}, ValueError, "fov must be in (0, 2π] radians, got NaN"),
        ({"fov": math.inf}, ValueError, "fov must be in (0, 2π] radians, got inf"),
        ({"fov": "4.71"}, TypeError, "fov"),
        ({"angle_min": -135, "angle_max": 135}, ValueError, "angle_min must be in [-2π, 2π] radians, got -135; -135° is"),
        (
            {"angle_min": 1.0, "angle_max": 1.0},
            ValueError,
            "angle_max must differ from angle_min by at most 2π, got 1 and 1",
        ),
        (
            {"angle_min": -4.0, "angle_max": 4.0},
            ValueError,
            "angle_max must differ from angle_min by at most 2π, got 4 and -4",
        ),
        ({"angle_min": 0.0, "angle_increment": 0.02}, ValueError, "turn all beams by at most 2π, got 0.02 for 541 beams"),
        ({"angle_min": 0.0, "angle_increment": 0.0}, ValueError, "angle_increment must be other than 0"),
        ({"angle_min": 0.0}, ValueError, "angle_min with angle_max or angle_increment, got angle_min"),
        ({"angle_max": 1.0, "fov": 1.0}, ValueError, "angle_max or angle_increment, got fov and angle_max"),
        ({"angle_min": 0.0, "angle_max": "1"}, TypeError, "angle_max"),
        ({"beam_count": 0}, ValueError, "beam_count must be in 1..1000000, got 0"),
        ({"beam_count": -5}, ValueError, "beam_count must be in 1..1000000, got -5"),
        ({"beam_count": 1_000_001}, ValueError, "beam_count must be in 1..1000000, got 1000001"),
        ({"beam_count": 2**64 + 1}, ValueError, f"beam_count must be in 1..1000000, got {2**64 + 1}"),
        ({"beam_count": 541.0}, TypeError, "beam_count must be an integer, got float"),
        ({"beam_count": "541"}, TypeError, "beam_count must be an integer, got str"),
        ({"min_range": -0.1}, ValueError, "min_range must be at least 0, got -0.1"),
        ({"min_range": math.nan}, ValueError, "min_range"),
        ({"min_range": 30.0}, ValueError, "max_range must be greater than min_range"),
        ({"min_range": 31.0}, ValueError, "max_range must be greater than min_range, got 30 and 31"),
        ({"fov": 270}, ValueError, "fov must be in (0, 2π] radians, got 270; 270° is 4.7124 rad"),
        ({"fov": 270 * 2}, ValueError, "fov must be in (0, 2π] radians, got 540"),
        ({"max_range": 0.0}, ValueError, "max_range"),
        ({"max_range": -1.0}, ValueError, "max_range"),
        ({"max_range": math.nan}, ValueError, "max_range"),
        ({"max_range": math.inf}, ValueError, "max_range"),
        ({"max_range": 1e39}, ValueError, "max_range"),
        ({"mount": (0.0, 0.0)}, ValueError, "three numbers"),
        ({"mount": (0.0, math.nan, 0.0)}, ValueError, "mount"),
        ({"mount": "front"}, TypeError, "seven (x, y, z, qx, qy, qz, qw), got str: 'front'"),
        ({"mount": (0.0, 0.0, 0.3, 0.0, math.inf, 0.0)}, ValueError, "mount pitch must be finite, got inf"),
        ({"mount": (0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0)}, ValueError, "quaternion must be positive and finite, got 0"),
        ({"mount": (0.0, 0.0, 0.0, 0.0)}, ValueError, "a mount must be three numbers (x, y, yaw), six (x, y, z, roll"),
        ({"mount": None}, TypeError, "mount"),
        ({"beams": 5}, TypeError, "beams"),
    ],
)
def test_invalid_scanners_are_rejected(options: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        mrs.LaserScanner(**options)
    assert message in reference.message_of(caught.value)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"poses": np.zeros((2, 4))}, ValueError, "poses must have shape (N, 3), got (2, 4)"),
        ({"poses": np.zeros((3, 7))}, ValueError, "poses must have shape (N, 3), got (3, 7)"),
        ({"poses": np.zeros(3)}, ValueError, "poses must have shape (N, 3), got (3,)"),
        ({"poses": np.zeros((2, 3), complex)}, TypeError, "poses must have dtype float64, got complex128"),
        ({"poses": np.zeros((2, 3), bool)}, TypeError, "poses must have dtype float64, got bool"),
        ({"poses": np.zeros((2, 3), np.longdouble)}, TypeError, "convert it with .astype(np.float64)"),
        ({"poses": [("a", 0.0, 0.0)]}, TypeError, "poses must have dtype float64, got <U"),
        ({"poses": [(0.0, 0.0), (0.0, 0.0, 0.0)]}, ValueError, "poses must have rows of equal length, got list"),
        ({"poses": [(0.0, None, 0.0)]}, TypeError, "poses must be an array of numbers, got list"),
        ({"poses": np.zeros((1,) * 33)}, TypeError, "poses must have at most 32 dimensions, got 33"),
        ({"poses": np.array([[0.0, math.nan, 0.0]])}, ValueError, "poses must be finite, got [0.0, NaN, 0.0] in row 0"),
        ({"poses": np.array([[0.0] * 3, [0.0, 0.0, -math.inf]])}, ValueError, "in row 1"),
        ({"noise": 0.1}, TypeError, "noise"),
        ({"noise": {"sigma_hit": 0.1}}, TypeError, "noise"),
        ({"seed": -1}, ValueError, "seed must be in 0..2**64 - 1, got -1"),
        ({"seed": 2**64}, ValueError, f"seed must be in 0..2**64 - 1, got {2**64}"),
        ({"seed": 1.0}, TypeError, "seed must be an integer or a RandomStream, got float"),
        ({"first_index": -1}, ValueError, "first_index must be in 0..2**64 - 1, got -1"),
        ({"first_index": "0"}, TypeError, "first_index must be an integer, got str"),
        ({"threads": 0}, ValueError, "threads must be in 1..1024, got 0"),
        ({"threads": 10**6}, ValueError, "threads must be in 1..1024, got 1000000"),
        ({"threads": "all"}, TypeError, "threads must be an integer, got str"),
        ({"grid": np.zeros((3, 3), np.int8)}, TypeError, "grid"),
    ],
)
def test_invalid_batches_are_rejected(
    post: mrs.OccupancyGrid, arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    given = {"grid": post, "poses": np.zeros((1, 3)), **arguments}
    with pytest.raises(error) as caught:
        mrs.LaserScanner(beam_count=4).scan_batch(given.pop("grid"), given.pop("poses"), **given)
    assert message in reference.message_of(caught.value)


@pytest.mark.parametrize(
    ("pose", "error", "message"),
    [
        ((0.0, 0.0, math.nan), ValueError, "yaw must be finite, got NaN"),
        ((math.inf, 0.0, 0.0), ValueError, "x must be finite, got inf"),
        ((0.0, 0.0), ValueError, "three numbers (x, y, yaw), got tuple: (0.0, 0.0)"),
        (np.zeros((1, 3)), TypeError, "three numbers"),
        ("xyz", TypeError, "three numbers"),
        (None, TypeError, "three numbers"),
    ],
)
def test_invalid_poses_are_rejected(post: mrs.OccupancyGrid, pose: Any, error: type[Exception], message: str) -> None:
    for call in (
        lambda: mrs.LaserScanner().scan(post, pose),
        lambda: mrs.LaserScanner().end_points(pose, np.zeros(541, np.float32)),
    ):
        with pytest.raises(error) as caught:
            call()
        assert message in reference.message_of(caught.value)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda laser: laser.mark_invalid(np.zeros(541)), TypeError, "readings must have dtype float32, got float64"),
        (lambda laser: laser.mark_invalid([0.0]), TypeError, "readings must have dtype float32, got float64"),
        (
            lambda laser: laser.mark_invalid(np.zeros(5, np.float32), no_return="nan"),
            ValueError,
            "'inf', 'max' or 'below_max', got 'nan'",
        ),
        (
            lambda laser: laser.end_points((0, 0, 0), np.zeros(5, np.float32)),
            ValueError,
            "readings must have 541 elements, got 5",
        ),
        (
            lambda laser: laser.end_points((0, 0, 0), np.zeros(541)),
            TypeError,
            "readings must have dtype float32, got float64",
        ),
    ],
)
def test_invalid_readings_are_rejected(
    call: Callable[[mrs.LaserScanner], Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error) as caught:
        call(mrs.LaserScanner())
    assert message in reference.message_of(caught.value)


@pytest.mark.parametrize(
    "layout",
    ["angle_min=-0.5, angle_max=1.0", "angle_min=1.0, angle_max=-0.5", "angle_min=0.0, angle_increment=-0.1", "fov=2.0"],
)
def test_copies_have_the_same_beams(layout: str) -> None:
    laser = eval(f"LaserScanner({layout}, beam_count=7)", vars(mrs))
    copied = pickle.loads(pickle.dumps(laser))
    assert np.array_equal(copied.angles, laser.angles) and repr(copied) == repr(laser)
    assert f"({layout}, " in repr(laser)


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda laser: pickle.loads(pickle.dumps(laser))])
def test_copies_equal_the_scanner(room: mrs.OccupancyGrid, duplicate: Any) -> None:
    laser = mrs.LaserScanner(fov=1.1, beam_count=17, min_range=0.2, max_range=7.3, mount=(0.1, 0.2, 0.3))
    other = duplicate(laser)
    for name in ("fov", "beam_count", "min_range", "max_range", "mount", "angle_min", "angle_increment"):
        assert getattr(other, name) == getattr(laser, name)
    assert np.array_equal(other.scan(room, (0.0, 1.0, 2.0)), laser.scan(room, (0.0, 1.0, 2.0)))
    assert (
        repr(other)
        == repr(laser)
        == "LaserScanner(fov=1.1, beam_count=17, min_range=0.2, max_range=7.3, mount=(0.1, 0.2, 0.3))"
    )


anything = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**65), 2**65),
    st.floats(),
    st.text(max_size=3),
    st.lists(st.one_of(st.floats(), st.integers(-9, 9)), max_size=4),
    st.sampled_from(
        [np.zeros((2, 3)), np.zeros((0, 3)), np.zeros((2, 4), np.float32), np.full((1, 3), 1e308), np.array(None)]
    ),
)


@given(
    options=st.dictionaries(st.sampled_from(["fov", "beam_count", "min_range", "max_range", "mount"]), anything, min_size=1),
    batch=st.dictionaries(st.sampled_from(["noise", "seed", "first_index", "threads", "out"]), anything),
    poses=anything,
)
def test_no_argument_causes_a_panic(options: dict[str, Any], batch: dict[str, Any], poses: Any) -> None:
    grid = mrs.OccupancyGrid(np.eye(4, dtype=np.int8) * 100, resolution=0.5)
    try:
        laser = mrs.LaserScanner(**{"beam_count": 4, **options})
    except (ValueError, TypeError):
        laser = mrs.LaserScanner(beam_count=4)
    if laser.beam_count > 1000:
        return
    for call in (lambda: laser.scan_batch(grid, poses, **batch), lambda: laser.scan(grid, poses)):
        try:
            ranges = call()
        except (ValueError, TypeError):
            continue
        assert ((ranges >= 0.0) & (ranges <= np.float32(laser.max_range))).all()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: mrs.LaserScanner(max_range=-1e300), "got -1e300"),
        (lambda: mrs.Shape.disc(-1e-300), "got -1e-300"),
        (lambda: mrs.LaserScanner(beam_count=10**4000), "beam_count must be in 1..1000000, got 1000000"),
        (lambda: mrs.LaserScanner(mount=tuple(range(100_000))), "got tuple: (0, 1, 2, 3, 4, 5, ...)"),
        (lambda: mrs.RandomStream(-(10**4000)), "seed must be in 0..2**64 - 1, got -1000000"),
    ],
)
def test_messages_cut_what_they_quote(make: Any, message: str) -> None:
    with pytest.raises((ValueError, TypeError)) as caught:
        make()
    assert message in str(caught.value) and len(str(caught.value)) < 200


def test_wrong_arguments_are_named_with_what_to_do() -> None:
    laser, cells = mrs.LaserScanner(beam_count=3), np.zeros((3, 3), np.int8)
    grid = mrs.OccupancyGrid(cells, resolution=1.0)
    with pytest.raises(TypeError, match=r"arguments by name, such as fov=4.71 \(radians\) .*, got \(270,\)"):
        mrs.LaserScanner(270)  # type: ignore[misc]
    with pytest.raises(TypeError, match=r"noise must be a BeamModel, got float; try BeamModel\(sigma_hit=0.01\)"):
        laser.scan_batch(grid, np.zeros((1, 3)), noise=0.01, seed=1)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="noise must be a BeamModel, got str"):
        laser.scan_batch(grid, np.zeros((1, 3)), noise="much", seed=1)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="grid must be an OccupancyGrid, got list"):
        laser.scan([], (0.0, 0.0, 0.0))  # type: ignore[arg-type]
    disc = mrs.Shape.disc(0.1)
    calls: list[Callable[[Any], object]] = [
        lambda grid: laser.scan(grid, (0.0, 0.0, 0.0)),
        lambda grid: laser.scan_batch(grid, np.zeros((1, 3))),
        lambda grid: mrs.cast_rays(grid, np.zeros((1, 3)), 1.0),
        lambda grid: mrs.touches(grid, disc, (0.0, 0.0, 0.0)),
        lambda grid: mrs.clearance(grid, disc, (0.0, 0.0, 0.0), limit=1.0),
    ]
    for call in calls:
        call(grid)
        with pytest.raises(TypeError, match=r"grid must be an OccupancyGrid, got ndarray; make one with OccupancyGrid\("):
            call(cells)


def test_a_pose_of_the_wrong_count_is_a_wrong_value_and_anything_else_a_wrong_type() -> None:
    laser, grid = mrs.LaserScanner(beam_count=3), mrs.OccupancyGrid(np.zeros((3, 3), np.int8), resolution=1.0)
    for pose in ((0.0, 0.0), [0.0] * 4, np.zeros(2)):
        with pytest.raises(ValueError, match="a pose must be three numbers"):
            laser.scan(grid, pose)  # type: ignore[arg-type]
    for wrong in (5, "abc", "ab", None, (0.0, "x"), (0.0, 0.0, None), object()):
        with pytest.raises(TypeError, match="a pose must be three numbers"):
            laser.scan(grid, wrong)  # type: ignore[arg-type]


SWEEP = {"twists": np.array([[0.5, -0.2, 1.5], [0.0, 0.0, 0.0]]), "scan_duration": 0.4}


def test_a_scan_over_time_is_taken_beam_by_beam(room: mrs.OccupancyGrid) -> None:
    laser = mrs.LaserScanner(fov=4.0, beam_count=41, mount=(0.2, 0.0, 0.1))
    poses, disc = np.array([[1.0, 2.0, 0.5], [-3.0, 1.0, 2.0]]), mrs.Shape.disc(0.5)
    times = np.arange(41) * laser.time_increment(0.4)
    found = laser.scan_batch(room, poses, obstacles=[(disc, (2.0, 2.0, 0.0), (1.0, 0.0, 1.0))], **SWEEP)
    for row, (pose, twist) in enumerate(zip(poses, SWEEP["twists"], strict=True)):
        for beam, seconds in enumerate(times):
            placed = [(disc, mrs.Pose(2.0, 2.0, 0.0).integrate((1.0, 0.0, 1.0), seconds))]
            assert found[row, beam] == laser.scan(room, mrs.Pose(*pose).integrate(twist, seconds), obstacles=placed)[beam]
    beam_poses = laser.beam_poses(poses, SWEEP["twists"], 0.4)
    assert np.array_equal(beam_poses[0], mrs.Pose(*poses[0]).trace(SWEEP["twists"][0], times))
    disc_poses = mrs.Pose(2.0, 2.0, 0.0).trace((1.0, 0.0, 1.0), times)
    assert np.array_equal(laser.scan_batch(room, beam_poses, obstacles=[(disc, disc_poses)]), found)
    # Robots that stand, and no duration.
    assert np.array_equal(laser.scan_batch(room, poses, scan_duration=0.4), laser.scan_batch(room, poses))
    assert np.array_equal(laser.scan_batch(room, poses, **{**SWEEP, "scan_duration": 0.0}), laser.scan_batch(room, poses))


def test_noise_of_a_scan_over_time_depends_on_seed_and_index_alone(room: mrs.OccupancyGrid) -> None:
    laser, poses = mrs.LaserScanner(beam_count=61), np.tile([1.0, 2.0, 0.5], (60, 1))
    twists = np.linspace(-1.0, 1.0, 180).reshape(60, 3)
    noise = mrs.BeamModel(sigma_hit=0.05, z_short=0.1)

    def readings(start: int, end: int, **options: Any) -> bytes:
        batch = {"twists": twists[start:end], "scan_duration": 0.2, "noise": noise, "seed": 5, "first_index": start}
        ranges: bytes = laser.scan_batch(room, poses[start:end], **batch, **options).tobytes()
        return ranges

    whole = readings(0, 60)
    assert readings(0, 60, threads=2) == whole
    assert readings(0, 60, out=np.empty((60, 61), np.float32)) == whole
    assert readings(0, 13) + readings(13, 60, threads=3) == whole


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scan_duration": None}, r"twists need scan_duration, the time in which the beams of a scan are taken \[s\]"),
        ({"scan_duration": -1.0}, "scan_duration must be at least 0, got -1"),
        ({"scan_duration": math.inf}, "scan_duration must be at least 0, got inf"),
        ({"twists": np.zeros((3, 3))}, "twists must have 2 elements, got 3"),
        ({"twists": np.zeros((2, 2))}, r"twists must have shape \(N, 3\), got \(2, 2\)"),
        ({"twists": np.full((2, 3), math.nan)}, r"twists must be finite, got \[NaN, NaN, NaN\] in row 0"),
        (
            {"poses": np.zeros((2, 4, 3))},
            r"poses for each beam must have shape \(N, 5, 3\), got \(2, 4, 3\)",
        ),
        ({"poses": np.zeros((2, 5, 3))}, "twists must be None if poses has one pose for each beam, got both"),
        ({"obstacles": [(mrs.Shape.disc(1.0), np.zeros((4, 3)))]}, "the poses of an obstacle must have 5 elements, got 4"),
        ({"obstacles": [(mrs.Shape.disc(1.0), np.zeros((4, 2)))]}, r"the poses of an obstacle must have shape \(N, 3\)"),
        (
            {"obstacles": [(mrs.Shape.disc(1.0), (0, 0, 0), (1, 0))]},
            "the twist of an obstacle must be three numbers",
        ),
        ({"obstacles": [(mrs.Shape.disc(1.0), (0, 0, 0), (math.nan, 0, 0))]}, "vx must be finite, got NaN"),
    ],
)
def test_bad_values_of_a_scan_over_time_are_named(room: mrs.OccupancyGrid, options: dict[str, Any], message: str) -> None:
    laser, given = mrs.LaserScanner(beam_count=5), {"poses": np.zeros((2, 3)), **SWEEP, **options}
    with pytest.raises(ValueError, match=message):
        laser.scan_batch(room, **given)


def test_obstacles_move_only_while_time_passes(room: mrs.OccupancyGrid) -> None:
    laser, disc = mrs.LaserScanner(beam_count=5), mrs.Shape.disc(1.0)
    for poses in (np.zeros((2, 3)), np.zeros((2, 5, 3))):
        with pytest.raises(ValueError, match="obstacles that move need scan_duration"):
            laser.scan_batch(room, poses, obstacles=[(disc, (3.0, 0.0, 0.0), (1.0, 0.0, 0.0))])
    with pytest.raises(ValueError, match="scan_duration must be at least 0, got -1"):
        laser.time_increment(-1.0)
