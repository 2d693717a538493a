"""compare_log: the scans of a log against scans that are simulated at the same poses of a map."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid
from ..logs import ScanLog
from ..quoting import quoted
from ..simulation.arguments import check_numbers
from .alignment import REACH, Alignment, align_log, moved
from .beams import Beams
from .breakdown import INCIDENCES, RANGES, Breakdown, bands, wrong_places
from .incidence import incidence_of
from .noise_fit import NoiseFit, fit_noise
from .refinement import Refinement, refine_poses
from .residuals import Residuals, Spread


@dataclass(frozen=True)
class Comparison:
    """The scans of a log beside simulated ones.

    Attributes:
        grid: The map.
        log: The log.
        poses: (N, 3) float64, poses of the scanner on the map that the scans were simulated at: x, y [m], yaw [rad].
        simulated: (N, B) float32, simulated ranges [m]. Exactly the log's `max_range` means no return.
        residuals: Measured ranges, less `offset`, less simulated ones.
        offset: What was subtracted from the measured ranges [m].
        alignment: How the log's frame was moved, or None.
        refinement: How each pose was changed after that, or None.
        breakdown: The residuals by range, by incidence, by beam and by place.
        noise: The beam model of the log. None for a log of one scan, or without readings that can be used.
    """

    grid: OccupancyGrid
    log: ScanLog
    poses: NDArray[np.float64]
    simulated: NDArray[np.float32]
    residuals: Residuals
    offset: float
    alignment: Alignment | None
    refinement: Refinement | None
    breakdown: Breakdown
    noise: NoiseFit | None

    def ends(self) -> NDArray[np.float64]:
        """Returns where the beams with a residual really ended, (M, 2) float64, in the map frame [m].

        They are in the order of `residuals.values`, without NaN.
        """
        return _ends(self.poses, self.log.angles, self.log.ranges, ~np.isnan(self.residuals.values))[0]

    def report(self) -> dict[str, Any]:
        """Returns the results as values that JSON has. Lengths are in metres, angles in radians."""
        spread, (edges, counts) = self.residuals.spread, self.residuals.histogram()
        return {
            "log": str(self.log.path),
            "notes": list(self.log.notes),
            "scans": len(self.log.ranges),
            "beams_per_scan": len(self.log.angles),
            "max_range": self.log.max_range,
            "offset": self.offset,
            "alignment": self.alignment and self.alignment.report(),
            "refinement": self.refinement and self.refinement.report(),
            "beams": self.residuals.counts,
            "residuals": {
                **spread.report(),
                "histogram": {"edges": edges.round(6).tolist(), "counts": counts.tolist()},
                **self.breakdown.report(),
            },
            "noise": self.noise and self.noise.report(),
        }


def compare_log(
    grid: OccupancyGrid,
    log: ScanLog,
    *,
    align: Literal["none", "rigid"] = "rigid",
    reach: tuple[float, float] = REACH,
    refine: bool = False,
    offset: float = 0.0,
    progress: Callable[[str, float], None] = lambda *_: None,
) -> Comparison:
    """Casts the beams of a log's scans on a map, and compares the ranges.

    Real returns lie behind the face of a wall's first cell, because walls in maps are thick. `offset` takes that out.

    Args:
        grid: The map.
        log: The log.
        align: "rigid" first moves the log's frame to where it explains the scans best, see `Alignment`. "none" takes the
            poses as they are.
        reach: Largest shift in x and y [m], and largest yaw [rad], of the alignment.
        refine: Then also change the pose of each scan by up to 0.3 m and 0.09 rad, see `Refinement`.
        offset: What to subtract from the measured ranges [m].
        progress: Called repeatedly with what is being done, and with the share of it that is done, up to 1.

    Raises:
        ValueError: No beam has a return in both the log and the simulation, or an argument is invalid.
        TypeError: An argument has a wrong type.

    Example:
        comparison = compare_log(load_map("map.yaml"), read_log("robot.log"))
        print(comparison.residuals.spread.median)
    """
    if not isinstance(grid, OccupancyGrid):
        raise TypeError(f"grid must be an OccupancyGrid, got {quoted(grid)}")
    if not isinstance(log, ScanLog):
        raise TypeError(f"log must be a logs.ScanLog, as read_log returns it, got {quoted(log)}")
    check_numbers(offset=offset)
    if align not in ("none", "rigid"):
        raise ValueError(f"align must be 'none' or 'rigid', got {align!r}")
    if not math.isfinite(offset):
        raise ValueError(f"offset must be finite, got {offset}")
    if offset:
        is_return = np.isfinite(log.ranges)
        log = replace(log, ranges=np.where(is_return, np.maximum(log.ranges - np.float32(offset), 0), log.ranges))
    alignment = refinement = None
    poses = log.poses
    if align == "rigid":
        alignment = align_log(grid, log, reach=reach, progress=lambda share: progress("aligning", share))
        poses = moved(poses, alignment.map_from_log)
    if refine:
        refinement = refine_poses(grid, log, poses, progress=lambda share: progress("refining poses", share))
        poses = refinement.poses
    simulated = Beams.of_log(log).cast(grid, poses, progress=lambda share: progress("casting beams", share))
    residuals = Residuals(log.ranges, simulated, log.max_range)
    if not residuals.counts["both"]:
        raise ValueError(f"{log.path}: no beam has a return in both the log and the simulation; {_places(grid, log)}")
    breakdown = _break_down(grid, log, poses, simulated, residuals.values, lambda share: progress("finding walls", share))
    noise = fit_noise(log, simulated, progress=lambda share: progress("fitting the noise", share))
    return Comparison(grid, log, poses, simulated, residuals, offset, alignment, refinement, breakdown, noise)


def _break_down(
    grid: OccupancyGrid,
    log: ScanLog,
    poses: NDArray[np.float64],
    simulated: NDArray[np.float32],
    values: NDArray[np.float32],
    progress: Callable[[float], None],
) -> Breakdown:
    is_known = ~np.isnan(values)
    walls, directions = _ends(poses, log.angles, simulated, is_known)
    ends, _ = _ends(poses, log.angles, log.ranges, is_known)
    known = values[is_known]
    return Breakdown(
        bands(known, simulated[is_known], RANGES),
        bands(known, incidence_of(grid, walls, directions, progress=progress), INCIDENCES),
        [Spread.of(column) for column in values.T],
        wrong_places(known, ends),
    )


def _ends(
    poses: NDArray[np.float64], angles: NDArray[np.float64], ranges: NDArray[np.float32], wanted: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the ends (M, 2) of the wanted beams in the map frame [m], and their directions (M,) [rad]."""
    scans, beams = np.nonzero(wanted)
    directions = poses[scans, 2] + angles[beams]
    steps = ranges[wanted][:, None] * np.column_stack([np.cos(directions), np.sin(directions)])
    return poses[scans, :2] + steps, directions


def _places(grid: OccupancyGrid, log: ScanLog) -> str:
    """Returns a text that says where the poses and the map are, for an error."""
    low, high = log.poses[:, :2].min(axis=0), log.poses[:, :2].max(axis=0)
    (height, width), side, (x, y, yaw) = grid.shape, grid.resolution, grid.origin
    return (
        f"the poses must be in the frame of the map, got x {low[0]:g} to {high[0]:g} m and y {low[1]:g} to {high[1]:g} m "
        f"in the frame {log.frame!r}, for a map of {width * side:g} m x {height * side:g} m with its origin at "
        f"({x:g}, {y:g}, {yaw:g})"
    )
