"""Tables: poses and ranges in a CSV file or in an archive of NumPy arrays."""

from __future__ import annotations

import csv
import io
import math
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted, shortened
from ..user_files import open_regular, read_text
from .scan_log import LATEST, ScanLog, ScanRow, nanoseconds

COLUMNS = ("time", "x", "y", "yaw")
"""First columns of a CSV file: time [s], pose of the scanner [m, m, rad]. Each of the others is a beam."""

LARGEST_FILE = 2**30
"""Largest size of a CSV file, and of the arrays of an archive together [bytes]."""


def read_csv(path: Path, *, max_range: float | None = None) -> ScanLog:
    """Returns the scans of a CSV file: a line for each, with time, x, y, yaw, and a column for each beam.

    The first line names the columns. The name of a beam's column is the beam's angle [rad]. Ranges may be inf, -inf and nan.

    Args:
        path: The file.
        max_range: Range from which on a beam has no return [m]. Without it, the largest finite range counts as a return.

    Raises:
        OSError: The file cannot be read.
        ValueError: The contents are invalid. The message gives the line.
    """
    text = read_text(path, LARGEST_FILE)
    lines = csv.reader(io.StringIO(text, newline=""))
    rows: list[ScanRow] = []
    notes: list[str] = []
    angles: NDArray[np.float64] | None = None
    last = text.count("\n") + 1
    short = ""
    has_end = text.endswith(("\n", "\r"))
    try:
        for cells in lines:
            if not any(cell.strip() for cell in cells):
                continue
            where = f"{path}, line {lines.line_num}"
            if angles is None:
                angles = _angles(cells, where)
                continue
            needed = len(COLUMNS) + len(angles)
            if len(cells) != needed:
                wrong_count = f"{where}: must have {needed} values, as the first line, got {len(cells)}"
                if len(cells) > needed or lines.line_num < last - has_end:
                    raise ValueError(wrong_count)
                notes.append(f"line {lines.line_num}, the last one, is cut off and was passed over")
                short = wrong_count
                continue
            time, x, y, yaw, *ranges = (_number(cell, f"{where}, value {n}") for n, cell in enumerate(cells, 1))
            if not all(map(math.isfinite, (x, y, yaw))):
                raise ValueError(f"{where}: a pose must be finite, got {x} {y} {yaw}")
            rows.append(ScanRow(lines.line_num, nanoseconds(time, where), (x, y, yaw), np.array(ranges, np.float32)))
    except csv.Error as error:
        raise ValueError(f"{path}, line {lines.line_num}: not CSV: {error}") from None
    if angles is None or not rows:
        got = "no line" if angles is None else "the names only"
        raise ValueError(short or f"{path}: must have a line with names and at least one scan, got {got}")
    limits = _limits([row.ranges for row in rows], None, max_range, notes)
    return ScanLog.from_rows(path, rows, angles=angles, limits=limits, notes=notes)


def read_npz(path: Path, *, max_range: float | None = None) -> ScanLog:
    """Returns the scans of an archive of NumPy arrays, as `numpy.savez` writes it.

    The arrays are `poses` (N, 3) of the scanner, `ranges` (N, B), and `angles` (B,) of the beams, or `angle_min` and
    `angle_increment`. There may be `stamps` (N,), int64 [ns] or floating-point [s], `min_range` and `max_range`. Without
    stamps, scan i is at i seconds.

    Args:
        path: The archive.
        max_range: Range from which on a beam has no return [m]. Without it, `max_range` of the archive, or else the largest
            finite range counts as a return.

    Raises:
        OSError: The file cannot be read.
        ValueError: The archive or an array is invalid. The message gives the array.
    """
    arrays = _arrays(path)
    ranges = _floats(path, arrays, "ranges", 2)
    poses = _floats(path, arrays, "poses", 2)
    if len(ranges) == 0 or ranges.shape[1] == 0 or poses.shape != (len(ranges), 3):
        raise ValueError(f"{path}: poses must have shape (N, 3) and ranges (N, B), got {poses.shape} and {ranges.shape}")
    wrong = np.flatnonzero(~np.isfinite(poses).all(axis=1))
    if len(wrong):
        raise ValueError(f"{path}: poses must be finite, got {poses[wrong[0]].tolist()} at index {wrong[0]}")
    notes: list[str] = []
    count = ranges.shape[1]
    if "angles" in arrays:
        angles = _floats(path, arrays, "angles", 1)
    else:
        start, step = (_floats(path, arrays, name, 0) for name in ("angle_min", "angle_increment"))
        angles = start + step * np.arange(count)
    if angles.shape != (count,) or not np.isfinite(angles).all():
        raise ValueError(f"{path}: angles must be {count} finite numbers, one for each range, got {angles.shape}")
    stamps = _stamps(path, arrays, len(ranges), notes)
    rows = [ScanRow(i, stamps[i], poses[i], ranges[i].astype(np.float32)) for i in range(len(ranges))]
    limits = _limits(ranges, arrays, max_range, notes, path)
    return ScanLog.from_rows(path, rows, angles=angles, limits=limits, notes=notes)


