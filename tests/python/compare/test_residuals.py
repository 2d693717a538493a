"""residuals: worked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mobile_robot_simulator.compare import Residuals, Spread

INF, NAN = math.inf, math.nan
READINGS = np.array([[1.0, 2.5, INF, INF], [-INF, NAN, 3.0, 7.0]], np.float32)
SIMULATED = np.array([[1.25, 2.0, 3.0, 9.0], [1.0, 1.0, 9.0, 4.0]], np.float32)


def test_every_beam_is_counted_once() -> None:
    residuals = Residuals(READINGS, SIMULATED, 9.0)
    np.testing.assert_array_equal(residuals.values, np.array([[-0.25, 0.5, NAN, NAN], [NAN, NAN, NAN, 3.0]], np.float32))
    assert residuals.counts == {"both": 3, "log_only": 1, "simulation_only": 1, "none": 1, "near": 1, "failed": 1}


def test_spread() -> None:
    values = np.array([-0.25, 0.0625, NAN, 0.125, 0.15625, 3.0], np.float32)
    spread = Spread.of(values)
    assert (spread.count, spread.median, spread.mad) == (5, 0.125, 0.0625)
    assert spread.within == {0.05: 0.0, 0.1: 0.2, 0.2: 0.6}


def test_nothing_has_no_spread() -> None:
    spread = Spread.of(np.full(3, NAN, np.float32))
    assert spread.count == 0 and math.isnan(spread.median) and math.isnan(spread.mad) and math.isnan(spread.within[0.05])


def test_histogram() -> None:
    residuals = Residuals(np.array([[1.0, 1.125, 1.255, 9.0]], np.float32), np.ones((1, 4), np.float32), 10.0)
    edges, counts = residuals.histogram()
    assert len(edges) == len(counts) + 1 and edges[0] == -0.5 and edges[-1] == 0.5
    assert {round(edges[k], 2): counts[k] for k in np.flatnonzero(counts)} == pytest.approx({0.0: 1, 0.12: 1, 0.25: 1})
