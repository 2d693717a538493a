"""scan_log: rows put together."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from mobile_robot_simulator.logs.scan_log import ScanLog, ScanRow, nanoseconds


def test_rows_become_arrays_with_marked_readings() -> None:
    row = ScanRow(7, 5, (1.0, 2.0, 3.0), np.array([0.1, 2.0, 9.0, math.nan], np.float32))
    log = ScanLog.from_rows(Path("log"), [row], angles=np.arange(4.0), limits=(0.5, 9.0), notes=["a"])
    np.testing.assert_array_equal(log.ranges, np.array([[-math.inf, 2.0, math.inf, math.nan]], np.float32))
    assert (log.stamps.dtype, log.places.dtype, log.poses.dtype) == (np.int64, np.int64, np.float64)
    assert log.notes == ("a",) and log.places.tolist() == [7]


def of_angles(*angles: float) -> ScanLog:
    rows = [ScanRow(0, 0, (0.0, 0.0, 0.0), np.ones(len(angles), np.float32))]
    return ScanLog.from_rows(Path("log"), rows, angles=np.array(angles), limits=(0.0, 9.0))


@pytest.mark.parametrize("angles", [(-90.0, 0.0, 45.0), (-90.0, 90.0), (0.0, 7.0), (-4.0, 4.0), (math.nan,)])
def test_angles_beyond_one_turn_are_refused(angles: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match=r"log: the (angles of beams|beams) must be .* radians, got "):
        of_angles(*angles)


def test_degrees_are_shown_in_radians() -> None:
    with pytest.raises(ValueError, match=r"in \[-2π, 2π\] radians, got 270; 270° is 4.7124 rad"):
        of_angles(0.0, 270.0)
    with pytest.raises(ValueError, match=r"within one turn, 2π radians, got 10; 10° is 0.1745 rad"):
        of_angles(-5.0, 5.0)


@pytest.mark.parametrize("angles", [(-math.pi, math.pi), (0.0, math.tau), (-math.tau, 0.0), (-math.pi, 3.1416), (1.0,)])
def test_beams_all_around_are_accepted(angles: tuple[float, ...]) -> None:
    assert of_angles(*angles).angles.tolist() == list(angles)


def test_seconds_become_nanoseconds() -> None:
    assert nanoseconds(1.5, "here") == 1_500_000_000
    for wrong in (math.nan, math.inf, 1e12):
        with pytest.raises(ValueError, match="here: a stamp must be finite"):
            nanoseconds(wrong, "here")
