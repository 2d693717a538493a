"""strategies: worlds, poses and faults are valid, and shrink to the least that still fails."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, find, given, settings

import mobile_robot_simulator as mrs
from mobile_robot_simulator.faults import Push
from mobile_robot_simulator.scenarios import (
    Drift,
    FaultRange,
    Free,
    Moving,
    Pushes,
    Range,
    Slips,
    Space,
    WorldMap,
    floor_plans,
)
from mobile_robot_simulator.testing import disturbances, faults, poses, worlds

SPACE = Space(
    [WorldMap("room", size=(8.0, 8.0), resolution=0.1), *floor_plans("cave", seeds=(1, 2), size=(8.0, 8.0), resolution=0.1)],
    obstacles=Moving(6, radius=Range(0.1, 0.4, "m")),
    faults=[FaultRange("Drop", {"topic": "/scan", "probability": Range(0.1, 0.9)}), FaultRange("Slip", {"share": 0.2})],
    parameters={"laser_beam_count": 31, "robot_radius": 0.2, "laser_max_range": Range(1.0, 5.0, "m")},
)


@settings(max_examples=20, deadline=None)
@given(worlds(SPACE))
def test_worlds_can_be_simulated(world):
    sim = world.simulation()
    sim.run_for(0.2)
    assert sim.truth.clearance > 0.0


@settings(max_examples=5, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(worlds(SPACE))
def test_worlds_work_with_the_fixture(simulation, world):
    sim = simulation(world)
    assert sim.goal == world.goal and len(sim.obstacles) == len(world.obstacles) and len(sim.faults) == len(world.faults)
    sim.run_for(0.1)


@given(poses(WorldMap("room", size=(3.0, 2.0), resolution=0.1), Free(0.3, Range(-1.0, 1.0))))
def test_poses_are_free(pose):
    assert WorldMap("room", size=(3.0, 2.0), resolution=0.1).grid().is_free_disc(*pose[:2], 0.3) and -1.0 <= pose[2] <= 1.0


@given(
    faults(FaultRange("Blackout", {"start": Range(1.0, 2.0)}, duration=Range(1.0, 2.0)), FaultRange("Slip", {"share": 0.1}))
)
def test_faults_can_be_added(drawn):
    sim = mrs.Simulation(WorldMap().grid(), start=(2.0, 2.0, 0.0))
    for fault in drawn:
        sim.add_fault(fault)
    assert len(sim.faults) == len(drawn) <= 2


DISTURBANCES = disturbances(Pushes(3), Slips(2), Drift(), duration=10.0)


@settings(max_examples=20, deadline=None)
@given(DISTURBANCES)
def test_disturbances_can_be_added(drawn):
    sim = mrs.Simulation(WorldMap().grid(), start=(2.0, 2.0, 0.0))
    for fault in drawn:
        assert fault.start <= 10.0
        sim.add_fault(fault)
    sim.run_for(0.2)


def test_disturbances_shrink_to_fewer_shorter_and_weaker_ones():
    def least(condition):
        return [repr(fault) for fault in find(DISTURBANCES, condition, settings=settings(max_examples=2000, database=None))]

    assert least(lambda drawn: True) == []
    pushed = least(lambda drawn: any(isinstance(fault, Push) and fault.speed > 0.1 for fault in drawn))
    assert pushed == ["Push(0.101 m/s, end=0.5 s)"]
    assert least(lambda drawn: any(fault.end - fault.start > 1.5 for fault in drawn if isinstance(fault, Push))) == [
        "Push(0.05 m/s, end=1.501 s)"
    ]


def small(condition):
    return find(worlds(SPACE), condition, settings=settings(max_examples=2000, database=None))


def test_worlds_shrink_to_the_least():
    nothing = small(lambda world: True)
    assert (nothing.map, nothing.things, nothing.start[2], nothing.seed) == (SPACE.maps[0], 0, 0.0, 0)
    one = small(lambda world: any(disc.radius >= 0.25 for disc in world.obstacles))
    assert [disc.radius for disc in one.obstacles] == [0.25] and not one.faults and one.map == SPACE.maps[0]
    lost = small(lambda world: any("Drop" in text for text in world.faults))
    assert lost.faults == ("Drop(topic='/scan', probability=0.1)",) and not lost.obstacles
    turned = small(lambda world: world.start[2] > 1.0)
    assert turned.start[2] == 1.001


def test_a_pose_shrinks_to_the_first_place():
    assert find(poses(free=Free(0.5)), lambda pose: True) == (0.75, 0.75, 0.0)


def test_a_world_is_given_alone(simulation):
    world = Space().world([0.5] * len(Space().dimensions))
    for other in ({"seed": 1}, {"parameters": {}}, {"start": (1, 1, 0)}, {"robots": ["a"]}, {"size": (9, 9)}):
        with pytest.raises(ValueError, match="no other argument can be given"):
            simulation(world, **other)


def test_a_map_without_a_place_is_refused():
    with pytest.raises(ValueError, match="must have a place for a disc"):
        poses(WorldMap("room", size=(1.0, 1.0)), Free(0.7))
