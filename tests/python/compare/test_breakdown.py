"""breakdown: worked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mobile_robot_simulator.compare.breakdown import Band, Breakdown, Place, bands, wrong_places
from mobile_robot_simulator.compare.residuals import Spread

VALUES = np.array([0.5, -0.25, np.nan, 0.125, 1.0], np.float32)


def test_bands_have_their_lower_limit_and_the_last_one_both() -> None:
    found = bands(VALUES, np.array([0.0, 1.0, 1.5, 1.5, 4.0], np.float32), (0.0, 1.0, 2.0, 3.0, 4.0))
    assert [(band.low, band.high, band.spread.count) for band in found] == [(0.0, 1.0, 1), (1.0, 2.0, 2), (3.0, 4.0, 1)]
    assert found[0].spread.median == 0.5 and found[1].spread.median == -0.0625


def test_what_has_no_place_in_a_band_is_in_none() -> None:
    assert bands(VALUES, np.full(5, np.nan, np.float32), (0.0, 1.0)) == []


def test_the_worst_places_come_first() -> None:
    ends = np.array([[0.1, 0.1], [0.4, 0.2], [-0.1, 0.1], [7.3, 7.4], [7.4, 7.4], [7.26, 7.26]])
    values = np.array([0.3, 0.1, 0.0, -0.5, -0.75, -0.25], np.float32)
    assert wrong_places(values, ends) == [Place(7.25, 7.25, 3, 3, -0.5), Place(0.25, 0.25, 2, 1, pytest.approx(0.3))]
    assert wrong_places(np.zeros(6, np.float32), ends) == []


def test_the_report_has_no_infinity_and_no_nan() -> None:
    nothing = Spread.of(np.full(2, np.nan, np.float32))
    report = Breakdown([Band(64.0, math.inf, Spread.of(VALUES))], [], [nothing], [Place(0.25, 0.25, 2, 1, 0.3)]).report()
    assert report["by_range"][0]["high"] is None and report["by_range"][0]["count"] == 4
    assert report["by_beam"] == [
        {"count": 0, "median": None, "mad": None, "within": {"0.05": None, "0.10": None, "0.20": None}}
    ]
    assert report["places"] == [{"x": 0.25, "y": 0.25, "count": 2, "wrong": 1, "median": 0.3}]
