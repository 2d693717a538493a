"""Pace: simulated time that is due at a wall time."""

import pytest

from mobile_robot_simulator.live.pace import GRAIN_NS, LONGEST_TURN, Pace


def test_whole_grains_are_due_and_the_rest_stays_owed():
    pace = Pace(1.0)
    assert pace.due_ns(10.0) == 0
    dues = [pace.due_ns(10.0 + 0.0173 * turn) for turn in range(1, 101)]
    assert all(due % GRAIN_NS == 0 for due in dues)
    assert 1.73e9 - GRAIN_NS <= sum(dues) <= 1.73e9


def test_the_speed_factor_multiplies():
    pace = Pace(50.0)
    pace.due_ns(0.0)
    assert pace.due_ns(0.02) == pytest.approx(1e9)


def test_time_that_stands_is_not_made_up_for():
    pace = Pace(1.0, paused=True)
    pace.due_ns(0.0)
    assert pace.due_ns(0.05) == 0
    pace.paused = False
    assert pace.due_ns(0.06) == pytest.approx(10e6, abs=GRAIN_NS)


def test_a_machine_that_is_too_slow_falls_behind():
    pace = Pace(1.0)
    pace.due_ns(0.0)
    assert pace.due_ns(5.0) == LONGEST_TURN * 1e9


def test_the_rate_is_measured_over_the_last_seconds():
    pace = Pace(1.0)
    assert pace.rate == 0.0
    for turn in range(200):
        pace.note(turn * 0.05, round(turn * 0.05 * 2e9 if turn > 100 else 0))
    assert pace.rate == pytest.approx(2.0, rel=1e-6)
    pace.note(10.05, 0)  # a state was restored
    pace.note(10.10, round(0.05e9))
    assert pace.rate == pytest.approx(1.0, rel=1e-6)
