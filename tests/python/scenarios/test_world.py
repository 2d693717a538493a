"""World: plain data that comes back from JSON unchanged, and simulates the same drive."""

from __future__ import annotations

import dataclasses
import json

import pytest

from mobile_robot_simulator.scenarios import MovingDisc, World, WorldMap

WORLD = World(
    WorldMap("office", 3, (10.0, 8.0), 0.1),
    (2.1, 1.3, 0.1 + 0.2),
    (5.5, 6.5),
    obstacles=(MovingDisc(4.0, 4.0, 0.2), MovingDisc(1.0, 6.0, 0.3, 0.5, -0.25)),
    faults=("Drop('/scan', probability=0.1)",),
    parameters={"robot_radius": 0.2, "laser_beam_count": 31},
    duration=4.0,
    seed=9,
)


def test_json_keeps_every_bit():
    again = World.from_json(WORLD.to_json())
    assert again == WORLD and again.name == WORLD.name and again.start[2] == 0.30000000000000004
    assert dataclasses.replace(WORLD, seed=8).name != WORLD.name
    plain = World(WorldMap(), (1.0, 1.0, 0.0))
    assert World.from_json(plain.to_json()) == plain and plain.things == 0 and WORLD.things == 3


def test_the_simulation_has_everything():
    world = dataclasses.replace(WORLD, map=WorldMap("room", size=(10.0, 8.0)))
    sim = world.simulation()
    standing, moving = sim.obstacles
    assert tuple(standing.pose(3 * 10**9)) == (4.0, 4.0, 0.0)
    assert [tuple(moving.pose(round(time * 1e9))) for time in (0.0, 2.0, 4.0)] == [(1, 6, 0), (2, 5.5, 0), (3, 5, 0)]
    assert repr(sim.faults[0]) == "Drop('/scan', probability=0.1)"
    assert len(sim.laser.scanner.angles) == 31 and sim.goal == (5.5, 6.5)


def changed(**values):
    return json.dumps({**json.loads(WORLD.to_json()), **values})


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "null",
        "[" * 10000,
        changed(start=[1.0, "x", 0.0]),
        changed(map={"size": 3}),
        changed(obstacles=[{"z": 1}]),
        changed(start=[1.0, float("nan"), 0.0]),
        changed(duration=None),
        changed(parameters=3),
    ],
)
def test_what_is_no_world_is_refused(text):
    with pytest.raises(ValueError, match=r"^not a world: "):
        World.from_json(text)


def test_a_start_in_a_wall_is_refused():
    with pytest.raises(ValueError, match="must not be inside a wall"):
        World(WorldMap(), (0.0, 1.0, 0.0)).simulation()
