"""ScanBatch: the scans of several scanners that are due at one instant, cast together on all cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, LaserScanner, Obstacles, OccupancyGrid, Pose, SurfaceModel, scan_each
from ..handle import Handle

MIN_SCANS = 16
"""Smallest batch. Fewer scans gain less time than threads cost."""

SKIPPED = 16
"""Number of instants without a batch after one that failed, or of which most scans were cast in vain."""

Scan: TypeAlias = tuple[LaserScanner, OccupancyGrid, Pose, Obstacles, BeamModel | None, SurfaceModel | None, int, int]
"""All that the ranges of a scan depend on: scanner, map, pose, obstacles, noise, surfaces, seed and index."""


class Scanning(Protocol):
    """What the batch needs to know about a scanner."""

    def next_scan(self) -> Scan | None:
        """Returns the scan that the scanner would take now. None for one that is not cast in a batch."""


class ScanBatch(Handle):
    """Casts the scans of one instant together, to the same bytes as one by one.

    The first scanner of an instant has the scans of all cast that are due at this instant, too. Whatever happens before
    their turn, such as a callback that moves an obstacle, makes another scan of theirs, and they cast it alone.

    Args:
        clock: Returns the simulated time [ns].
        due: Returns the scanners whose turn comes later at this time.

    Attributes:
        scanner_count: Number of scanners that share the batch. With fewer than `MIN_SCANS`, none asks.

    """

    def __init__(self, clock: Callable[[], int], due: Callable[[], Sequence[Scanning]]) -> None:
        self._clock, self._due, self.scanner_count = clock, due, 0
        self.forget()

    def forget(self) -> None:
        """Drops what was cast. Must be called when the clock was set back."""
        self._time_ns: int | None = None
        """Time of the last batch, or of the last time without one [ns]."""
        self._cast: dict[Scanning, tuple[int, Scan, NDArray[np.float32]]] = {}
        """Scans that were cast at that time and not taken yet: revision of the map, scan, ranges."""
        self._vain = self._skipped = 0
        """Scans of the last batch that were not taken, less those that were; times until the next batch."""

    def take(self, scanner: Scanning, scan: Scan) -> NDArray[np.float32] | None:
        """Returns the ranges of the next scan of a scanner, None if the scanner must cast it alone."""
        if self._time_ns != (time_ns := self._clock()):
            self._time_ns = time_ns
            self._cast_due(scanner, scan)
        found = self._cast.pop(scanner, None)
        if found is None:
            return None
        revision, cast, ranges = found
        if scan != cast or scan[1].revision != revision:
            return None
        self._vain -= 2
        return ranges

    def _cast_due(self, first: Scanning, scan: Scan) -> None:
        """Casts the scan of the first scanner and all others that are due now, unless it is not worth while."""
        self._skipped = SKIPPED if self._vain > 0 else max(0, self._skipped - 1)
        self._vain, self._cast = 0, {}
        if self._skipped:
            return
        due = self._due()
        if len(due) + 1 < MIN_SCANS:
            return  # Nobody is asked in vain.
        others = ((scanner, scanner.next_scan()) for scanner in due)
        scans = {first: scan, **{scanner: other for scanner, other in others if other is not None}}
        if len(scans) < MIN_SCANS:
            return
        revisions = [scan[1].revision for scan in scans.values()]
        self._vain = len(scans)
        try:
            ranges = scan_each(list(scans.values()))
        except (ValueError, OSError, MemoryError):
            # Without threads or memory, scans are cast one by one. Whoever casts a wrong one alone tells what is wrong.
            return
        self._cast = dict(zip(scans, zip(revisions, scans.values(), ranges, strict=True), strict=True))
