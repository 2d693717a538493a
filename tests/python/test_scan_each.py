"""scan_each: the scans of several scanners, maps and crowds in one call are those of `scan_batch`."""

from __future__ import annotations

import random
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator._core import scan_each
from simulations import hall

SEED = 3

GRIDS = (hall(12.0), mrs.floor_plan("office", seed=1, size=(12.0, 10.0)))
SCANNERS = (
    mrs.LaserScanner(beam_count=300),
    mrs.LaserScanner(beam_count=300),
    mrs.LaserScanner(beam_count=300, mount=(0.2, 0.0, 0.1)),
    mrs.LaserScanner(beam_count=1),
    mrs.LaserScanner(beam_count=77, mount=(0.0, 0.0, 0.5, 0.0, 0.2, 0.0)),
)
NOISES = (None, mrs.BeamModel(), mrs.BeamModel(sigma_hit=0.3, z_hit=0.9, z_rand=0.1))
SURFACES = (None, None, mrs.SurfaceModel(incidence_sigma=0.1, beam_divergence=0.01))
CROWD = mrs.Obstacles([(mrs.Shape.disc(0.3), (1.0 + 0.9 * (i % 11), 1.0 + 1.1 * (i // 11), 0.0)) for i in range(90)])


def scans(count: int) -> list[Any]:
    dice = random.Random(SEED)
    drawn = []
    for index in range(count):
        scanner, noise = dice.choice(SCANNERS), dice.choice(NOISES)
        is_level = scanner is not SCANNERS[-1]
        surfaces = dice.choice(SURFACES) if is_level and noise is not None else None
        obstacles = dice.choice([(), CROWD.without(index % 90), [(mrs.Shape.disc(0.5), (6.0, 6.0, 0.0))]])
        pose = (dice.uniform(-1.0, 13.0), dice.uniform(-1.0, 11.0), dice.uniform(-4.0, 4.0))
        drawn.append((scanner, dice.choice(GRIDS), pose, obstacles, noise, surfaces, dice.randrange(2**64), index))
    return drawn


@pytest.mark.parametrize("threads", [1, 2, 7, None])
@pytest.mark.parametrize("count", [0, 1, 9, 250])
def test_each_scan_is_that_of_scan_batch(count: int, threads: int | None) -> None:
    together = scan_each(scans(count), threads=threads)
    assert len(together) == count
    for (scanner, grid, pose, obstacles, noise, surfaces, seed, index), ranges in zip(scans(count), together, strict=True):
        stream = {} if noise is None else {"noise": noise, "surfaces": surfaces, "seed": seed, "first_index": index}
        expected = scanner.scan_batch(grid, [pose], obstacles=obstacles, threads=1, **stream)
        assert ranges.dtype == np.float32 and ranges.tobytes() == expected[0].tobytes()


def test_long_scans_may_follow_short_ones() -> None:
    short, long = mrs.LaserScanner(beam_count=7), mrs.LaserScanner(beam_count=541)
    grid = GRIDS[1]
    poses = grid.draw_free_poses(200, radius=0.2, seed=SEED)
    every = [(long if scan else short, grid, tuple(pose), (), None, None, 0, 0) for scan, pose in enumerate(poses)]
    for ranges, expected in zip(scan_each(every, threads=2)[1:], long.scan_batch(grid, poses)[1:], strict=True):
        assert ranges.tobytes() == expected.tobytes()


def test_each_scan_has_memory_of_its_own() -> None:
    first, second = scan_each([(SCANNERS[0], GRIDS[0], (3.0, 3.0, 0.0), (), None, None, 0, 0)] * 2)
    assert first.base is not second.base and first.flags.writeable and first.flags.c_contiguous


@pytest.mark.parametrize(
    ("part", "bad", "error", "match"),
    [
        (0, None, TypeError, "LaserScanner"),
        (1, np.zeros((3, 3), np.int8), TypeError, "grid must be an OccupancyGrid"),
        (2, (1.0, float("nan"), 0.0), ValueError, "y must be finite"),
        (3, 7, TypeError, "obstacles must be a sequence"),
        (4, 0.1, TypeError, "noise must be a BeamModel"),
        (5, "dark", TypeError, "surfaces must be a SurfaceModel"),
        (6, -1, ValueError, "seed must be in 0"),
        (7, 2**64, ValueError, "index must be in 0"),
        (7, 0.5, TypeError, "index must be an integer"),
    ],
)
def test_a_bad_part_of_a_scan_is_refused(part: int, bad: Any, error: type[Exception], match: str) -> None:
    good: list[Any] = [SCANNERS[0], GRIDS[0], (3.0, 3.0, 0.0), (), mrs.BeamModel(), None, 1, 2]
    scan = [*good[:part], bad, *good[part + 1 :]]
    with pytest.raises(error, match=match):
        scan_each([tuple(good), tuple(scan)])


def test_surfaces_need_a_scanner_that_is_not_tilted() -> None:
    tilted = (SCANNERS[-1], GRIDS[0], (3.0, 3.0, 0.0), (), mrs.BeamModel(), SURFACES[-1], 1, 2)
    with pytest.raises(ValueError, match="tilted"):
        scan_each([tilted])
