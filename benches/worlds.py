"""Benchmarks of the worlds of others: drawing a plan, reading many plans, and driving through the worlds of BARN.

Run: python benches/worlds.py. The first figure is the median of several runs; the others are from one run each. The files
are generated in the formats of HouseExpo and BARN.
"""

from __future__ import annotations

import json
import tempfile
import time
from pathlib import Path

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.benchmarks import Observation, barn_task, run_tasks
from mobile_robot_simulator.maps.raster import Raster

SEED = 1
EDGES, PLANS, WORLDS = 2000, 1000, 300

CYLINDER = """<model name='unit_cylinder_{}'><static>1</static><pose frame=''>{:f} {:f} 0 0 0 0</pose><link name='link'>
<collision name='collision'><geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry></collision>
</link></model>
"""


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


def plan(random: np.random.Generator) -> list[list[float]]:
    """Returns the outline of rooms along a corridor, with walls of 0.1 m between them."""
    corners, x = [[0.0, 0.0]], 0.0
    for width in random.uniform(2.0, 5.0, random.integers(3, 8)):
        depth = random.uniform(2.0, 5.0)
        door = x + random.uniform(0.2, width - 1.2)
        corners += [[door, 0], [door, -0.1], [x, -0.1], [x, -depth], [x + width - 0.1, -depth], [x + width - 0.1, -0.1]]
        corners += [[door + 0.9, -0.1], [door + 0.9, 0]]
        x += width
    return np.round([*corners, [x, 0], [x, 1.8], [0, 1.8]], 4).tolist()


def read_plans(folder: Path) -> float:
    """Returns the time to load many plans and to scan each of them once [s]."""
    random = np.random.default_rng(SEED)
    paths = [folder / f"{index}.json" for index in range(PLANS)]
    for path in paths:
        path.write_text(json.dumps({"verts": plan(random), "id": "a", "room_category": {}, "room_num": 1, "bbox": {}}))
    laser = mrs.LaserScanner()
    start = time.perf_counter()
    for path in paths:
        laser.scan_batch(mrs.load_map(path), np.array([[1.0, 0.9, 0.0]]))
    return time.perf_counter() - start


class Gaps:
    """A controller that drives into the widest gap near the direction of the goal."""

    def __call__(self, observation: Observation) -> tuple[float, float]:
        """Returns speed [m/s] and turn rate [rad/s]."""
        scan, (x, y) = observation.scan, observation.goal
        ranges = np.where(np.isfinite(scan.ranges), scan.ranges, scan.range_max)
        angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
        free = np.lib.stride_tricks.sliding_window_view(np.minimum(ranges, 2.0), 121).min(axis=1)
        heading = float(angles[60:-60][np.argmax(free - 0.4 * np.abs(angles[60:-60] - np.arctan2(y, x)))])
        return max(0.1, float(free[len(free) // 2])) * max(0.0, float(np.cos(heading))), 2.0 * heading


def drive_through_worlds(folder: Path) -> tuple[float, str]:
    """Returns the time to drive through worlds of walls and cylinders [s], and the last line of the table."""
    random = np.random.default_rng(SEED)
    np.save(folder / "path.npy", np.array([(15, 0)], np.int64))
    start, tasks = time.perf_counter(), []
    for index in range(WORLDS):
        places = random.integers((0, 0), (29, 30), (15, 2)).tolist()
        walls = [(x, 0.075 + 0.15 * row) for row in range(64) for x in (-0.075, -4.425)]
        cylinders = [*walls, *((-4.425 + 0.15 * col, 5.075 + 0.15 * row) for col, row in places)]
        models = "".join(CYLINDER.format(number, x, y) for number, (x, y) in enumerate(cylinders))
        world = folder / f"world_{index}.world"
        world.write_text(f"<sdf version='1.6'><world name='default'>{models}</world></sdf>")
        tasks.append(barn_task(world, folder / "path.npy"))
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
