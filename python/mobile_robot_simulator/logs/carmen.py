"""CARMEN logs: text files of robots of the years around 2000, one message a line."""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from .._core import Pose
from ..nodes.rigid_transform import RigidTransform
from ..quoting import quoted
from ..user_files import open_regular
from .scan_log import ScanLog, ScanRow, nanoseconds
from .track import Track

LONGEST_LINE = 2**20
"""Largest number of bytes of a line. A scan of 1,000 beams has less than a hundredth."""

MOST_BEAMS = 100_000
"""Largest number of readings of a scan."""

OLD_MAX_RANGE = 80.0
"""Largest range of the scanner of a line without one [m], as in CARMEN's reader: that of a SICK LMS."""

_GZIP = b"\x1f\x8b"
_OLD = ("FLASER", "RLASER", "LASER3", "LASER4", "LASER5")
_NEW = tuple(f"{kind}{number}" for kind in ("ROBOTLASER", "RAWLASER") for number in range(1, 6))
SCANS = ("FLASER", "ROBOTLASER1", *(kind for kind in (*_OLD, *_NEW) if kind not in ("FLASER", "ROBOTLASER1")))
"""Words that begin a line with a scan. The first one that a log has is read unless another one is asked for."""

_OLD_SPACING = {180: 1.0, 181: 1.0, 360: 0.5, 361: 0.5, 400: 0.25, 401: 0.25}


@dataclass(frozen=True)
class _Scan:
    """A scan as its line has it. Without a pose, the pose is that of the odometry at its stamp."""

    line: int
    stamp: int
    start: float
    spacing: float
    max_range: float
    ranges: NDArray[np.float32]
    pose: tuple[float, float, float] | None


def read_carmen(path: Path, *, scanner: str | None = None, max_range: float | None = None) -> ScanLog:
    """Returns the scans of a CARMEN log, also one packed by gzip.

    A line FLASER, RLASER or ROBOTLASER has the pose of its scanner; in logs with corrected poses, the corrected one.
    LASER and RAWLASER have none; theirs is the robot's, from the lines ODOM around them. FLASER, RLASER and LASER do not
    say where their beams point. As in CARMEN, the first is at -90°, and 180 or 181 beams are 1° apart, 360 or 361 are 0.5°,
    400 or 401 are 0.25°; others fill 180°. Readings from `max_range` on are beams without a return.

    Args:
        path: The log.
        scanner: Word that begins the lines to read. Without it, the first one of `SCANS` that the log has.
        max_range: Largest range [m]. Without it, that of the lines, or `OLD_MAX_RANGE` for old ones.

    Raises:
        OSError: The file cannot be read.
        ValueError: The log has no such scan, or a line is malformed; the message gives the line.
    """
    scans: dict[str, list[_Scan]] = {}
    odometry = Track()
    notes: list[str] = []
    for number, words, is_last, is_cut in _lines(path, notes):
        kind, where = words[0], f"{path}, line {number}"
        if kind not in SCANS and kind != "ODOM":
            continue
        try:
            line = _Line(words, where, complete=not is_cut)
            if kind == "ODOM":
                x, y, yaw, _, _, _ = line.numbers(6)
                odometry.add(nanoseconds(line.number(), where), _in_space((x, y, yaw), where))
            else:
                scan = _old(line, number) if kind in _OLD else _new(line, number)
                scans.setdefault(kind, []).append(scan)
        except _Truncated as error:
            if not is_last:
                raise ValueError(str(error)) from None
            notes.append(f"line {number}, the last one, is cut off and was passed over")
    kind = _chosen(path, scans, scanner)
    if len(scans) > 1:
        others = ", ".join(f"{len(scans[other])} {other}" for other in scans if other != kind)
        notes.append(f"scans of other scanners were passed over: {others}")
    return _log(path, scans[kind], odometry, max_range, notes)


def _chosen(path: Path, scans: dict[str, list[_Scan]], wanted: str | None) -> str:
    kind = next((kind for kind in SCANS if kind in scans), None) if wanted is None else wanted
    if kind not in scans:
        needed = f"lines that begin with {wanted}" if wanted is not None else f"a scan ({', '.join(SCANS[:2])}, ...)"
        raise ValueError(f"{path}: must have {needed}, got {', '.join(scans) or 'none'}")
    return kind


def _log(path: Path, scans: list[_Scan], odometry: Track, max_range: float | None, notes: list[str]) -> ScanLog:
    first = scans[0]
    shape = (len(first.ranges), first.start, first.spacing)
    rows, others, without = [], [], []
    for scan in scans:
        if (len(scan.ranges), scan.start, scan.spacing) != shape:
            others.append(scan.line)
            continue
        pose: Sequence[float] | None = scan.pose
        if pose is None:
            space = odometry.at(scan.stamp, moving=True)
            if space is None:
                without.append(scan.line)
                continue
            (x, y, _), (_, _, qz) = space.translation, space.vector
            pose = tuple(Pose.from_quaternion(x, y, qx=0.0, qy=0.0, qz=qz, qw=space.w))
        rows.append(ScanRow(scan.line, scan.stamp, pose, scan.ranges))
    if others:
        count = f"{len(others)} scans with other beams than the first one were passed over"
        notes.append(f"{count}, the first in line {others[0]}")
    if without:
        notes.append(f"{len(without)} scans without odometry around them were passed over, the first in line {without[0]}")
    if not rows:
        raise ValueError(f"{path}: no scan has a pose: there must be lines ODOM around line {first.line}")
    backwards = next((b.place for a, b in pairwise(rows) if b.stamp < a.stamp), None)
    if backwards is not None:
        notes.append(f"stamps go back, first in line {backwards}")
    angles = np.array(first.start + first.spacing * np.arange(shape[0]), np.float64)
    limits = (0.0, first.max_range if max_range is None else max_range)
    return ScanLog.from_rows(path, rows, angles=angles, limits=limits, notes=notes)


