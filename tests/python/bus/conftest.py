"""Fixtures for tests of the bus."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode, NoCopyNode


@pytest.fixture
def bus() -> Bus:
    return Bus()


@pytest.fixture
def node(bus: Bus) -> BusNode:
    return NoCopyNode(bus, "tester")
