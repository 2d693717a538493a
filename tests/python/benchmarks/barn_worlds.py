"""Generated worlds and paths of BARN, and controllers that are easy to predict."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from mobile_robot_simulator.benchmarks import Observation

CYLINDER = """<model name='unit_cylinder_{}'><static>1</static><pose frame=''>{:f} {:f} 0 0 0 0</pose><link name='link'>
<collision name='collision'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry></collision>
</link></model>
"""


def write_world(folder: Path, name: str, cylinders: list[tuple[float, float]]) -> Path:
    """Writes a world with walls of cylinders at both sides, as BARN has them, and others."""
    walls = [(x, 0.075 + 0.15 * row) for row in range(64) for x in (-0.075, -4.425)]
    models = "".join(CYLINDER.format(index, x, y) for index, (x, y) in enumerate([*walls, *cylinders]))
    path = folder / f"{name}.world"
    path.write_text(f"<sdf version='1.6'><world name='default'>{models}</world></sdf>")
    return path


def write_path(folder: Path, name: str, cells: list[tuple[int, int]]) -> Path:
    np.save(folder / f"{name}.npy", np.array(cells, np.int64))
    return folder / f"{name}.npy"


def straight() -> object:
    """A controller that drives straight on at 1 m/s."""
    return lambda observation: (1.0, 0.0)


def still() -> object:
    """A controller that does nothing."""
    return lambda observation: (0.0, 0.0)


class Exiting:
    """A controller that drives straight on, and ends its process if the goal is behind the robot."""

    def __call__(self, observation: Observation) -> tuple[float, float]:
        if observation.goal[0] < 0.0:
            os._exit(7)
        return 1.0, 0.0


class Gaps:
    """A controller that drives into the widest gap near the direction of the goal."""

    def __call__(self, observation: Observation) -> tuple[float, float]:
        scan, (x, y) = observation.scan, observation.goal
        ranges = np.where(np.isfinite(scan.ranges), scan.ranges, scan.range_max)
        angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
        free = np.lib.stride_tricks.sliding_window_view(np.minimum(ranges, 2.0), 121).min(axis=1)
        heading = float(angles[60:-60][np.argmax(free - 0.4 * np.abs(angles[60:-60] - np.arctan2(y, x)))])
        return max(0.1, float(free[len(free) // 2])) * max(0.0, float(np.cos(heading))), 2.0 * heading
