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


def test_seconds_become_nanoseconds() -> None:
    assert nanoseconds(1.5, "here") == 1_500_000_000
    for wrong in (math.nan, math.inf, 1e12):
        with pytest.raises(ValueError, match="here: a stamp must be finite"):
            nanoseconds(wrong, "here")
