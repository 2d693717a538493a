"""Faults of messages: each changes the messages that it should, when it should, in the same way every time."""

from __future__ import annotations

import doctest
import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from simulations import arrivals, drive, open_field


@pytest.fixture
def sim() -> mrs.Simulation:
    return open_field()


def test_dropped_messages_are_missing_while_the_fault_acts(sim):
    sim.add_fault(faults.Drop("/scan", probability=0.5, seed=1, start=1.0, end=3.0))
    times = [time for time, _ in arrivals(sim, "/scan", 4.0)]
    assert len([time for time in times if not 1.0 <= time < 3.0]) == 20
    assert 4 <= len([time for time in times if 1.0 <= time < 3.0]) <= 16
    again = open_field()
    again.add_fault(faults.Drop("/scan", probability=0.5, seed=1, start=1.0, end=3.0))
    assert [time for time, _ in arrivals(again, "/scan", 4.0)] == times


def test_delayed_messages_arrive_late_with_their_own_stamps(sim):
    sim.add_fault(faults.Delay("/scan", 0.25))
    assert [round(time - stamp, 9) for time, stamp in arrivals(sim, "/scan", 1.0)] == [0.25] * 7
    jittery = open_field()
    jittery.add_fault(faults.Delay("/scan", 0.1, jitter=0.3, seed=2))
    late = [time - stamp for time, stamp in arrivals(jittery, "/scan", 5.0)]
    assert min(late) < 0.15 and max(late) > 0.35 and all(0.1 <= value <= 0.4 for value in late)


def test_duplicated_messages_arrive_twice(sim):
    sim.add_fault(faults.Duplicate("/odom", after=0.05))
    times = np.array(arrivals(sim, "/odom", 0.32))
    assert times == pytest.approx(np.array([(0.1, 0.1), (0.15, 0.1), (0.2, 0.2), (0.25, 0.2), (0.3, 0.3)]))


def test_reordered_messages_arrive_after_the_next_one(sim):
    sim.add_fault(faults.Reorder("/odom", start=0.15, end=0.45))
    assert [stamp for _, stamp in arrivals(sim, "/odom", 0.6)] == pytest.approx([0.1, 0.3, 0.2, 0.5, 0.6])
    spared = open_field()
    spared.add_fault(faults.Reorder("/odom", probability=0.3, seed=3))
    stamps = [stamp for _, stamp in arrivals(spared, "/odom", 5.0)]
    assert sorted(stamps) == pytest.approx(np.arange(1, len(stamps) + 1) / 10) and stamps != sorted(stamps)


def test_a_blackout_affects_the_scanner_only(sim):
    sim.add_fault(faults.Blackout(start=0.5, end=1.5))
    assert len(arrivals(sim, "/scan", 2.0)) == 10
    assert sim.latest("/odom").header.stamp.nanoseconds == 2_000_000_000


def test_stuck_ranges_repeat_with_current_stamps(sim):
    drive(sim)
    sim.add_fault(faults.StuckRanges(start=0.45, end=1.0))
    scans = []
    sim.subscribe("/scan", mrs.messages.LaserScan, scans.append)
    sim.run_for(1.2)
    ranges = [scan.ranges for scan in scans]
    assert all(np.array_equal(later, ranges[4]) for later in ranges[5:9])
    assert not np.array_equal(ranges[3], ranges[4]) and not np.array_equal(ranges[9], ranges[4])
    assert len({scan.header.stamp.nanoseconds for scan in scans}) == 12


def test_a_blocked_sector_reads_the_distance_to_the_object(sim):
    sim.add_fault(faults.BlockedSector(-0.501, 0.501, distance=0.2))
    sim.run_for(0.1)
    scan = sim.latest("/scan")
    angles = scan.angle_min + np.arange(61) * scan.angle_increment
    assert np.all(scan.ranges[np.abs(angles) <= 0.501] == np.float32(0.2)) and np.all(scan.ranges[np.abs(angles) > 0.51] > 1)
    near = open_field()
    near.add_fault(faults.BlockedSector(-0.5, 0.5))
    near.run_for(0.1)
    assert near.latest("/scan").ranges[30] == -math.inf


def test_a_wall_nearer_than_the_blocking_object_is_seen(sim):
    sim.set_pose((0.5, 5.0, math.pi))
    sim.add_fault(faults.BlockedSector(-0.1, 0.1, distance=3.0))
    sim.run_for(0.1)
    assert sim.latest("/scan").ranges[30] == pytest.approx(0.4, abs=0.01)


def test_faults_of_one_topic_apply_in_the_order_in_which_they_were_added(sim):
    sim.add_fault(faults.Duplicate("/odom"))
    sim.add_fault(faults.Delay("/odom", 0.05))
    assert np.array(arrivals(sim, "/odom", 0.2)) == pytest.approx(np.array([(0.15, 0.1), (0.15, 0.1)]))


@pytest.mark.parametrize(
    "make", [lambda: faults.StuckRanges("/odom"), lambda: faults.BlockedSector(0.0, 1.0, topic="/odom")]
)
def test_faults_of_scans_need_a_topic_of_scans(sim, make):
    with pytest.raises(TypeError, match="needs a topic of LaserScan, /odom carries Odometry"):
        sim.add_fault(make())
    sim.run_for(1.0)


def test_faults_do_not_act_on_their_own_reports(sim):
    sim.add_fault(faults.Drop("/scan"))
    for fault in (faults.Drop("/faults"), faults.Delay("faults", 1.0)):
        with pytest.raises(ValueError, match="a fault cannot act on /faults, where faults report what they do"):
            sim.add_fault(fault)
    sim.run_for(1.0)
    assert len(sim.faults) == 1


def test_the_example_of_the_documentation_runs():
    results = doctest.testmod(faults)
    assert results.attempted and not results.failed
