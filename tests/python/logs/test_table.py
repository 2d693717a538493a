"""table: CSV files and NumPy archives."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mobile_robot_simulator.logs.table import read_csv, read_npz

CSV = "time,x,y,yaw,-0.5,0.5\n1.5,1,2,0.25,3,inf\n2.5,2,2,0.5,nan,4\n"
ARRAYS: dict[str, Any] = {
    "poses": [[1.0, 2.0, 0.25], [2.0, 2.0, 0.5]],
    "ranges": [[3.0, 9.0], [math.nan, 0.01]],
    "angles": [-0.5, 0.5],
    "stamps": [1.5, 2.5],
    "min_range": 0.1,
    "max_range": 9.0,
}


def csv(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "scans.csv"
    file.write_text(text)
    return file


def npz(tmp_path: Path, **changes: Any) -> Path:
    arrays = {name: value for name, value in {**ARRAYS, **changes}.items() if value is not None}
    np.savez(tmp_path / "scans.npz", **arrays)
    return tmp_path / "scans.npz"


def test_csv(tmp_path: Path) -> None:
    log = read_csv(csv(tmp_path, CSV), max_range=30.0)
    np.testing.assert_array_equal(log.ranges, np.array([[3, math.inf], [math.nan, 4]], np.float32))
    assert log.angles.tolist() == [-0.5, 0.5] and log.poses.tolist() == [[1, 2, 0.25], [2, 2, 0.5]]
    assert log.stamps.tolist() == [1_500_000_000, 2_500_000_000] and log.places.tolist() == [2, 3]
    assert log.notes == () and log.max_range == 30.0


def test_without_a_largest_range_every_finite_one_is_a_return(tmp_path: Path) -> None:
    log = read_csv(csv(tmp_path, CSV))
    assert log.ranges[1, 1] == 4.0 < log.max_range < 4.001
    assert log.notes == ("max_range is not given, so 4 m, just above the largest range, is assumed",)


@pytest.mark.parametrize("cut", ["3.5,1,2", "3.5,1,2,0,5\n"])
def test_a_csv_line_that_is_cut_off_at_the_end_is_passed_over(tmp_path: Path, cut: str) -> None:
    log = read_csv(csv(tmp_path, CSV + cut), max_range=30.0)
    assert len(log.ranges) == 2 and log.notes == ("line 4, the last one, is cut off and was passed over",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (CSV.replace("yaw", "theta"), "line 1: the columns must be time, x, y, yaw and the angle of each beam"),
        (CSV.replace("-0.5", "left"), "line 1, value 5: must be a number, got 'left'"),
        (CSV.replace("1.5,1,2", "1.5,1"), "line 2: must have 6 values, as the first line, got 5"),
        (CSV.replace("1.5,1,2", "1.5,nan,2"), "line 2: a pose must be finite"),
        (CSV.replace("nan", "x"), "line 3, value 5: must be a number, got 'x'"),
        (CSV.replace("2.5,2", "1e30,2"), "line 3: a stamp must be finite and below"),
        (
            CSV.replace("-0.5", "-90").replace(",0.5\n", ",45\n", 1),
            "angles of beams must be .* radians, got -90; -90° is -1.5708",
        ),
        ("", "must have a line with names and at least one scan, got no line"),
        (CSV[: CSV.index("1.5")], "must have a line with names and at least one scan, got the names only"),
        (CSV[: CSV.index(",inf")], r"scans\.csv, line 2: must have 6 values, as the first line, got 5"),
    ],
)
def test_malformed_csv(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_csv(csv(tmp_path, text))


def test_npz_marks_readings_as_scans_do(tmp_path: Path) -> None:
    log = read_npz(npz(tmp_path))
    np.testing.assert_array_equal(log.ranges, np.array([[3, math.inf], [math.nan, -math.inf]], np.float32))
    assert log.stamps.tolist() == [1_500_000_000, 2_500_000_000] and log.places.tolist() == [0, 1]
    assert (log.min_range, log.max_range, log.notes) == (0.1, 9.0, ())


def test_npz_with_angle_min_integer_stamps_or_none(tmp_path: Path) -> None:
    log = read_npz(npz(tmp_path, angles=None, angle_min=-1.0, angle_increment=0.25, stamps=[7, 9]))
    assert log.angles.tolist() == [-1.0, -0.75] and log.stamps.tolist() == [7, 9]
    log = read_npz(npz(tmp_path, stamps=None))
    assert log.stamps.tolist() == [0, 1_000_000_000] and log.notes == ("there are no stamps, so scan i is at i seconds",)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"poses": None}, "must have an array poses, got angles, max_range"),
        ({"poses": [[1.0, 2.0, 3.0]]}, r"poses must have shape \(N, 3\) and ranges \(N, B\), got \(1, 3\) and \(2, 2\)"),
        ({"poses": [[0, 0, 0], [0, math.inf, 0]]}, r"poses must be finite, got \[0.0, inf, 0.0\] at index 1"),
        ({"ranges": [["a", "b"]] * 2}, "ranges must be numbers in 2 dimensions, got <U1 in 2"),
        ({"angles": [1.0]}, r"angles must be 2 finite numbers, one for each range, got \(1,\)"),
        ({"stamps": [1.0]}, r"stamps must be 2 numbers, got float64 of shape \(1,\)"),
        ({"stamps": [1.0, math.nan]}, "stamps, index 1: a stamp must be finite"),
        ({"stamps": np.array([1, 2**63], np.uint64)}, "stamps must be below"),
        ({"max_range": -1.0}, "scans.npz: max_range must be"),
        (
            {"poses": np.array([{}, {}], dtype=object)},
            "scans.npz: must be an archive of NumPy arrays: Object arrays cannot be loaded",
        ),
    ],
)
def test_wrong_npz(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read_npz(npz(tmp_path, **changes))


def test_a_cut_archive_is_an_error(tmp_path: Path) -> None:
    file = npz(tmp_path)
    data = file.read_bytes()
    for length in range(0, len(data), 97):
        file.write_bytes(data[:length])
        with pytest.raises(ValueError, match=r"scans\.npz"):
            read_npz(file)


def test_a_damaged_archive_is_an_error_or_read(tmp_path: Path) -> None:
    """Flipped bytes lead to NotImplementedError, OSError and others in the libraries below."""
    file = npz(tmp_path)
    data = file.read_bytes()
    for place in range(0, len(data), 3):
        file.write_bytes(data[:place] + bytes([data[place] ^ 0x5A]) + data[place + 1 :])
        try:
            read_npz(file)
        except ValueError as error:
            assert str(file) in str(error)
