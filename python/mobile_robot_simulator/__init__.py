"""Exact, fast and deterministic simulation of mobile robots and laser scanners on occupancy grids."""

from ._core import BeamModel, LaserScanner, OccupancyGrid, Pose, cast_rays, integrate_twist
