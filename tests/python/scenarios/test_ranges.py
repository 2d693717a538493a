"""ranges: their limits; test_space.py gives all bad arguments and draws from good ones."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.scenarios import FaultRange, Range


def test_limits_must_be_numbers():
    with pytest.raises(TypeError, match="low must be a number, got '1'"):
        Range("1", 2)
    with pytest.raises(TypeError, match="chance must be a number"):
        FaultRange("Drop", chance=None)
    assert Range(2, 2).low == Range(2, 2).high == 2
