"""Space: each coordinate moves the number that its dimension names, within its limits."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from mobile_robot_simulator.faults.reading import read_fault
from mobile_robot_simulator.scenarios import FaultRange, Free, Moving, Range, Space, WorldMap, floor_plans

SEED = 6
ROOM = WorldMap("room", size=(6.0, 4.0), resolution=0.1)


def full() -> Space:
    return Space(
        maps=[ROOM, *floor_plans("office", "cave", seeds=(1, 2), size=(10.0, 8.0), resolution=0.1)],
        obstacles=Moving(4, at_least=1, radius=Range(0.1, 0.4, "m"), speed=Range(0.0, 1.0, "m/s")),
        faults=[
            FaultRange("Blackout", {"topic": "/scan", "start": Range(0.0, 20.0, "s")}, duration=Range(1.0, 5.0, "s")),
            FaultRange("Slip", {"share": Range(0.1, 0.5)}, chance=1.0),
        ],
        parameters={"robot_radius": 0.2, "laser_max_range": Range(3.0, 10.0, "m")},
    )


def random_points(space: Space, count: int) -> np.ndarray:
    return np.random.default_rng(SEED).random((count, len(space.dimensions)))


def test_random_worlds_are_within_their_limits_and_can_be_simulated():
    space = full()
    seen = set()
    for point in random_points(space, 60):
        world = space.world(point)
        sim = world.simulation()
        assert sim.truth.clearance >= 0.3 and not sim.truth.contacts
        assert tuple(sim.pose) == world.start and sim.goal == world.goal
        assert sim.grid.is_free_disc(*world.start[:2], 0.5) and sim.grid.is_free_disc(*world.goal, 0.5)
        assert len(sim.obstacles) == len(world.obstacles) <= 4
        for disc in world.obstacles:
            assert 0.1 <= disc.radius <= 0.4 and math.hypot(disc.vx, disc.vy) <= 1.002
            assert math.hypot(disc.x - world.start[0], disc.y - world.start[1]) >= disc.radius + 0.6
        assert 3.0 <= world.parameters["laser_max_range"] <= 10.0 and world.parameters["robot_radius"] == 0.2
        assert 0 <= world.seed < 1000
        *blackouts, slip = [read_fault(text) for text in world.faults]
        assert 0.1 <= slip.share <= 0.5
        for blackout in blackouts:
            assert blackout.topic == "/scan" and 0.0 <= blackout.start <= 20.0
            assert 1.0 - 1e-9 <= blackout.end - blackout.start <= 5.0 + 1e-9
        seen.add((world.map, len(world.obstacles), len(world.faults)))
    assert {map for map, _, _ in seen} == set(space.maps) and {count for _, count, _ in seen} >= {1, 2, 3, 4}
    assert {count for _, _, count in seen} == {1, 2}


def test_a_coordinate_changes_only_its_own_number():
    space = full()
    names = [dimension.name for dimension in space.dimensions]
    assert len(names) == len(set(names)) and names[:4] == ["map", "start x", "start y", "start yaw"]
    point = np.full(len(names), 0.4)
    before = space.world(point)
    for name, change in {
        "goal x": "goal",
        "obstacle 1 radius": "obstacles",
        "fault 1 Blackout": "faults",
        "laser_max_range": "parameters",
        "seed": "seed",
    }.items():
        moved = point.copy()
        moved[names.index(name)] = 0.9
        after = space.world(moved)
        changed = [key for key in vars(before) if getattr(before, key) != getattr(after, key)]
        assert changed == [change], name


def test_positions_are_spread_evenly_over_the_free_places():
    """Each of 4 columns of the lattice has an equal chance here: chi-squared with 3 degrees of freedom, 99.9 %."""
    space = Space(
        [WorldMap("room", size=(1.25, 1.25), resolution=0.05)], start=Free(0.1, Range(0, 0)), goal=None, is_noisy=False
    )
    places = space.maps[0].places(0.1)
    assert len(places) == 16
    counts = dict.fromkeys(places, 0)
    for point in random_points(space, 4000):
        counts[space.world(point).start[:2]] += 1
    expected = 4000 / 16
    assert sum((count - expected) ** 2 / expected for count in counts.values()) < 37.7


def test_corners_of_the_cube_are_the_limits():
    space = Space([ROOM], start=(1.0, 1.0, 0.0), goal=None, parameters={"laser_max_range": Range(2.0, 3.0)}, is_noisy=False)
    assert [space.world([share]).parameters["laser_max_range"] for share in (0.0, 0.5, 1.0)] == [2.0, 2.5, 3.0]


def test_a_space_can_be_sent_to_another_process():
    space = full()
    point = random_points(space, 1)[0]
    assert pickle.loads(pickle.dumps(space)).world(point) == space.world(point)


@pytest.mark.parametrize("point", [[], [0.5], [0.5, 0.5, 1.1, 0.5, 0.5], [math.nan] * 5])
def test_points_are_checked(point):
    space = Space([ROOM], is_noisy=False)
    with pytest.raises(ValueError, match=r"a point must be 5 numbers in 0\.\.1, got"):
        space.world(point)


def test_arguments_are_checked():
    for make, message in {
        lambda: Space(duration=0.0): "duration must be positive, got 0.0 s",
        lambda: Space(duration=math.inf): "duration must be finite",
        lambda: Range(2.0, 1.0): "two finite limits",
        lambda: Range(0.0, math.inf): "two finite limits",
        lambda: Moving(2, at_least=3): "at_most must be 3 to 1000, got 2",
        lambda: Moving(2, radius=Range(-1.0, 1.0)): "radius must be finite and at least 0",
        lambda: FaultRange("Blackuot"): "did you mean 'Blackout'",
        lambda: FaultRange("Drop", chance=1.5): r"chance must be in 0\.\.1",
        lambda: Free(-1.0): "radius must be finite and at least 0",
    }.items():
        with pytest.raises(ValueError, match=message):
            make()
