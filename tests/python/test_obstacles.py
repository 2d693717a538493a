"""obstacles: scans, batches of scans and rays see obstacles and cells together."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import Obstacles
from mobile_robot_simulator._core import stays_clear

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


def shown(result: Any) -> str:
    if isinstance(result, tuple):
        return "".join(map(shown, result))
    return str(result.tobytes() if isinstance(result, np.ndarray) else result)


def test_obstacles_that_are_converted_once_are_like_pairs(room: mrs.OccupancyGrid) -> None:
    discs = [(DISC, (3.0 * math.cos(angle), 3.0 * math.sin(angle), 0.0)) for angle in np.linspace(0.3, 6.0, 9)]
    pairs = [*discs, (mrs.Shape.rectangle(1.0, 0.2), (0.0, 1.5, 0.4))]
    once, scanner, noise = Obstacles(pairs), mrs.LaserScanner(beam_count=91), mrs.BeamModel(z_hit=0.9, z_rand=0.1)
    pose, poses, robot = (0.1, -0.2, 0.3), np.array([[0.1, -0.2, 0.3], [0.5, 0.2, -2.0]]), mrs.Shape.disc(0.3)
    seen = scanner.scan(room, pose, obstacles=pairs)
    calls: list[Callable[[Any], Any]] = [
        lambda obstacles: scanner.scan(room, pose, obstacles=obstacles),
        lambda obstacles: scanner.scan_batch(room, poses, obstacles=obstacles, noise=noise, seed=1, first_index=0),
        lambda obstacles: scanner.intensities(room, poses, obstacles=obstacles),
        lambda obstacles: scanner.hits(room, poses, obstacles=obstacles),
        lambda obstacles: scanner.log_likelihood(room, poses, seen, noise=noise, obstacles=obstacles),
        lambda obstacles: mrs.cast_rays(room, poses, 20.0, obstacles=obstacles),
        lambda obstacles: mrs.touches(room, robot, (2.9, 0.6, 0.0), obstacles=obstacles),
        lambda obstacles: mrs.clearance(room, robot, pose, limit=9.0, obstacles=obstacles),
        lambda obstacles: mrs.clearance_batch(room, robot, poses, limit=9.0, obstacles=obstacles),
        lambda obstacles: mrs.advance(room, robot, pose, (1.0, 0.0, 0.1), 5.0, obstacles=obstacles),
        lambda obstacles: stays_clear(room, robot, pose, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 0.5, obstacles=obstacles),
    ]
    for call in calls:
        assert shown(call(once)) == shown(call(pairs)) != shown(call(()))
        assert shown(call(once.without(0))) == shown(call([(DISC, (1e5, 0.0, 0.0)), *pairs[1:]]))


def test_what_is_placed_later_is_there_in_all_views(room: mrs.OccupancyGrid) -> None:
    scanner = mrs.LaserScanner(fov=2 * math.pi, beam_count=8)
    obstacles = Obstacles()
    others = obstacles.without(1)
    assert len(obstacles) == 0
    obstacles.place(0, DISC, (2.0, 0.0, 0.0))
    obstacles.place(1, DISC, (0.0, 2.0, 0.0))
    assert len(obstacles) == len(others) == 2
    ahead, left = scanner.scan(room, (0, 0, 0), obstacles=obstacles)[[4, 6]]
    assert (ahead, left) == pytest.approx((1.5, 1.5), abs=1e-6)
    assert scanner.scan(room, (0, 0, 0), obstacles=others)[6] > 3.0
    obstacles.place(0, DISC, mrs.Pose(3.0, 0.0, 0.0))
    assert scanner.scan(room, (0, 0, 0), obstacles=others)[4] == pytest.approx(2.5, abs=1e-6)


def test_invalid_places_change_nothing(room: mrs.OccupancyGrid) -> None:
    obstacles = Obstacles([(DISC, (2.0, 0.0, 0.0))])
    for index, pose, error, message in [
        (2, (0, 0, 0), ValueError, "index must be at most the number of obstacles, got 2"),
        (-1, (0, 0, 0), ValueError, "index must be at least 0, got -1"),
        (0.5, (0, 0, 0), TypeError, "index must be an integer, got float"),
        (0, (0, math.inf, 0), ValueError, "y must be finite, got inf"),
        (0, (0, 0), ValueError, "a pose must be three numbers"),
    ]:
        with pytest.raises(error, match=message):
            obstacles.place(index, DISC, pose)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="index must be at least 0, got -2"):
        obstacles.without(-2)
    with pytest.raises(TypeError, match=r"placed must be a sequence of \(Shape, pose\), got int"):
        Obstacles(3)  # type: ignore[arg-type]
    assert obstacles.placed == [(DISC, mrs.Pose(2.0, 0.0, 0.0))] and obstacles.left_out is None
    assert mrs.clearance(room, DISC, (0.0, 0.0, 0.0), limit=5.0, obstacles=obstacles) == pytest.approx(1.0)


def test_a_scan_that_takes_time_needs_to_know_how_obstacles_move(room: mrs.OccupancyGrid) -> None:
    with pytest.raises(TypeError, match=r"scans that take time must be a sequence of .*, got Obstacles"):
        mrs.LaserScanner().scan_batch(room, np.zeros((1, 3)), scan_duration=0.1, obstacles=Obstacles())


def test_a_call_keeps_the_obstacles_that_it_started_with(room: mrs.OccupancyGrid) -> None:
    obstacles, scanner, poses = Obstacles([(DISC, (2.0, 0.0, 0.0))]), mrs.LaserScanner(beam_count=500), np.zeros((2000, 3))
    expected = {scanner.scan(room, (0, 0, 0), obstacles=[(DISC, (x, 0.0, 0.0))]).tobytes() for x in (2.0, 3.0)}
    seen = set()

    def cast() -> None:
        for _ in range(20):
            rows = {row.tobytes() for row in scanner.scan_batch(room, poses, obstacles=obstacles, threads=1)}
            assert len(rows) == 1
            seen.update(rows)

    thread = threading.Thread(target=cast)
    thread.start()
    while thread.is_alive():
        obstacles.place(0, DISC, (3.0, 0.0, 0.0))
        obstacles.place(0, DISC, (2.0, 0.0, 0.0))
    thread.join()
    assert seen and seen <= expected
