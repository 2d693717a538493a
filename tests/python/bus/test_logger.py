"""Loggers of nodes: Python's logging with the keywords of rclpy."""

from __future__ import annotations

import logging

import pytest

from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode


def test_a_node_logs_under_its_name(bus: Bus, caplog: pytest.LogCaptureFixture) -> None:
    node = BusNode(bus, "robot")
    node.get_logger().warning("low battery")
    assert node.get_name() == "robot"
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [("WARNING", "low battery")]
    assert "robot" in caplog.records[0].name


def test_once_and_throttle_limit_repeated_messages(bus: Bus, node: BusNode, caplog: pytest.LogCaptureFixture) -> None:
    logger = node.get_logger()
    with caplog.at_level(logging.INFO, logger="mobile_robot_simulator.tester"):
        for count in range(30):
            bus.run_until(count * 100_000_000)
            logger.info("once", once=True)
            logger.warn("slowly", throttle_duration_sec=1.0)
    assert caplog.messages.count("once") == 1 and caplog.messages.count("slowly") == 3
