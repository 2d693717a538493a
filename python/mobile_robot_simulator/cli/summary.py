"""Summary: the results of a drive."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path

from ..new_files import write_files


@dataclass(frozen=True)
class Summary:
    """The results of a drive.

    Attributes:
        simulated_seconds: Simulated time [s].
        wall_seconds: Wall time [s].
        real_time_factor: Simulated time per wall time.
        scans: Number of scans.
        beams: Number of beams in all scans.
        beams_per_second: Beams per second of wall time.
        distance: Distance driven [m].
        collisions: Number of contacts of the robot's footprint that began.
        unknown_share: Share of odometry messages sent from unknown cells or from outside of the map, 0 to 1.
        start: First pose in the map frame: x, y [m], yaw [rad].
        end: Last pose in the map frame: x, y [m], yaw [rad].
        seed: Random seed.
        interrupted: True if Ctrl-C or another signal ended the drive early.
    """

    simulated_seconds: float
    wall_seconds: float
    real_time_factor: float
    scans: int
    beams: int
    beams_per_second: float
    distance: float
    collisions: int
    unknown_share: float
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    seed: int
    interrupted: bool

    def save(self, path: Path) -> None:
        """Writes the summary as JSON. An existing file is replaced in one step."""
        write_files({path: (json.dumps(asdict(self), indent=2) + "\n").encode()})

    def rows(self) -> list[tuple[str, str]]:
        """Returns the rows of a table: names and values."""
        return [
            ("simulated time", f"{self.simulated_seconds:.1f} s"),
            ("wall time", f"{self.wall_seconds:.2f} s"),
            ("real-time factor", f"{self.real_time_factor:.0f}"),
            ("scans", f"{self.scans}"),
            ("beams per second", f"{self.beams_per_second:,.0f}"),
            ("distance driven", f"{self.distance:.1f} m"),
            ("collisions", f"{self.collisions}"),
            ("in unknown space", f"{self.unknown_share:.0%}"),
        ]
