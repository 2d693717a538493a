"""The clock that nodes read."""

from __future__ import annotations

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode


def test_the_clock_shows_simulated_time(bus: Bus, node: BusNode) -> None:
    assert node.get_clock().now().nanoseconds == 0
    bus.run_until(1_234_567_890)
    assert node.get_clock().now().nanoseconds == 1_234_567_890
    assert node.get_clock().now().to_msg() == mrs.messages.Time(1, 234_567_890)


def test_the_clock_offset_moves_the_clock_but_not_the_bus(bus: Bus, node: BusNode) -> None:
    bus.run_until(5)
    bus.clock_offset_ns = 100
    assert (node.get_clock().now().nanoseconds, bus.time_ns) == (105, 5)
