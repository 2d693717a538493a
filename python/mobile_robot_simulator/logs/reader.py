"""read_log: the scans of a log in any of the formats that the package reads."""

from __future__ import annotations

import os
from pathlib import Path

from ..quoting import quoted
from ..simulation.arguments import check_numbers
from ..user_files import open_regular, to_path
from .carmen import read_carmen
from .scan_log import ScanLog
from .table import read_csv, read_npz

_ROS1, _MCAP, _SQLITE = b"#ROSBAG", b"\x89MCAP0\r\n", b"SQLite format 3\0"
_ZIP = b"PK\x03\x04"


def read_log(
    path: str | os.PathLike[str],
    *,
    scanner: str | None = None,
    pose_topic: str | None = None,
    max_range: float | None = None,
) -> ScanLog:
    """Returns the scans of a log and where each was taken.

    A log is a ROS 1 bag, a ROS 2 bag or MCAP file (these need the extra `recording`), a CARMEN log, a CSV file whose first
    line begins with `time,x,y,yaw` and names a beam's column by its angle, or a NumPy archive with the arrays `poses`,
    `ranges` and `angles`. The content decides, not the name.

    What is cut off at the end is passed over, and the log's `notes` say so. Anything else that is wrong is an error.

    Args:
        path: The log: a file, the folder of a bag, or the folder given to `run --out`.
        scanner: Topic of the scans (default: /scan or the only one), or word that begins a CARMEN line (default: FLASER, or
            else ROBOTLASER1).
        pose_topic: Topic of Odometry, PoseStamped or PoseWithCovarianceStamped. Without it, transforms give the poses.
        max_range: Range from which on a beam has no return [m]. Bags have it in each scan.

    Raises:
        ImportError: The log is a bag and rosbags is not installed.
        OSError: The log cannot be read.
        ValueError: The log is malformed, or has no scan with a pose. The message gives the line, or topic and index.
        TypeError: An argument has a wrong type.

    Example:
        log = read_log("drive")
        laser = LaserScanner(angle_min=log.angles[0], angle_max=log.angles[-1], beam_count=len(log.angles),
            max_range=log.max_range)
        simulated = laser.scan_batch(grid, log.poses)
    """
    path = to_path(path, "a log")
    if max_range is not None:
        check_numbers(max_range=max_range)
    kind = _kind_of(path)
    if kind != "bag" and pose_topic is not None:
        raise ValueError(f"{path}: only a bag has topics, so there must be no pose_topic, got {pose_topic!r}")
    if kind == "bag":
        if max_range is not None:
            raise ValueError(f"{path}: a bag says the range of its scanner, so max_range must be None, got {max_range}")
        from .bag_scans import read_bag

        return read_bag(path, scan_topic=scanner, pose_topic=pose_topic)
    if max_range is not None and not max_range > 0.0:
        raise ValueError(f"{path}: max_range must be greater than 0 m, got {quoted(max_range)}")
    if kind == "carmen":
        return read_carmen(path, scanner=scanner, max_range=max_range)
    if scanner is not None:
        raise ValueError(f"{path}: a table has one scanner, so scanner must be None, got {scanner!r}")
    return read_csv(path, max_range=max_range) if kind == "csv" else read_npz(path, max_range=max_range)


def is_bag(path: Path) -> bool:
    """Returns True if a path is a bag, by its content or its name, or a folder with one.

    Raises:
        OSError: The file cannot be read.
    """
    return _kind_of(path) == "bag"


def _kind_of(path: Path) -> str:
    if path.is_dir():
        return "bag"
    with open_regular(path) as file:
        start = file.read(256)
    if start.startswith((_ROS1, _MCAP, _SQLITE)) or path.suffix in (".bag", ".mcap", ".db3"):
        return "bag"
    if start.startswith(_ZIP) or path.suffix == ".npz":
        return "npz"
    first = start.decode("utf-8-sig", "replace").lstrip().lower().replace(" ", "")
    return "csv" if first.startswith("time,") or path.suffix.lower() == ".csv" else "carmen"
