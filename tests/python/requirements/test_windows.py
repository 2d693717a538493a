"""windows: the extremes of windows of every size equal those of plain slices."""

from __future__ import annotations

import numpy as np
import pytest

from mobile_robot_simulator.requirements.windows import Window, largest, smallest, smallest_until

SEED = 3


@pytest.mark.parametrize("count", [1, 2, 3, 7, 8, 9, 64, 65])
def test_windows_of_every_size(count):
    values, other = np.random.default_rng(SEED).normal(size=(2, count))
    times = np.arange(float(count))
    for start in range(count + 1):
        for end in range(start, count + 2):
            parts = [values[index + start : index + end + 1] for index in range(count)]
            window = Window(float(start), float(end))
            assert smallest(values, times, window).tolist() == [part.min(initial=np.inf) for part in parts]
            assert largest(values, times, window).tolist() == [part.max(initial=-np.inf) for part in parts]
            if count < 10:
                expected = [
                    max(
                        (
                            min(other[last], values[index : last + 1].min())
                            for last in range(index + start, min(index + end + 1, count))
                        ),
                        default=-np.inf,
                    )
                    for index in range(count)
                ]
                assert smallest_until(values, other, times, window).tolist() == expected


def test_no_values():
    assert smallest(np.zeros(0), np.zeros(0), Window(0.0, 1.0)).size == 0
