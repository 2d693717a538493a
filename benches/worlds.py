"""Benchmarks of the worlds of others: drawing a plan, reading many plans, and driving through the worlds of BARN.

Run: python benches/worlds.py. The first figure is the median of several runs; the others are from one run each. The files
are generated in the formats of HouseExpo and BARN.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.benchmarks import barn_task, run_tasks
from mobile_robot_simulator.maps.raster import Raster

# The generators of the tests.
sys.path.insert(0, str(Path(__file__).parents[1] / "tests/python"))
from benchmarks.barn_worlds import Gaps, write_path, write_world
from maps.house_plans import generated

SEED = 1
EDGES, PLANS, WORLDS = 2000, 1000, 300


def draw_a_plan() -> float:
    """Returns the time to draw a star-shaped room of 40 m with cells of 5 cm [s]."""
    angles = np.linspace(0, 2 * np.pi, EDGES, endpoint=False)
    radii = np.where(np.arange(EDGES) % 2, 20.0, 18.0)
    corners = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    times = []
    for _ in range(40):
        start = time.perf_counter()
        raster = Raster(corners.min(axis=0), corners.max(axis=0), 0.05)
        raster.add_outside(corners)
        raster.cell_map()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def read_plans(folder: Path) -> float:
    """Returns the time to load many plans and to scan each of them once [s]."""
    random = np.random.default_rng(SEED)
    paths = [folder / f"{index}.json" for index in range(PLANS)]
    for path in paths:
        path.write_text(json.dumps({"verts": generated(random), "id": "a", "room_category": {}, "room_num": 1, "bbox": {}}))
    laser = mrs.LaserScanner()
    start = time.perf_counter()
    for path in paths:
        laser.scan_batch(mrs.load_map(path), np.array([[1.0, 0.9, 0.0]]))
    return time.perf_counter() - start


def drive_through_worlds(folder: Path) -> tuple[float, str]:
    """Returns the time to drive through worlds of walls and cylinders [s], and the last line of the table."""
    random = np.random.default_rng(SEED)
    path = write_path(folder, "path", [(15, 0)])
    start, tasks = time.perf_counter(), []
    for index in range(WORLDS):
        places = random.integers((0, 0), (29, 30), (15, 2)).tolist()
        cylinders = [(-4.425 + 0.15 * col, 5.075 + 0.15 * row) for col, row in places]
        tasks.append(barn_task(write_world(folder, f"world_{index}", cylinders), path))
    trials = run_tasks(tasks, Gaps, processes=2)
    return time.perf_counter() - start, str(trials).splitlines()[-1]


def main() -> None:
    """Prints all figures."""
    print(f"draw a plan of {EDGES} edges, cells of 5 cm: {1000 * draw_a_plan():.1f} ms")
    with tempfile.TemporaryDirectory() as folder:
        print(f"load and scan {PLANS} plans of HouseExpo: {read_plans(Path(folder)):.2f} s")
        taken, result = drive_through_worlds(Path(folder))
        print(f"drive through {WORLDS} worlds of BARN in 2 processes: {taken:.1f} s; {result}")


if __name__ == "__main__":
    main()
