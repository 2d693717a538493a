"""Shrinking: what is not needed goes, what is needed stays, and the result depends on nothing else."""

from __future__ import annotations

import math

import pytest

from mobile_robot_simulator.falsification import Drive, shrink
from mobile_robot_simulator.scenarios import MovingDisc, World, WorldMap

WORLD = World(
    WorldMap("office", 3, (10.0, 8.0), 0.1),
    (2.25, 5.5, 1.234),
    (7.25, 2.5),
    obstacles=tuple(MovingDisc(1.0 + number, 1.75, 0.123, 0.5, 0.25) for number in range(6)),
    faults=("Drop(topic='/scan', probability=0.123)", "Blackout(topic='/odom', start=3.217, end=4.5)"),
    duration=30.0,
    seed=17,
)


def fails_if(condition, ending="contact", time=7.23):
    def run(world):
        run.count += 1
        return Drive(world, -1.0 if condition(world) else 1.0, min(time, world.duration), ending)

    run.count = 0
    return run


def shrunk(condition, **options):
    run = fails_if(condition, **options)
    return shrink(run(WORLD), run).world, run.count


def test_everything_goes_that_is_not_needed():
    world, _ = shrunk(lambda world: True)
    assert (world.things, world.map.kind, world.seed, world.start[2], world.duration) == (0, "room", 0, 0.0, 7.3)
    assert all(number == round(number, 1) for number in (*world.start, *world.goal))


def test_what_is_needed_stays():
    world, _ = shrunk(lambda world: any(disc.x == 4.0 for disc in world.obstacles) and len(world.faults) > 0)
    assert [disc.x for disc in world.obstacles] == [4.0]
    assert (world.obstacles[0].vx, world.obstacles[0].vy, world.obstacles[0].radius) == (0.0, 0.0, 0.1)
    assert world.faults == ("Drop(topic='/scan', probability=0.0)",)


def test_numbers_get_as_simple_as_they_can():
    world, _ = shrunk(lambda world: any("Blackout" in text for text in world.faults) and world.start[2] > 1.0)
    assert world.faults == ("Blackout(topic='/odom', start=0.0, end=0.1)",)
    assert world.start[2] == 1.2


def test_the_map_gets_plainer_as_far_as_it_may():
    world, _ = shrunk(lambda world: world.map.kind == "office")
    assert world.map == WorldMap("office", 0, (10.0, 8.0), 0.1)
    world, _ = shrunk(lambda world: world.map.size[0] >= 7.0)
    assert world.map.kind == "room" and world.map.size[0] == 8.0


def test_only_a_drive_that_ended_early_gets_shorter():
    assert shrunk(lambda world: world.duration >= 7.23)[0].duration == 7.3
    assert shrunk(lambda world: world.duration >= 7.5)[0].duration == 8.0
    assert shrunk(lambda world: True, ending="time")[0].duration == 30.0


def test_an_error_stays_an_error_of_its_type():
    def run(world):
        if len(world.obstacles) >= 2:
            return Drive(world, -math.inf, 1.0, "error", "ValueError: a")
        return (
            Drive(world, -math.inf, 1.0, "error", "KeyError: b") if world.obstacles else Drive(world, -1.0, 1.0, "contact")
        )

    small = shrink(run(WORLD), run)
    assert small.error.startswith("ValueError") and len(small.world.obstacles) == 2


def test_the_number_of_drives_is_limited():
    run = fails_if(lambda world: True)
    shrink(run(WORLD), run, limit=5)
    assert run.count == 6


def test_a_drive_that_has_not_failed_is_refused():
    with pytest.raises(ValueError, match="only a failed drive can be shrunk, got one with robustness 1"):
        shrink(Drive(WORLD, 1.0, 1.0, "time"), lambda world: Drive(world, 1.0, 1.0, "time"))


def test_the_start_keeps_its_room_and_everything_stays_in_the_map():
    seen = []

    def run(world):
        seen.append(world)
        return Drive(world, -1.0, 1.0, "contact")

    shrink(run(WORLD), run)
    room = min(0.5, WORLD.simulation().truth.clearance)
    for world in seen:
        assert world.simulation().truth.clearance >= room
        for x, y in [world.goal, *((disc.x, disc.y) for disc in world.obstacles)]:
            assert world.map.grid().is_free_disc(x, y, 0.0) and world.map.grid().cell_at(x, y) is not None
