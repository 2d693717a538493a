"""limits: each axis is limited separately, first its acceleration and then its velocity."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

import mobile_robot_simulator as mrs

LIMITS = mrs.Limits(velocity=(1.0, 0.0, 2.0), acceleration=(0.5, 1.0, math.inf), deceleration=(2.0, 1.0, 4.0))


def test_each_axis_has_its_own_limits() -> None:
    assert LIMITS.apply((1.0, 1.0, 9.0), (0.0, 0.0, 0.0), 0.5) == (0.25, 0.0, 2.0)
    assert LIMITS.apply((-1.0, 0.0, 0.0), (0.5, 0.0, 0.0), 1.0) == (-0.375, 0.0, 0.0)
    assert mrs.Limits().apply((7.0, -3.0, 9.0), (-7.0, 0.0, 0.0), 1e-9) == (7.0, -3.0, 9.0)


def test_copies_are_equal() -> None:
    assert pickle.loads(pickle.dumps(LIMITS)) == LIMITS != mrs.Limits()
    assert LIMITS.velocity == (1.0, 0.0, 2.0)
    assert mrs.Limits().deceleration == (math.inf,) * 3
    assert eval(repr(LIMITS), {"Limits": mrs.Limits, "inf": math.inf}) == LIMITS


def test_invalid_limits_are_rejected() -> None:
    with pytest.raises(ValueError, match="velocity must be at least 0 or inf, got -1"):
        mrs.Limits(velocity=(1.0, -1.0, 1.0))
    with pytest.raises(ValueError, match="wanted must be finite, got NaN"):
        LIMITS.apply((math.nan, 0.0, 0.0), (0.0, 0.0, 0.0), 0.1)


def test_a_trace_has_the_poses_of_integrate() -> None:
    limits, start = mrs.Limits(acceleration=(0.5, 0.5, 2.0), deceleration=(1.0, 1.0, 3.0)), mrs.Pose(1.0, 2.0, 3.0)
    wanted, current, times = (1.0, -0.3, 1.5), (-0.4, 0.2, -0.5), np.linspace(0.0, 5.0, 40)
    for grip in (1.0, 0.3):
        trace = limits.trace(start, wanted, current, times, grip=grip)
        expected = [tuple(limits.integrate(start, wanted, current, time, grip=grip)) for time in times]
        assert np.array_equal(trace, expected)
    with pytest.raises(ValueError, match=r"^times must be at least 0, got -1"):
        limits.trace(start, wanted, current, [-1.0])
