"""Messages of a laser scanner, from its readings and parameters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .._core import LaserScanner
from ..messages import Header, LaserScan, Time
from ..parameters import LaserParameters

RANGE_MAX_MARGIN = 0.001
"""With `no_return: max`, `range_max` of a scan exceeds the reading of a beam without a return by this [m]."""

NO_INTENSITIES = np.zeros(0, np.float32)


def scan_message(
    stamp_ns: int,
    parameters: LaserParameters,
    scanner: LaserScanner,
    ranges: NDArray[np.float32],
    intensities: NDArray[np.float32] = NO_INTENSITIES,
) -> LaserScan:
    """Returns the message of a scan.

    Args:
        stamp_ns: Time of the first beam [ns].
        parameters: Parameters of the node.
        scanner: Scanner with its mount.
        ranges: (beam_count,) float32, the readings [m], before invalid ones are marked.
        intensities: (beam_count,) float32, or (0,) for none.
    """
    return LaserScan(
        Header(Time.from_nanoseconds(stamp_ns), parameters.frames["laser_frame_id"]),
        angle_min=scanner.angle_min,
        angle_max=scanner.angle_max,
        angle_increment=scanner.angle_increment,
        time_increment=scanner.time_increment(parameters.laser_scan_duration),
        scan_time=1.0 / parameters.laser_frequency,
        range_min=scanner.min_range,
        range_max=_range_max(parameters),
        ranges=scanner.mark_invalid(ranges, no_return=parameters.no_return),
        intensities=intensities,
    )


def _range_max(parameters: LaserParameters) -> float:
    """Returns `range_max` of the scans [m].

    Programs such as laser_geometry drop readings of `range_max` and above. With `no_return: max`, beams without a return
    must not be dropped, so `range_max` exceeds their reading. It is a float32 in messages, hence the next float32 if the
    margin would be lost.
    """
    max_range = parameters.laser_max_range
    if parameters.no_return != "max":
        return max_range
    next_above = float(np.nextafter(np.float32(max_range), np.float32(np.inf)))
    return max(max_range + RANGE_MAX_MARGIN, next_above)
