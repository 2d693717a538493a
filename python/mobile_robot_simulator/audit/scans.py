"""Scans: rules for LaserScan messages."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .findings import Findings

MOST_EQUAL = 2
"""Number of readings of a scan that may have the same largest value by chance."""

NEAR_MAX = 0.15
"""Largest distance from range_max of a reading that stands for a beam without a return [m]."""

_TURN_TOLERANCE = 1e-3
_TIME_TOLERANCE = 1e-3


def check_scan(findings: Findings, topic: str, index: int, scan: Any, first: Any) -> None:
    """Checks a scan.

    Args:
        findings: Where findings go.
        topic: Topic of the scan.
        index: Its position among the messages of the topic.
        scan: The message.
        first: The first message of the topic.
    """

    def found(rule: str, got: str) -> None:
        findings.add(rule, topic, index, got)

    count = len(scan.ranges)
    _check_angles(found, scan, count)
    ranges = np.asarray(scan.ranges, np.float64)
    low, high = float(scan.range_min), float(scan.range_max)
    if not (math.isfinite(high) and 0.0 <= low < high):
        found("scan-limits", f"range_min {low:g}, range_max {high:g}")
    else:
        outside = np.flatnonzero(np.isfinite(ranges) & ((ranges < low) | (ranges > high)))
        if len(outside):
            beam = int(outside[0])
            found("scan-ranges", f"{len(outside)} readings outside {low:g}..{high:g}; beam {beam} has {ranges[beam]:g}")
        largest = ranges[np.isfinite(ranges)].max(initial=0.0)
        equal = np.flatnonzero(ranges == largest)
        if len(equal) > MOST_EQUAL and abs(high - largest) <= NEAR_MAX:
            got = (
                f"{len(equal)} readings of exactly {largest:g} with range_max {high:g}, the first is that of beam {equal[0]}"
            )
            found("scan-no-return", got)
    if len(scan.intensities) not in (0, count):
        found("scan-intensities", f"{len(scan.intensities)} intensities for {count} ranges")
    each, whole = float(scan.time_increment), float(scan.scan_time)
    if not (math.isfinite(each) and math.isfinite(whole) and each >= 0.0 and whole >= 0.0):
        found("scan-time", f"time_increment {each:g}, scan_time {whole:g}")
    elif whole > 0.0 and each * (count - 1) > whole * (1.0 + _TIME_TOLERANCE):
        found("scan-time", f"{count} beams, {each:g} s apart, in a scan_time of {whole:g} s")
    if (change := _change(scan, first)) is not None:
        found("scan-change", change)


def _check_angles(found: Any, scan: Any, count: int) -> None:
    start, end, step = float(scan.angle_min), float(scan.angle_max), float(scan.angle_increment)
    shown = f"angle_min {start:g}, angle_max {end:g}, angle_increment {step:g}"
    is_turn = abs(step) * (count - 1) <= 2 * math.pi + _TURN_TOLERANCE
    if not all(map(math.isfinite, (start, end, step))) or (step == 0.0 and count > 1) or not is_turn:
        found("scan-angles", f"{shown}, {count} ranges")
        return
    steps = (end - start) / step if step != 0.0 else 0.0
    needed = {round(steps) + 1}
    if abs(abs(end - start) - 2 * math.pi) < abs(step) / 2:
        needed.add(round(steps))  # the end of a full turn is its beginning
    if count not in needed:
        found("scan-count", f"{count} ranges for the {round(steps) + 1} angles of {shown}")


def _change(scan: Any, first: Any) -> str | None:
    for name in ("angle_min", "angle_increment", "range_min", "range_max"):
        now, then = getattr(scan, name), getattr(first, name)
        if now != then and not (math.isnan(now) and math.isnan(then)):
            return f"{name} {now:g}, {then:g} in message 0"
    if len(scan.ranges) != len(first.ranges):
        return f"{len(scan.ranges)} ranges, {len(first.ranges)} in message 0"
    return None
