"""carmen: lines of each kind, their quirks, and logs that are cut or malformed."""

from __future__ import annotations

import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from mobile_robot_simulator.logs import ScanLog
from mobile_robot_simulator.logs.carmen import LONGEST_LINE, read_carmen

REAL_LOG = Path(__file__).parents[3] / ".." / "shared" / "logs" / "intel_piece.log"

FLASER = "FLASER 3 1.0 2.5 81.83 1 2 0.5 1.1 2.1 0.6 1230.8 host 1230.9"
ROBOTLASER = "ROBOTLASER1 4 -0.5 1.0 0.25 20 0.01 0 3 1.0 20 nan 2 7 8 1 2 0.5 1.1 2.1 0.6 0.3 0.1 0 0 0 12.5 host 0.1"
HEADER = "# message formats defined: PARAM SYNC ODOM FLASER\nPARAM robot_frontlaser_offset 0.0 nohost 0\n"


def read(tmp_path: Path, *lines: str, end: str = "\n", **options: object) -> ScanLog:
    file = tmp_path / "some.log"
    file.write_bytes((HEADER + "\n".join(lines) + end).encode())
    return read_carmen(file, **options)  # type: ignore[arg-type]


def test_an_old_line_has_three_beams_the_pose_of_the_laser_and_80_m(tmp_path: Path) -> None:
    log = read(tmp_path, FLASER)
    assert log.ranges.tolist() == [[1.0, 2.5, math.inf]] and log.ranges.dtype == np.float32
    assert log.poses.tolist() == [[1.0, 2.0, 0.5]]
    assert log.stamps.tolist() == [1_230_800_000_000] and log.places.tolist() == [3]
    np.testing.assert_allclose(log.angles, np.radians([-90, 0, 90]), atol=1e-15)
    assert (log.min_range, log.max_range, log.frame, log.notes) == (0.0, 80.0, "map", ())


@pytest.mark.parametrize(
    ("count", "last"), [(180, 89.0), (181, 90.0), (360, 89.5), (361, 90.0), (400, 9.75), (401, 10.0), (91, 90.0)]
)
def test_beams_of_old_lines_are_spaced_as_in_carmen(tmp_path: Path, count: int, last: float) -> None:
    log = read(tmp_path, f"FLASER {count} {'1 ' * count} 0 0 0 0 0 0 1.0 host 1.0")
    np.testing.assert_allclose(np.degrees(log.angles[[0, -1]]), [-90.0, last], atol=1e-12)


def test_a_new_line_says_its_beams_and_its_range(tmp_path: Path) -> None:
    log = read(tmp_path, ROBOTLASER)
    np.testing.assert_array_equal(log.ranges, np.array([[1.0, math.inf, math.nan]], np.float32))
    assert log.angles.tolist() == [-0.5, -0.25, 0.0] and log.max_range == 20.0
    assert log.poses.tolist() == [[1.0, 2.0, 0.5]] and log.stamps.tolist() == [12_500_000_000]


def test_a_new_line_without_spacing_fills_its_field(tmp_path: Path) -> None:
    assert read(tmp_path, ROBOTLASER.replace("1.0 0.25 20", "1.0 0.0 20")).angles.tolist() == [-0.5, 0.0, 0.5]


def test_a_raw_line_takes_its_pose_from_the_odometry_around_it(tmp_path: Path) -> None:
    raw = "RAWLASER1 0 -0.5 1.0 0.5 20 0.01 0 3 1 2 3 0 {} host 0.1"
    odometry = ["ODOM 0 0 0 0 0 0 10.0 host 0", "ODOM 2 0 1 0 0 0 10.5 host 0"]
    log = read(tmp_path, odometry[0], raw.format(10.25), odometry[1], raw.format(99.0))
    np.testing.assert_allclose(log.poses, [[1.0, 0.0, 0.5]], atol=1e-12)
    assert log.notes == ("1 scans without odometry around them were passed over, the first in line 6",)


def test_one_kind_of_scans_is_read_and_others_are_said(tmp_path: Path) -> None:
    lines = [ROBOTLASER, FLASER, FLASER.replace("FLASER", "RLASER")]
    log = read(tmp_path, *lines)
    assert log.places.tolist() == [4] and log.notes == ("scans of other scanners were passed over: 1 ROBOTLASER1, 1 RLASER",)
    assert read(tmp_path, *lines, scanner="ROBOTLASER1").places.tolist() == [3]


