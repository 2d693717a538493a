"""Packages that cast rays, each as a function from a grid to a function that scans.

`PACKAGES` take one pose (3,) in a call and return ranges (BEAMS,) [m]. `BATCHES` take poses (N, 3) and return ranges
(N, BEAMS).

raycast2D, ir-sim and Numba install from PyPI. range_libc (github.com/kctess5/range_libc) does not: its binding is written
for Python 2, so take the ROS imports out of `pywrapper/RangeLibc.pyx`, translate it by `cython --cplus -2`, and compile it
with `vendor/lodepng/lodepng.cpp` and the flags of `pywrapper/setup.py` to a module `range_libc`.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import mobile_robot_simulator as mrs

BEAMS = 541
FOV = 0.75 * math.tau
CELLS = 600
"""Maximum range in cells."""

THETAS = 112
"""Number of directions of range_libc's table."""

Cast = Callable[[np.ndarray], np.ndarray]
Make = Callable[[mrs.OccupancyGrid], Cast]


def ours(grid: mrs.OccupancyGrid) -> Cast:
    """Returns a function that casts with this package."""
    laser = mrs.LaserScanner(fov=FOV, beam_count=BEAMS, max_range=CELLS * grid.resolution)
    return lambda pose: laser.scan(grid, tuple(pose))


def raycast2d(grid: mrs.OccupancyGrid) -> Cast:
    """Returns a function that scans with raycast2D. It measures to the corners of cells."""
    import raycast2D  # type: ignore[import-untyped]

    image = np.where(grid.cells >= 60, 0, 255).astype(np.uint8)
    lidar = raycast2D.Lidar2D(num_rays=BEAMS, FOV=270, ray_length=CELLS, occupancy_grid=image)

    def scan(pose: np.ndarray) -> np.ndarray:
        col, row = int(pose[0] / grid.resolution), int(pose[1] / grid.resolution)
        hits = lidar.scan((col, row, pose[2] + math.pi / 2), only_true_collisions=False).astype(np.int32)
        return np.asarray(np.hypot(hits[:, 0] - col, hits[:, 1] - row) * grid.resolution)

    return scan


def ir_sim(grid: mrs.OccupancyGrid) -> Cast:
    """Returns a function that scans with the 2D lidar of ir-sim, which reads the map from an image."""
    import irsim  # type: ignore[import-untyped]
    import yaml

    with tempfile.TemporaryDirectory() as scratch:
        image, world = Path(scratch) / "map.png", Path(scratch) / "world.yaml"
        Image.fromarray(np.where(grid.cells >= 60, 0, 255).astype(np.uint8)[::-1]).save(image)
        height, width = (size * grid.resolution for size in grid.cells.shape)
        lidar = {"type": "lidar2d", "range_max": CELLS * grid.resolution, "angle_range": FOV, "number": BEAMS}
        robot = {"shape": {"name": "circle", "radius": 0.001}, "state": [0.0, 0.0, 0.0], "sensors": [lidar]}
        scene = {"height": height, "width": width, "obstacle_map": {"name": "image", "path": str(image)}}
        world.write_text(yaml.safe_dump({"world": scene, "robot": [robot]}))
        sensor = irsim.make(str(world), display=False, disable_all_plot=True, log_level="ERROR").robot.lidar

    def scan(pose: np.ndarray) -> np.ndarray:
        sensor.step(pose.reshape(3, 1))
        return np.asarray(sensor.range_data)

    return scan


def our_batches(grid: mrs.OccupancyGrid) -> Cast:
    """Returns a function that casts batches with this package, on one thread."""
    laser = mrs.LaserScanner(fov=FOV, beam_count=BEAMS, max_range=CELLS * grid.resolution)
    grid.prepare()
    return lambda poses: laser.scan_batch(grid, poses, threads=1)


def range_libc(method: str) -> Make:
    """Returns the same for a method of range_libc, which knows square maps only in this form."""

    def make(grid: mrs.OccupancyGrid) -> Cast:
        import range_libc as library  # type: ignore[import-not-found]

        blocks = np.zeros((max(grid.shape),) * 2, bool)
        blocks[: grid.shape[0], : grid.shape[1]] = grid.cells >= grid.occupied_threshold
        plan = library.PyOMap(np.ascontiguousarray(blocks.T))
        more = () if method == "PyRayMarching" else (THETAS,)
        caster = getattr(library, method)(plan, float(CELLS), *more)
        angles = np.linspace(-FOV / 2, FOV / 2, BEAMS, dtype=np.float32)

        def cast(poses: np.ndarray) -> np.ndarray:
            in_cells, ranges = poses.astype(np.float32), np.empty(len(poses) * BEAMS, np.float32)
            in_cells[:, :2] /= grid.resolution
            caster.calc_range_repeat_angles(in_cells, angles, ranges)
            return ranges.reshape(-1, BEAMS) * np.float32(grid.resolution)

        return cast

    return make


def numba_traversal(grid: mrs.OccupancyGrid) -> Cast:
    """Returns the same for the traversal of Amanatides and Woo (1987), compiled by Numba, in float64."""
    import numba  # type: ignore[import-not-found]

    @numba.njit(nogil=True, boundscheck=False)  # type: ignore[untyped-decorator]
    def traverse(blocks: Any, poses: Any, cos: Any, sin: Any, limit: float, ranges: Any) -> None:
        height, width = blocks.shape
        for scan in range(len(poses)):
            x, y = poses[scan, 0], poses[scan, 1]
            turn_x, turn_y = math.cos(poses[scan, 2]), math.sin(poses[scan, 2])
            for beam in range(len(cos)):
                dx = turn_x * cos[beam] - turn_y * sin[beam]
                dy = turn_y * cos[beam] + turn_x * sin[beam]
                col, row = math.floor(x), math.floor(y)
                step_x, step_y = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
                along_x = abs(1.0 / dx) if dx != 0.0 else math.inf
                along_y = abs(1.0 / dy) if dy != 0.0 else math.inf
                next_x = (col + 1 - x if dx > 0.0 else x - col) * along_x if dx != 0.0 else math.inf
                next_y = (row + 1 - y if dy > 0.0 else y - row) * along_y if dy != 0.0 else math.inf
                reached = 0.0
                while reached < limit and 0 <= col < width and 0 <= row < height:
                    if blocks[row, col]:
                        break
                    if next_x < next_y:
                        reached, next_x, col = next_x, next_x + along_x, col + step_x
                    else:
                        reached, next_y, row = next_y, next_y + along_y, row + step_y
                inside = 0 <= col < width and 0 <= row < height
                ranges[scan, beam] = min(reached, limit) if inside else limit

    blocks = np.ascontiguousarray(grid.cells >= grid.occupied_threshold)
    angles = np.linspace(-FOV / 2, FOV / 2, BEAMS)
    cos, sin = np.cos(angles), np.sin(angles)

    def cast(poses: np.ndarray) -> np.ndarray:
        ranges = np.empty((len(poses), BEAMS), np.float32)
        traverse(blocks, poses / (grid.resolution, grid.resolution, 1.0), cos, sin, float(CELLS), ranges)
        return ranges * np.float32(grid.resolution)

    return cast


PACKAGES: dict[str, Make] = {"mobile_robot_simulator": ours, "raycast2D": raycast2d, "irsim": ir_sim}
BATCHES: dict[str, Make] = {
    "numba": numba_traversal,
    "range_libc PyRayMarching": range_libc("PyRayMarching"),
    "range_libc PyCDDTCast": range_libc("PyCDDTCast"),
    "range_libc PyGiantLUTCast": range_libc("PyGiantLUTCast"),
}
