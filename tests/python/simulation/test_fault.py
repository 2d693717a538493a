"""Fault: times, seeds, reports, saving and errors that all faults share."""

from __future__ import annotations

import math

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from simulations import arrivals, drive, notes, open_field


@pytest.fixture
def sim() -> mrs.Simulation:
    return open_field()


def test_each_change_of_a_message_is_reported(sim):
    sim.add_fault(faults.Drop("/scan", start=1.0, end=1.35))
    assert notes(sim, 2.0) == ["drop /scan"] * 4
    assert sim.latest("/faults") == mrs.messages.String("drop /scan")


def test_faults_are_saved_and_restored(sim):
    sim.add_fault(faults.Drop("/scan", probability=0.5, seed=1))
    sim.add_fault(faults.Reorder("/odom", probability=0.5, seed=2))
    sim.add_fault(faults.Slip(0.5, start=2.0, end=3.0))
    drive(sim)
    sim.run_for(1.55)
    state = sim.save()
    runs = []
    for _ in range(2):
        runs.append((arrivals(sim, "/scan", 2.0), arrivals(sim, "/odom", 2.0), tuple(sim.pose)))
        sim.add_fault(faults.Blackout())
        sim.restore(state)
    assert runs[0] == runs[1]
    assert len(arrivals(sim, "/scan", 1.0)) > 1


def test_a_fault_can_be_added_only_once(sim):
    fault = sim.add_fault(faults.Drop("/scan"))
    with pytest.raises(ValueError, match="Drop was added before"):
        open_field().add_fault(fault)


@pytest.mark.parametrize("seed", [None, "1", 1.0])
def test_a_seed_must_be_a_whole_number(seed):
    with pytest.raises(TypeError, match="seed must be an integer, got"):
        faults.Drop("/odom", seed=seed)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: faults.Drop("/scan", probability=1.5), "probability must be in 0..1, got 1.5"),
        (lambda: faults.Drop("/scan", start=2.0, end=1.0), "end after that, got start 2.0 and end 1.0"),
        (lambda: faults.Delay("/scan", -1.0), "seconds must be finite and at least 0, got -1"),
        (lambda: faults.Slip(2.0), "share must be in 0..1"),
        (lambda: faults.OdometryDrift((0.1, 0.2)), "alphas must be six numbers, got 2"),
        (lambda: faults.ClockJump(math.nan), "must be finite"),
        (lambda: faults.Outage("lidar"), "robot, laser or map_server, got 'lidar'"),
        (lambda: faults.BlockedSector(1.0, 0.0), "greater than the first"),
        (lambda: faults.Drop("/scam"), r"unknown topic '/scam'; did you mean /scan\?"),
        (lambda: faults.Slip(0.1, robot="r2"), "unknown robot 'r2'"),
    ],
)
def test_bad_faults_are_refused(sim, make, message):
    with pytest.raises(ValueError, match=message):
        sim.add_fault(make())


@pytest.mark.parametrize(
    ("make", "texts"),
    [
        (lambda: faults.Drop("/odom", end=0.15), {"drop /odom"}),
        (lambda: faults.Delay("/odom", 0.05, end=0.15), {"delay /odom by 0.05 s"}),
        (lambda: faults.Duplicate("/odom", end=0.15), {"duplicate /odom"}),
        (lambda: faults.Reorder("/odom", end=0.15), {"reorder /odom"}),
        (lambda: faults.Blackout(end=0.15), {"blackout of /scan"}),
        (lambda: faults.StuckRanges(end=0.15), {"ranges of /scan stuck"}),
        (lambda: faults.BlockedSector(-0.1, 0.1, end=0.15), {"4 beams of /scan blocked"}),
        (lambda: faults.Slip(0.25, end=0.15), {"the robot slips by 0.25", "the robot slips by 0"}),
        (
            lambda: faults.OdometryDrift([0.1] * 6, end=0.15),
            {"odometry of the robot drifts", "odometry of the robot no longer drifts"},
        ),
        (lambda: faults.ClockJump(2.0, at=0.1), {"the clock jumps by 2 s"}),
        (lambda: faults.Outage("laser", start=0.05, end=0.15), {"laser stops", "laser is back"}),
    ],
)
def test_each_fault_reports_what_it_does(sim, make, texts):
    fault = make()
    sim.add_fault(fault)
    assert set(notes(sim, 0.3)) == texts


def test_only_faults_can_be_added(sim):
    with pytest.raises(TypeError, match="a fault must be an object of a class in faults, got str"):
        sim.add_fault("drop")


@pytest.mark.parametrize(
    ("fault", "text"),
    [
        (faults.Drop("/scan", probability=0.1, start=2.0), "Drop('/scan', probability=0.1, start=2 s)"),
        (faults.Delay("odom", 0.1, jitter=0.05, seed=3), "Delay('/odom', 0.1 s, jitter=0.05 s, seed=3)"),
        (faults.Duplicate("/odom", after=0.5), "Duplicate('/odom', after=0.5 s)"),
        (faults.Reorder("/odom"), "Reorder('/odom')"),
        (faults.Blackout(start=1.0, end=2.5), "Blackout('/scan', start=1 s, end=2.5 s)"),
        (faults.StuckRanges(), "StuckRanges('/scan')"),
        (faults.BlockedSector(-0.5, 0.5), "BlockedSector(-0.5 rad, 0.5 rad, distance=0 m, '/scan')"),
        (faults.Slip(0.25, robot="one"), "Slip(0.25, robot='one')"),
        (faults.OdometryDrift((0.1,) * 6, seed=2), "OdometryDrift((0.1, 0.1, 0.1, 0.1, 0.1, 0.1), seed=2)"),
        (faults.ClockJump(-2.0, at=1.0), "ClockJump(-2 s, at=1 s)"),
        (faults.Outage("laser", end=3.0), "Outage('laser', end=3 s)"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_the_repr_shows_what_a_fault_does_and_when(fault, text):
    assert repr(fault) == text