def test_scans_with_other_beams_and_stamps_that_go_back_are_said(tmp_path: Path) -> None:
    other = "FLASER 2 1.0 2.5 1 2 0.5 1.1 2.1 0.6 1231 host 1231"
    log = read(tmp_path, FLASER, other, FLASER.replace("1230.8", "1230.0"))
    assert log.places.tolist() == [3, 5]
    assert log.notes == (
        "1 scans with other beams than the first one were passed over, the first in line 4",
        "stamps go back, first in line 5",
    )


@pytest.mark.parametrize("line", [FLASER, ROBOTLASER])
def test_a_last_line_cut_anywhere_is_passed_over_or_whole(tmp_path: Path, line: str) -> None:
    whole = read(tmp_path, line)
    for length in range(len(line)):
        log = read(tmp_path, line, line[:length], end="")
        if len(log.ranges) == 2:
            assert log.ranges[1].tobytes() == whole.ranges[0].tobytes()
            assert log.stamps.tolist() == [whole.stamps[0]] * 2 and log.poses.tolist() == [*whole.poses.tolist()] * 2
        elif length > len("ROBOTLASER1"):
            assert log.notes == ("line 4, the last one, is cut off and was passed over",)


def test_a_log_whose_only_scan_is_cut_off_has_none(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must have a scan \(FLASER, ROBOTLASER1, \.\.\.\), got none"):
        read(tmp_path, FLASER[:20], end="")


def test_a_short_line_before_the_last_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"some\.log, line 3: must have at least 5 words, got 3"):
        read(tmp_path, "FLASER 3 1.0", FLASER)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (FLASER.replace("2.5", "x"), "line 3, word 4: must be a number, got 'x'"),
        (FLASER.replace("R 3", "R -3"), "line 3, word 2: must be a number of readings, at most 100000, got '-3'"),
        (FLASER.replace("R 3", "R 999999999999"), "must be a number of readings"),
        (FLASER.replace(" 1 2 0.5", " 1 nan 0.5"), "line 3: a pose must be finite, got 1.0 nan 0.5"),
        (FLASER.replace("1230.8", "inf"), "line 3: a stamp must be finite"),
        ("FLASER 0 1 2 0.5 1.1 2.1 0.6 1231 host 1231", "line 3: a scan must have at least one reading, got 0"),
        (ROBOTLASER.replace(" 20 0.01", " 0 0.01"), "line 3: must have finite angles and a max_range above 0"),
        ("ODOM 1 2 3 0 0 0 5.0 host 0", r"must have a scan \(FLASER, ROBOTLASER1, ...\), got none"),
    ],
)
def test_malformed_lines(tmp_path: Path, line: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read(tmp_path, line, line)


def test_a_line_without_an_end_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=f"line 3: must have less than {LONGEST_LINE} bytes, got more"):
        read(tmp_path, "1 " * LONGEST_LINE)


def test_a_packed_log_reads_the_same_and_says_if_it_is_cut(tmp_path: Path) -> None:
    file = tmp_path / "some.log.gz"
    lines = [FLASER.replace("1.0", str(number)) for number in range(300)]
    packed = gzip.compress("\n".join([*lines, ""]).encode(), 1)
    file.write_bytes(packed)
    assert read_carmen(file).ranges[:, 0].tolist() == [*map(float, range(80)), *[math.inf] * 220]
    file.write_bytes(packed[:-30])
    cut = read_carmen(file)
    assert 1 <= len(cut.ranges) < 300 and any("cut off" in note for note in cut.notes)


@pytest.mark.skipif(not REAL_LOG.is_file(), reason="real logs are not part of the repository: put them into ../shared/logs/")
def test_a_real_log() -> None:
    log = read_carmen(REAL_LOG)
    assert log.ranges.shape == (160, 180) and log.notes == ()
    assert log.ranges[0, :3].tolist() == np.array([0.87, 0.87, 0.87], np.float32).tolist()
    assert log.poses[0].tolist() == [14.5063, -19.1851, 3.03431] and log.stamps[0] == 1_230_800_000_000
    assert np.isinf(log.ranges).any() and log.ranges[np.isfinite(log.ranges)].max() < 80.0
