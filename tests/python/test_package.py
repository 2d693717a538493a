"""What importing the package costs."""

import subprocess
import sys

HEAVY = ("matplotlib", "PIL", "pydantic", "rich", "rosbags", "scipy", "typer", "yaml")

USE = f"""
import sys
import mobile_robot_simulator as mrs

import numpy as np

grid = mrs.OccupancyGrid(np.array([[0, 100]], np.int8), resolution=1.0)
laser = mrs.LaserScanner(beam_count=1, max_range=5.0)
ranges = laser.scan_batch(grid, np.array([[0.5, 0.5, 0.0]]), noise=mrs.BeamModel(), seed=1)
assert ranges.shape == (1, 1)
print(*sorted({set(HEAVY)!r} & set(sys.modules)))
"""


def test_the_core_loads_nothing_that_it_does_not_need() -> None:
    """A parameter model or a plot costs more to import than a million beams cost to cast."""
    ran = subprocess.run([sys.executable, "-c", USE], capture_output=True, text=True, timeout=60, check=False)
    assert (ran.returncode, ran.stdout.strip()) == (0, ""), ran.stderr