class _Truncated(ValueError):
    """A line ends too early."""


class _Line:
    """The words of a line, taken one after another."""

    def __init__(self, words: list[str], where: str, *, complete: bool) -> None:
        # The last word of a line without an end may be cut.
        self._words, self._where, self._next = words if complete else words[:-1], where, 1
        self.kind = words[0]

    def take(self, count: int) -> list[str]:
        """Returns the next words."""
        start, self._next = self._next, self._next + count
        if self._next > len(self._words):
            raise _Truncated(f"{self._where}: must have at least {self._next} words, got {len(self._words)}")
        return self._words[start : self._next]

    def numbers(self, count: int) -> list[float]:
        """Returns the next words as numbers."""
        words = self.take(count)
        try:
            return [float(word) for word in words]
        except ValueError:
            first = self._next - count
        for position, word in enumerate(words, first + 1):
            try:
                float(word)
            except ValueError:
                raise ValueError(f"{self._where}, word {position}: must be a number, got {quoted(word)}") from None
        raise AssertionError

    def number(self) -> float:
        """Returns the next word as a number."""
        return self.numbers(1)[0]

    def count(self) -> int:
        """Returns the next word as a number of readings."""
        word = self.take(1)[0]
        if not (word.isascii() and word.isdigit()) or len(word) > 9 or int(word) > MOST_BEAMS:
            needed = f"a number of readings, at most {MOST_BEAMS}"
            raise ValueError(f"{self._where}, word {self._next}: must be {needed}, got {quoted(word)}")
        return int(word)

    def readings(self) -> NDArray[np.float32]:
        """Returns the ranges of a scan: their number, then the numbers."""
        count = self.count()
        if count == 0:
            raise ValueError(f"{self._where}: a scan must have at least one reading, got 0")
        return np.array(self.numbers(count), np.float32)

    def pose(self) -> tuple[float, float, float]:
        """Returns a pose: x, y [m], yaw [rad]."""
        x, y, yaw = self.numbers(3)
        if not all(map(math.isfinite, (x, y, yaw))):
            raise ValueError(f"{self._where}: a pose must be finite, got {x} {y} {yaw}")
        return x, y, yaw

    def stamp(self) -> int:
        """Returns a time [ns]."""
        return nanoseconds(self.number(), self._where)

    def error(self, text: str) -> ValueError:
        """Returns an error with the place of the line."""
        return ValueError(f"{self._where}: {text}")


def _old(line: _Line, number: int) -> _Scan:
    """FLASER count ranges... laser_pose robot_pose stamp host logger_stamp; LASER3 has no poses."""
    ranges = line.readings()
    pose = None
    if line.kind in ("FLASER", "RLASER"):
        pose = line.pose()
        line.pose()
    count = len(ranges)
    spacing = math.radians(_OLD_SPACING.get(count, 180.0 / max(count - 1, 1)))
    return _Scan(number, line.stamp(), -math.pi / 2, spacing, OLD_MAX_RANGE, ranges, pose)


def _new(line: _Line, number: int) -> _Scan:
    """ROBOTLASER1 type start fov spacing max_range accuracy remission_mode count ranges... count remissions... poses..."""
    _, start, fov, spacing, max_range, _, _ = line.numbers(7)
    ranges = line.readings()
    line.take(line.count())
    pose = None
    if line.kind.startswith("ROBOT"):
        pose = line.pose()
        line.pose()
        line.take(5)  # velocities, safety distances, turn axis
    if spacing == 0.0:
        spacing = fov / max(len(ranges) - 1, 1)
    if not all(map(math.isfinite, (start, spacing, max_range))) or max_range <= 0.0:
        raise line.error(f"must have finite angles and a max_range above 0, got {start}, {spacing}, {max_range}")
    return _Scan(number, line.stamp(), start, spacing, max_range, ranges, pose)


def _in_space(pose: tuple[float, float, float], where: str) -> RigidTransform:
    try:
        planar = Pose(*pose)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    z, w = planar.quaternion
    return RigidTransform((planar.x, planar.y, 0.0), (0.0, 0.0, z), w)


def _lines(path: Path, notes: list[str]) -> Iterator[tuple[int, list[str], bool, bool]]:
    """Yields number and words of each line that is not empty, whether it is the last one, and whether it has no end."""
    before: tuple[int, list[str], bool] | None = None
    with open_regular(path) as file:
        packed = file.read(2) == _GZIP
        file.seek(0)
        with gzip.open(file) if packed else file as text:
            for line in _lines_of(path, text, notes):
                if before is not None:
                    number, words, is_cut = before
                    yield number, words, False, is_cut
                before = line
    if before is not None:
        number, words, is_cut = before
        yield number, words, True, is_cut


def _lines_of(path: Path, file: BinaryIO | gzip.GzipFile, notes: list[str]) -> Iterator[tuple[int, list[str], bool]]:
    number = 0
    while True:
        try:
            line = file.readline(LONGEST_LINE)
        except EOFError:
            notes.append(f"the packed file is cut off after line {number}")
            return
        except (gzip.BadGzipFile, zlib.error) as error:
            raise ValueError(f"{path}, line {number + 1}: the packed file is damaged: {error}") from None
        if not line:
            return
        number += 1
        if len(line) == LONGEST_LINE:
            raise ValueError(f"{path}, line {number}: must have less than {LONGEST_LINE} bytes, got more")
        if words := line.decode("utf-8", "replace").split():
            yield number, words, not line.endswith((b"\n", b"\r"))
