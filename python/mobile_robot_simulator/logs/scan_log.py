"""ScanLog: the scans of a log and where each was taken, whatever the format of the log."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .._core import LaserScanner
from ..quoting import quoted_angle

TURN = math.tau + 0.01
"""Largest angle between two beams, and between a beam and straight ahead [rad]: one turn, and room for rounding."""


@dataclass(frozen=True)
class ScanLog:
    """The scans of a log and where each was taken.

    Attributes:
        path: The log.
        stamps: (N,) int64, times of the scans [ns], in the order of the log.
        angles: (B,) float64, directions of the beams in the scanner's frame, counter-clockwise [rad].
        ranges: (N, B) float32 [m]. As in REP-117, +inf is a beam without a return, -inf a return nearer than `min_range`,
            and NaN a failed measurement.
        poses: (N, 3) float64, poses of the scanner in `frame`: x, y [m], yaw [rad].
        frame: Name of the frame of the poses. CARMEN and tables name none; theirs is "map".
        min_range: Smallest valid range [m].
        max_range: Range from which on a beam has no return [m].
        places: (N,) int64, where each scan stands in the log: its line (from 1), or its index (from 0) among the messages of
            its topic or the rows of its arrays.
        notes: What was passed over, or assumed because the log does not say it.
    """

    path: Path
    stamps: NDArray[np.int64]
    angles: NDArray[np.float64]
    ranges: NDArray[np.float32]
    poses: NDArray[np.float64]
    frame: str
    min_range: float
    max_range: float
    places: NDArray[np.int64]
    notes: tuple[str, ...]

    @classmethod
    def from_rows(
        cls,
        path: Path,
        rows: Sequence[ScanRow],
        *,
        angles: NDArray[np.float64],
        limits: tuple[float, float],
        frame: str = "map",
        notes: Sequence[str] = (),
    ) -> ScanLog:
        """Returns the log with these scans, in their order. Its readings are marked as in REP-117.

        Args:
            path: The log.
            rows: The scans, at least one, each with a range for each angle.
            angles: (B,) float64, directions of the beams [rad].
            limits: Smallest and largest valid range [m].
            frame: Frame of the poses.
            notes: What was passed over or assumed.

        Raises:
            ValueError: The limits are no limits of a scanner, or the angles go beyond one turn, as degrees do.
        """
        _check_angles(path, angles)
        try:
            scanner = LaserScanner(beam_count=len(angles), min_range=limits[0], max_range=limits[1])
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        return cls(
            path,
            np.array([row.stamp for row in rows], np.int64),
            np.array(angles, np.float64),
            scanner.mark_invalid(np.array([row.ranges for row in rows], np.float32)),
            np.array([row.pose for row in rows], np.float64).reshape(-1, 3),
            frame,
            limits[0],
            limits[1],
            np.array([row.place for row in rows], np.int64),
            tuple(notes),
        )


def _check_angles(path: Path, angles: NDArray[np.float64]) -> None:
    largest = float(angles[np.argmax(np.abs(angles))])
    if not abs(largest) <= TURN:
        raise ValueError(f"{path}: the angles of beams must be in [-2π, 2π] radians, got {quoted_angle(largest)}")
    fov = float(np.ptp(angles))
    if fov > TURN:
        raise ValueError(f"{path}: the beams must be within one turn, 2π radians, got {quoted_angle(fov)}")


@dataclass(frozen=True)
class ScanRow:
    """One scan of a log.

    Attributes:
        place: Where it stands in the log, as `ScanLog.places`.
        stamp: Its time [ns].
        pose: Pose of the scanner: x, y [m], yaw [rad].
        ranges: (B,) float32, its readings [m].
    """

    place: int
    stamp: int
    pose: Sequence[float]
    ranges: NDArray[np.float32]


LATEST = 2**62
"""Stamps are below this one [ns]."""


def nanoseconds(seconds: float, where: str) -> int:
    """Returns a time in nanoseconds.

    Args:
        seconds: The time [s].
        where: Place in the log, for the message of an error.

    Raises:
        ValueError: The time is not finite, or too large for an int64.
    """
    if not math.isfinite(seconds) or abs(seconds) * 1e9 >= LATEST:
        raise ValueError(f"{where}: a stamp must be finite and below {LATEST / 1e9:g} s, got {seconds}")
    return round(seconds * 1e9)
