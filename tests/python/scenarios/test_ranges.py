"""ranges: their limits; test_space.py gives all bad arguments and draws from good ones."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.scenarios import FaultRange, Free, Moving, Pushes, Range, Slips


def test_limits_must_be_numbers():
    with pytest.raises(TypeError, match="low must be a number, got '1'"):
        Range("1", 2)
    with pytest.raises(TypeError, match="chance must be a number"):
        FaultRange("Drop", chance=None)
    assert Range(2, 2).low == Range(2, 2).high == 2


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Moving(1, radius=Range(10, 30, "cm")), "radius must be in m, got cm"),
        (lambda: Moving(1, radius=Range(0.1, 0.3, "m/s")), "radius must be in m, got m/s"),
        (lambda: Moving(1, speed=Range(1, 3, "km/h")), "speed must be in m/s, got km/h"),
        (lambda: Free(yaw=Range(-90, 90, "deg")), "yaw must be in rad, got deg"),
        (lambda: FaultRange("Blackout", duration=Range(1, 2, "ms")), "duration must be in s, got ms"),
        (lambda: FaultRange("Blackout", {"start": Range(1, 2, "ms")}), "start must be in s, got ms"),
        (lambda: FaultRange("Blackout", {"end": Range(1, 2, "min")}), "end must be in s, got min"),
        (lambda: Pushes(1, start=Range(1, 2, "ms")), "start must be in s, got ms"),
        (lambda: Pushes(1, duration=Range(1, 2, "ms")), "duration must be in s, got ms"),
        (lambda: Pushes(1, speed=Range(1, 2, "cm/s")), "speed must be in m/s, got cm/s"),
        (lambda: Pushes(1, direction=Range(0, 90, "°")), "direction must be in rad, got °"),
        (lambda: Slips(1, share=Range(0.1, 0.5, "%")), "share must have no unit, got %"),
    ],
)
def test_units_must_fit(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_unit_need_not_be_said():
    assert Moving(1, radius=Range(0.1, 0.3), speed=Range(0.0, 1.0)).radius.unit == ""
    assert Pushes(1, start=Range(0, 1), speed=Range(0.1, 0.2), direction=Range(0, 1)).speed.unit == ""
