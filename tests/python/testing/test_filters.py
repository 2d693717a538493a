"""message_filters on the bus: sets of messages against a search of all pairs, caches, and restores."""

from __future__ import annotations

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.instant import Instant
from mobile_robot_simulator.messages import Header, Odometry, String, Time, TwistStamped
from mobile_robot_simulator.testing import stand_in
from simulations import small_room

with stand_in():
    from message_filters import ApproximateTimeSynchronizer, Cache, SimpleFilter, Subscriber, TimeSynchronizer
    from nav_msgs.msg import Odometry as SameOdometry
    from rclpy.node import Node
    from sensor_msgs.msg import LaserScan


def stamped(ns: int) -> TwistStamped:
    return TwistStamped(header=Header(Time.from_nanoseconds(ns)))


def feed(synchronizer_of, arrivals: list[tuple[int, int]], count: int = 2) -> list[tuple[int, ...]]:
    """Returns the stamps of the sets that a synchronizer makes of (input, stamp) pairs."""
    inputs = [SimpleFilter() for _ in range(count)]
    sets: list[tuple[int, ...]] = []
    synchronizer_of(inputs).registerCallback(lambda *found: sets.append(tuple(m.header.stamp.nanoseconds for m in found)))
    for place, ns in arrivals:
        inputs[place].signalMessage(stamped(ns))
    return sets


def test_equal_stamps_make_a_set_when_the_last_of_them_arrives():
    arrivals = [(0, 1), (0, 2), (1, 2), (1, 3), (0, 4), (1, 1), (0, 3)]
    assert feed(lambda fs: TimeSynchronizer(fs, 10), arrivals) == [(2, 2), (1, 1), (3, 3)]
    assert feed(lambda fs: TimeSynchronizer(fs, 1), [(0, 1), (0, 2), (1, 1), (1, 2)]) == [(2, 2)]


@pytest.mark.parametrize("seed", range(20))
def test_approximate_sets_are_those_of_a_search_of_all_pairs(seed):
    rng, slop, size = np.random.default_rng(seed), 30, 5
    arrivals = [(int(rng.integers(2)), int(ns)) for ns in rng.permutation(1000)[:200] * 2]
    waiting: tuple[list[int], list[int]] = ([], [])
    expected = []
    for place, ns in arrivals:
        own, other = waiting[place], waiting[1 - place]
        own.append(ns)
        if len(own) > size:
            own.remove(min(own))
        fits = [there for there in other if abs(there - ns) < slop]
        if ns in own and fits:
            nearest = min(fits, key=lambda there: (abs(there - ns), there))
            own.remove(ns)
            other.remove(nearest)
            expected.append((ns, nearest) if place == 0 else (nearest, ns))
    assert len(expected) > 5
    assert feed(lambda fs: ApproximateTimeSynchronizer(fs, size, slop * 1e-9), arrivals) == expected


def test_all_stamps_of_a_set_of_three_are_within_the_slop():
    def make(fs):
        return ApproximateTimeSynchronizer(fs, 10, 10e-9)

    assert feed(make, [(0, 0), (1, 16), (2, 8)], 3) == []
    assert feed(make, [(0, 0), (1, 16), (1, 10), (1, 9), (2, 8)], 3) == [(0, 9, 8)]


def test_a_cache_finds_messages_by_their_stamps():
    cache = Cache(cache_size=3)
    assert cache.getLast() is None and cache.getLatestTime() is None and cache.getOldestTime() is None
    assert cache.getElemAfterTime(Instant()) is None and cache.getElemBeforeTime(Instant()) is None
    messages = [stamped(ns) for ns in (10, 20, 30, 40)]
    for message in messages:
        cache.add(message)
    assert cache.getInterval(Instant(10), Time.from_nanoseconds(30)) == messages[1:3]
    assert cache.getElemAfterTime(Instant(25)) is messages[2] and cache.getElemBeforeTime(Instant(39)) is messages[2]
    assert cache.getElemBeforeTime(Instant(19)) is None and cache.getLast() is messages[3]
    assert (cache.getOldestTime(), cache.getLatestTime(), cache.getLastestTime()) == (Instant(20), Instant(40), Instant(40))


class Fusion(Node):
    def __init__(self) -> None:
        super().__init__("fusion")
        self.pairs: list[tuple[int, int]] = []
        self.odom = Subscriber(self, SameOdometry, "odom", qos_profile=10)
        self.cache = Cache(self.odom, 5)
        self.sync = ApproximateTimeSynchronizer([Subscriber(self, LaserScan, "scan"), self.cache], 10, 0.05)
        self.sync.registerCallback(self.fuse, "more")

    def fuse(self, scan, odometry, more) -> None:
        assert more == "more"
        self.pairs.append((scan.header.stamp.nanoseconds, odometry.header.stamp.nanoseconds))


def test_a_node_synchronizes_scans_with_odometry_and_repeats_after_a_restore():
    sim = small_room()
    node = sim.spawn(Fusion)
    sim.run_for(1.03)
    state, before, last = sim.save(), list(node.pairs), node.cache.getLast()
    assert len(before) > 5 and all(abs(scan - odom) <= 50_000_000 for scan, odom in before)
    futures = []
    for _ in range(2):
        sim.run_for(2.0)
        futures.append((list(node.pairs), node.cache.getLast()))
        sim.restore(state)
        assert node.pairs == before and node.cache.getLast() is last
    assert futures[0] == futures[1] and len(futures[0][0]) > len(before)
    node.odom.unsubscribe()
    last = node.cache.getLast()
    sim.run_for(1.0)
    assert node.cache.getLast() is last


def test_the_messages_that_wait_are_restored():
    sim, seen = small_room(), []
    node = sim.create_node("listener")
    inputs = [Subscriber(node, TwistStamped, topic) for topic in ("a", "b")]
    TimeSynchronizer(inputs, 10).registerCallback(lambda *found: seen.append(found))
    sim.publish("/a", stamped(7))
    sim.run_for(0.1)
    state = sim.save()
    for _ in range(2):
        sim.publish("/b", stamped(7))
        sim.run_for(0.1)
        sim.restore(state)
    assert len(seen) == 2


def test_a_message_without_a_header_has_the_time_of_its_arrival_if_that_is_allowed(caplog):
    sim = small_room()
    node = sim.create_node("listener")
    words = Subscriber(node, String, "words")
    strict, lenient = Cache(words, 3), Cache(words, 3, allow_headerless=True)
    sim.run_for(1.5)
    sim.publish("/words", String("a"))
    sim.run_for(0.1)
    assert strict.getLast() is None and lenient.getLatestTime() == Instant(seconds=1.5)
    assert "String has no header, so Cache drops it" in caplog.text


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Cache(cache_size=0), ValueError, "cache_size must be at least 1, got 0"),
        (lambda: TimeSynchronizer([], 1), ValueError, "must have inputs, got none"),
        (lambda: TimeSynchronizer([SimpleFilter()], 0), ValueError, "queue_size must be at least 1, got 0"),
        (lambda: ApproximateTimeSynchronizer([SimpleFilter()], 1, -0.1), ValueError, "slop must be at least 0 s"),
        (lambda: ApproximateTimeSynchronizer([SimpleFilter()], 1, float("nan")), ValueError, "slop must be at least 0 s"),
        (lambda: SimpleFilter().registerCallback(3), TypeError, "a callback must be callable, got 3"),
    ],
)
def test_bad_arguments_are_refused(make, error, message):
    with pytest.raises(error, match=message):
        make()


def test_the_classes_of_the_simulator_are_the_ones_to_filter():
    assert SameOdometry is Odometry and LaserScan is mrs.messages.LaserScan
