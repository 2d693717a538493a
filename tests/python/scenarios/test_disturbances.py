"""disturbances: worlds have as many as they may, within their ranges, and a drive repeats byte by byte."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from falsification.windy import controller, requirement, space
from mobile_robot_simulator import faults
from mobile_robot_simulator.falsification import run_drive
from mobile_robot_simulator.faults.reading import read_fault
from mobile_robot_simulator.scenarios import Drift, Pushes, Range, Slips, Space, World

SEED = 12


def random_worlds(space: Space, count: int) -> list[World]:
    points = np.random.default_rng(SEED).random((count, len(space.dimensions)))
    return [space.world(point) for point in points]


def test_worlds_have_as_many_as_they_may_within_the_ranges():
    counts = set()
    for world in random_worlds(space, 200):
        read = [read_fault(text) for text in world.faults]
        pushes = [fault for fault in read if isinstance(fault, faults.Push)]
        slips = [fault for fault in read if isinstance(fault, faults.Slip)]
        drifts = [fault for fault in read if isinstance(fault, faults.OdometryDrift)]
        assert len(pushes) + len(slips) + len(drifts) == len(read)
        for fault in pushes:
            assert 0.05 <= fault.speed <= 0.4 and abs(fault.direction) <= math.pi
        for fault in (*pushes, *slips):
            assert 0.0 <= fault.start <= 8.0 and 0.5 - 1e-9 <= fault.end - fault.start <= 3.0 + 1e-9
        assert all(0.1 <= fault.share <= 0.5 for fault in slips)
        assert all(max(fault.alphas) <= 0.02 and fault.end == math.inf for fault in drifts)
        counts |= {("pushes", len(pushes)), ("slips", len(slips)), ("drifts", len(drifts))}
    expected = {("pushes", count) for count in range(4)} | {("slips", count) for count in range(3)}
    assert counts == expected | {("drifts", 0), ("drifts", 1)}


def test_dimensions_have_units_and_each_changes_its_own_number():
    names = {dimension.name: dimension for dimension in space.dimensions}
    assert len(names) == len(space.dimensions)
    assert names["disturbance 1 Push 2 speed"][1:] == (0.05, 0.4, "m/s")
    assert names["disturbance 1 Push 2 start"][1:] == (0.0, 8.0, "s")
    assert names["disturbance 1 Push 3 direction"].unit == "rad" and names["disturbance 2 Slip 1 share"].unit == ""
    assert names["disturbance 3 OdometryDrift 1 alphas 4"].high == 0.02
    point = np.full(len(names), 0.7)
    before = space.world(point)
    point[list(names).index("disturbance 1 Push 1 speed")] = 0.0
    after = space.world(point)
    assert after.faults[0] == before.faults[0].replace("speed=0.295", "speed=0.05") and after.faults[1:] == before.faults[1:]
    assert pickle.loads(pickle.dumps(space)).world(point) == after


def test_drift_has_other_errors_in_other_worlds_unless_the_space_is_not_noisy():
    for is_noisy in (True, False):
        drifting = Space(start=(2.0, 2.0, 0.0), goal=None, disturbances=[Drift(at_least=1)], is_noisy=is_noisy)
        seeds = {read_fault(world.faults[0]).seed for world in random_worlds(drifting, 20)}
        assert (len(seeds) > 15) if is_noisy else seeds == {0}


def test_disturbances_come_after_faults_and_a_space_without_them_is_as_before():
    plain = Space(start=(2.0, 2.0, 0.0), goal=None, is_noisy=False)
    assert plain.dimensions == ()
    both = Space(start=(2.0, 2.0, 0.0), goal=None, is_noisy=False, faults=space.faults, disturbances=[Pushes(1, at_least=1)])
    assert [text.partition("(")[0] for text in both.world([0.5] * len(both.dimensions)).faults] == ["Push"]


def test_a_world_from_its_file_drives_byte_by_byte_the_same():
    (world, *_) = [world for world in random_worlds(space, 50) if world.things == 6]
    again = World.from_json(world.to_json())
    assert again == world
    paths = []
    for each in (world, again):
        sim = each.simulation()
        sim.run_for(5.0)
        paths.append(sim.truth.path.tobytes())
    assert paths[0] == paths[1]
    assert run_drive(world, controller, requirement) == run_drive(again, controller, requirement)


def test_bad_disturbances_are_refused():
    with pytest.raises(ValueError, match="at_most must be 2 to 1000, got 1"):
        Pushes(1, at_least=2)
    with pytest.raises(TypeError, match=r"at_most must be an integer, got 1\.5"):
        Slips(1.5)
    with pytest.raises(TypeError, match=r"speed must be a scenarios\.Range, got 0\.5"):
        Pushes(1, speed=0.5)
    with pytest.raises(ValueError, match="speed must be"):
        Pushes(1, speed=Range(-1.0, 1.0, "m/s"))
    with pytest.raises(ValueError, match=r"the share must be in 0\.\.1, got 1\.5"):
        Slips(1, share=Range(0.5, 1.5))
    with pytest.raises(ValueError, match="a fault must start at 0 s or later and end after that"):
        Slips(1, duration=Range(0.0, 1.0, "s"))
    with pytest.raises(ValueError, match="alphas must be six numbers, got 2"):
        Drift(alphas=(0.1, Range(0.0, 0.1)))
    with pytest.raises(ValueError, match="at_most must be 0 or 1"):
        Drift(2)
    with pytest.raises(ValueError, match=r"at most one scenarios\.Drift, got 2"):
        Space(disturbances=[Drift(), Drift()])
    with pytest.raises(TypeError, match=r"disturbances\[0\] must be a"):
        Space(disturbances=["Push"])
