"""ReplayFrames: what a page draws of a recording, in the parts in which it draws a simulation."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._core import OccupancyGrid
from ..instant import NANOSECONDS
from .parts import Frame, json_part, map_part, rounded, scan_part
from .replay import Replay

MARGIN = 5.0
"""Width of the empty border around the paths, if the recording has no map [m]."""

CELL = 0.5
"""Size of the cells then [m]."""


class ReplayFrames:
    """Makes frames of a recording.

    Args:
        replay: The recording under the control of viewers.
        title: Name of the recording.

    Attributes:
        grid: The map of the last frame.
    """

    def __init__(self, replay: Replay, title: str = "") -> None:
        self._replay, self._title = replay, title
        self._scans: dict[str, tuple[int, bytes]] = {}
        self._told: set[str] = set()
        self._without_map: OccupancyGrid | None = None
        self.grid = self._grid()

    def make(self) -> Frame:
        """Returns the frame of the present."""
        replay, playback, now_ns = self._replay, self._replay.playback, self._replay.now_ns
        robots: dict[str, Any] = {}
        for name in playback.robots:
            if (played := playback.robot_at(name, now_ns)) is not None:
                robots[name] = {
                    "pose": rounded(played.pose),
                    "believed": rounded(played.believed),
                    "velocity": list(played.velocity or (0.0, 0.0, 0.0)),
                }
        self.grid = self._grid()
        parts = {
            "now": json_part({"time": replay.time, "rate": round(replay.pace.rate, 2), "robots": robots}),
            "map": map_part(self.grid, self._title, id(self.grid)),
            "session": json_part({"paused": replay.pace.paused, "speed": replay.pace.speed, "pilots": {}}),
            "replay": json_part({"duration": replay.duration, "begin": playback.begin_ns / NANOSECONDS}),
        }
        for topic, robot in playback.scanners.items():
            if (part := self._scan(topic, now_ns)) is not None:
                parts[f"scan:{robot}:{topic}"] = part
        return Frame(parts, {name: way.until(now_ns) for name, way in replay.ways.items()})

    def _scan(self, topic: str, now_ns: int) -> bytes | None:
        try:
            scan = self._replay.playback.scan_at(topic, now_ns)
        except (ValueError, OSError) as error:
            self._tell(f"{error}")
            return None
        if scan is None:
            return None
        last = self._scans.get(topic)
        if last is None or last[0] != scan.stamp_ns:
            stamp = (scan.stamp_ns - self._replay.playback.begin_ns) / NANOSECONDS
            last = self._scans[topic] = scan.stamp_ns, scan_part(scan.scanner, scan.base, scan.ranges, stamp)
        return last[1]

    def _grid(self) -> OccupancyGrid:
        """Returns the map of the present or, if there is none, an unknown one around the paths."""
        try:
            found = self._replay.playback.map_at(self._replay.now_ns)
        except (ValueError, OSError) as error:
            self._tell(f"{error}")
            found = None
        if found is None:
            if self._without_map is None:
                self._without_map = self._unknown_grid()
            found = self._without_map
        return found

    def _unknown_grid(self) -> OccupancyGrid:
        points = [point[:2] for way in self._replay.ways.values() for point in way.points if point is not None]
        low, high = np.min(points or [(0.0, 0.0)], axis=0) - MARGIN, np.max(points or [(0.0, 0.0)], axis=0) + MARGIN
        columns, rows = np.ceil((high - low) / CELL).astype(int)
        return OccupancyGrid(np.full((rows, columns), -1, np.int8), resolution=CELL, origin=(*low, 0.0))

    def _tell(self, text: str) -> None:
        """Tells viewers about something wrong, once."""
        if text not in self._told:
            self._told.add(text)
            self._replay.notes.append(text)
