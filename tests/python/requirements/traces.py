"""Traces of given values, for tests of formulas."""

from __future__ import annotations

from typing import Any

import numpy as np

from mobile_robot_simulator.requirements import Signal


class GivenTrace:
    """Has the times and the values that a test chooses."""

    def __init__(self, times: Any, **values: Any) -> None:
        self.times = np.asarray(times, np.float64)
        self.values = {name: np.asarray(array, np.float64) for name, array in values.items()}


def given(name: str) -> Signal:
    """Returns the signal of a value of a `GivenTrace`."""
    return Signal(name, "m", lambda trace: trace.values[name])
