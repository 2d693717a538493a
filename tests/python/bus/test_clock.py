"""The clock that nodes read."""

from __future__ import annotations

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.clock import BusClock
from mobile_robot_simulator.bus.node import BusNode, spawn_context


def test_the_clock_shows_simulated_time(bus: Bus, node: BusNode) -> None:
    assert node.get_clock().now().nanoseconds == 0
    bus.run_until(1_234_567_890)
    assert node.get_clock().now().nanoseconds == 1_234_567_890
    assert node.get_clock().now().to_msg() == mrs.messages.Time(1, 234_567_890)


def test_a_clock_without_a_bus_shows_the_time_of_the_bus_in_use(bus: Bus, node: BusNode) -> None:
    early, seen = BusClock(clock_type=1), list[int]()
    with pytest.raises(RuntimeError, match="the clock has no bus: make or call it in a node"):
        early.now()
    node.create_timer(1.0, lambda: seen.extend([early.now().nanoseconds, BusClock().now().nanoseconds]))
    bus.run_until(1_500_000_000)
    assert seen == [1_000_000_000] * 2 and early.now().nanoseconds == 1_500_000_000
    with spawn_context(Bus(), "/", {}):
        clock = BusClock()
    assert clock.now().nanoseconds == 0
    with pytest.raises(RuntimeError, match="no bus"):
        BusClock().now()


def test_the_clock_offset_moves_the_clock_but_not_the_bus(bus: Bus, node: BusNode) -> None:
    bus.run_until(5)
    bus.clock_offset_ns = 100
    assert (node.get_clock().now().nanoseconds, bus.time_ns) == (105, 5)
