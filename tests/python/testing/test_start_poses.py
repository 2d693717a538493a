"""Random start poses: in free space, at a distance from each other, and the same for the same seed."""

from __future__ import annotations

import itertools
import math

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.testing.start_poses import RADIUS, draw_start_poses
from simulations import hall


def test_robots_have_room_beside_walls_and_each_other():
    grid = hall(6.0)
    poses = draw_start_poses(grid, ["one", "two", "three"], {"robot_radius": 0.5}, seed=3)
    assert list(poses) == ["one", "two", "three"]
    assert all(grid.is_free_disc(pose.x, pose.y, 0.5) for pose in poses.values())
    for first, second in itertools.combinations(poses.values(), 2):
        assert math.hypot(first.x - second.x, first.y - second.y) > 1.0


def test_the_seed_defines_the_poses():
    grid = hall(6.0)
    assert draw_start_poses(grid, ["one"], {}, 3) == draw_start_poses(grid, ["one"], {}, 3)
    assert draw_start_poses(grid, ["one"], {}, 3) != draw_start_poses(grid, ["one"], {}, 4)
    pose = draw_start_poses(grid, [""], {}, 3)[""]
    assert isinstance(pose, mrs.Pose) and grid.is_free_disc(pose.x, pose.y, RADIUS)


@pytest.mark.parametrize("names", ["one", ["one", "one"]])
def test_names_must_be_a_list_without_repetition(names):
    with pytest.raises(ValueError, match="robots must be a list of different names"):
        draw_start_poses(hall(6.0), names, {}, 0)


def test_too_many_robots_are_refused():
    with pytest.raises(ValueError, match=r"no start pose was found for robot .* beside r0, r1"):
        draw_start_poses(hall(3.0), [f"r{number}" for number in range(100)], {}, 0)
