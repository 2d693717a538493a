"""The bus in use: that of the running callback or of the node that is being created."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.current import current_bus, using


def test_the_bus_in_use_is_that_of_the_innermost_run_or_block(bus: Bus) -> None:
    other, seen = Bus(), list[object]()
    other.schedule(1, lambda: seen.append(current_bus()))
    bus.schedule(1, lambda: (other.run_until(2), seen.append(current_bus())))
    with using(other):
        bus.run_until(2)
        seen.append(current_bus())
    assert seen == [other, bus, other] and current_bus() is None


def test_an_error_in_a_callback_ends_the_use(bus: Bus) -> None:
    def fail() -> None:
        raise OSError("out of coffee")

    bus.schedule(1, fail)
    with pytest.raises(OSError, match="coffee"):
        bus.run_until(2)
    assert current_bus() is None
