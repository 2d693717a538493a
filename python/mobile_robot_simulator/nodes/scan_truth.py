"""ScanTruth: from where each beam of a scan was taken, and the scan as it would have been in one instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import BeamModel, LaserScanner, OccupancyGrid, Pose, Shape, SurfaceModel
from ..instant import NANOSECONDS
from ..physics.world import Passing
from ..quoting import quoted


@dataclass(frozen=True, slots=True, eq=False)
class ScanTruth:
    """The truth about a scan that took time. It tells how well a program undoes the distortion of the scan.

    Attributes:
        stamp_ns: Time of the first beam [ns], the stamp of the message.
        times_ns: (beam_count,) int64, the time of each beam after the first one [ns].
        beam_poses: (beam_count, 3) float64, the robot's true pose (x, y, yaw) in the map frame at the time of each beam
            [m, m, rad].
        ranges: (beam_count,) float32, the readings as measured [m], before invalid ones are marked.
        grid: Map that was scanned.
        scanner: Scanner with its mount.
        noise: Noise of the readings, None for no noise.
        seed: Seed of the noise.
        index: Number of the scan, which names its noise together with the seed.
        passing: Obstacles and other robots, each with its pose or its poses at the times of the beams.
        surfaces: How what a beam meets changes its noise, None for not at all.
    """

    stamp_ns: int
    times_ns: NDArray[np.int64]
    beam_poses: NDArray[np.float64]
    ranges: NDArray[np.float32]
    grid: OccupancyGrid
    scanner: LaserScanner
    noise: BeamModel | None
    seed: int
    index: int
    passing: tuple[Passing, ...]
    surfaces: SurfaceModel | None = None

    def __repr__(self) -> str:
        duration = self.times_ns[-1] / NANOSECONDS
        return f"ScanTruth({len(self.ranges)} beams from {self.stamp_ns / NANOSECONDS:g} s on, in {duration:g} s)"

    def instant(self, beam: int = 0) -> NDArray[np.float32]:
        """Returns the scan as it would have been if all beams had been taken at the time of one beam, with the same noise.

        Args:
            beam: Number of that beam.

        Returns:
            (beam_count,) float32 [m], before invalid readings are marked.

        Raises:
            ValueError: There is no such beam.
        """
        if not 0 <= beam < len(self.beam_poses):
            raise ValueError(f"beam must be in 0..{len(self.beam_poses) - 1}, got {quoted(beam)}")
        ranges: NDArray[np.float32] = self.scanner.scan_batch(
            self.grid,
            self.beam_poses[beam : beam + 1],
            obstacles=[_placed(shape, course, beam) for shape, course in self.passing],
            noise=self.noise,
            surfaces=self.surfaces,
            seed=self.seed,
            first_index=self.index,
            threads=1,
        )[0]
        return ranges


def _placed(shape: Shape, course: Pose | NDArray[np.float64], beam: int) -> tuple[Shape, Pose]:
    return shape, course if isinstance(course, Pose) else Pose(*course[beam])