def _angles(cells: list[str], where: str) -> NDArray[np.float64]:
    names = [cell.strip() for cell in cells]
    if tuple(name.lower() for name in names[: len(COLUMNS)]) != COLUMNS or len(names) == len(COLUMNS):
        needed = f"{', '.join(COLUMNS)} and the angle of each beam"
        raise ValueError(f"{where}: the columns must be {needed}, got {quoted(','.join(cells))}")
    angles = [_number(name, f"{where}, value {n}") for n, name in enumerate(names[len(COLUMNS) :], len(COLUMNS) + 1)]
    if not all(map(math.isfinite, angles)):
        raise ValueError(f"{where}: angles must be finite, got {quoted(angles)}")
    return np.array(angles)


def _number(cell: str, where: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise ValueError(f"{where}: must be a number, got {quoted(cell)}") from None


def _arrays(path: Path) -> dict[str, Any]:
    with open_regular(path) as file:
        try:
            with zipfile.ZipFile(file) as archive:
                size = sum(item.file_size for item in archive.infolist())
        except Exception as error:  # whatever the bytes of a damaged archive lead to
            raise _no_archive(path, error) from None
        if size > LARGEST_FILE:
            raise ValueError(f"{path}: the arrays must have at most {LARGEST_FILE} bytes together, got {size}")
        file.seek(0)
        try:
            with np.load(file, allow_pickle=False) as arrays:
                return {name: arrays[name] for name in arrays.files}
        except Exception as error:
            raise _no_archive(path, error) from None


def _no_archive(path: Path, error: Exception) -> ValueError:
    return ValueError(f"{path}: must be an archive of NumPy arrays: {shortened(error) or type(error).__name__}")


def _floats(path: Path, arrays: dict[str, Any], name: str, dimensions: int) -> NDArray[np.float64]:
    if name not in arrays:
        raise ValueError(f"{path}: must have an array {name}, got {', '.join(sorted(arrays)) or 'none'}")
    array = arrays[name]
    if array.dtype.kind not in "fiu" or array.ndim != dimensions:
        raise ValueError(f"{path}: {name} must be numbers in {dimensions} dimensions, got {array.dtype} in {array.ndim}")
    return np.asarray(array, np.float64)


def _stamps(path: Path, arrays: dict[str, Any], count: int, notes: list[str]) -> list[int]:
    if "stamps" not in arrays:
        notes.append("there are no stamps, so scan i is at i seconds")
        return [i * 1_000_000_000 for i in range(count)]
    stamps = arrays["stamps"]
    if stamps.shape != (count,) or stamps.dtype.kind not in "fiu":
        raise ValueError(f"{path}: stamps must be {count} numbers, got {stamps.dtype} of shape {stamps.shape}")
    if stamps.dtype.kind == "f":
        return [nanoseconds(float(stamp), f"{path}: stamps, index {i}") for i, stamp in enumerate(stamps)]
    if stamps.size and int(stamps.max()) >= LATEST:
        raise ValueError(f"{path}: stamps must be below {LATEST} ns, got {stamps.max()}")
    return [int(stamp) for stamp in stamps]


def _limits(
    ranges: Any, arrays: dict[str, Any] | None, max_range: float | None, notes: list[str], path: Path = Path()
) -> tuple[float, float]:
    arrays = arrays or {}
    nearest = float(_floats(path, arrays, "min_range", 0)) if "min_range" in arrays else 0.0
    if max_range is not None:
        return nearest, max_range
    if "max_range" in arrays:
        return nearest, float(_floats(path, arrays, "max_range", 0))
    values = np.asarray(ranges, np.float32)
    finite = values[np.isfinite(values)]
    farthest = float(np.nextafter(finite.max(), np.float32(np.inf))) if len(finite) else nearest + 1.0
    notes.append(f"max_range is not given, so {farthest:g} m, just above the largest range, is assumed")
    return nearest, farthest
