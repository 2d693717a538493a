"""Estimation: rates of a space whose rate is known, and the same numbers for any number of processes."""

from __future__ import annotations

import math

import pytest

from falsification.turning import SPACE, GoesWhereItLooks, Stands, requirement
from mobile_robot_simulator.falsification import compare_controllers, estimate
from mobile_robot_simulator.falsification.intervals import clopper_pearson

SEED = 1
"""One seed in twenty gives an interval without the rate."""


def test_the_estimate_is_that_of_the_drives():
    found = estimate(GoesWhereItLooks, SPACE, requirement, 200, seed=SEED)
    assert found.drives == 200 and (found.low, found.high) == clopper_pearson(found.failures, 200, 0.95)
    # The robot fails if it looks at most 1 rad to the side: 2 of 6.282 rad.
    assert found.low < 2.0 / 6.282 < found.high
    assert str(found).startswith(f"{found.failures} of 200 drives failed: {found.rate:.2%}, 0.95 confidence interval ")


def test_it_stops_when_the_interval_is_narrow_enough():
    told = []
    found = estimate(
        GoesWhereItLooks, SPACE, requirement, 5000, width=0.3, seed=SEED, progress=lambda *counts: told.append(counts)
    )
    assert found.high - found.low <= 0.3 and 32 < found.drives < 1000 and found.drives % 32 == 0
    assert told[-1] == (found.drives, found.failures) and len(told) == found.drives
    assert found.low < 2.0 / 6.282 < found.high
    assert estimate(GoesWhereItLooks, SPACE, requirement, 64, width=0.01).drives == 64


@pytest.mark.slow
def test_the_number_of_processes_changes_nothing():
    first, second = (estimate(GoesWhereItLooks, SPACE, requirement, 100, processes=processes) for processes in (1, 2))
    assert first == second


def test_two_controllers_are_compared_in_the_same_worlds():
    found = compare_controllers(GoesWhereItLooks, Stands, SPACE, requirement, 60)
    alone = estimate(GoesWhereItLooks, SPACE, requirement, 60)
    assert (found.neither, found.only_first, found.only_second, found.both) == (60 - alone.failures, alone.failures, 0, 0)
    assert found.p_value == pytest.approx(2.0 * 0.5**alone.failures)
    turned = compare_controllers(Stands, GoesWhereItLooks, SPACE, requirement, 60)
    assert turned.only_second == alone.failures and turned.p_value == found.p_value
    same = compare_controllers(GoesWhereItLooks, GoesWhereItLooks, SPACE, requirement, 60)
    assert same.both == alone.failures and same.p_value == 1.0


@pytest.mark.parametrize("confidence", [0.0, 1.0, math.nan, -2.0])
def test_arguments_are_checked(confidence):
    with pytest.raises(ValueError, match="confidence must be between 0 and 1, got"):
        estimate(Stands, SPACE, requirement, 10, confidence=confidence)
    with pytest.raises(ValueError, match="width must be between 0 and 1, got"):
        estimate(Stands, SPACE, requirement, 10, width=confidence)
    with pytest.raises(ValueError, match="budget must be at least 1, got 0"):
        estimate(Stands, SPACE, requirement, 0)
    with pytest.raises(ValueError, match="budget must be at least 1, got 0"):
        compare_controllers(Stands, Stands, SPACE, requirement, 0)
