"""What casting costs through Python: by kernel and map, by threads, and beside the same call from Rust and other packages.

Run: python benches/throughput.py [MAP...]. Every kernel has a process of its own; they take turns on the same work, so that
a busy machine slows all of them alike, and of each the median counts. All of it on one thread unless said. Peak memory is
that of the process, Python and NumPy with it. The Rust call needs cargo; raycast2D and ir-sim are measured where they are
installed.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import math
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import mobile_robot_simulator as mrs

SEED = 5
TURNS = 7
SCANS = 1000
RAYS = 100_000
BEAMS = 541
FOV = 0.75 * math.tau
CELLS = 600
"""Maximum range in cells."""

FOLDER = Path(__file__).parents[1]
REAL = {
    "hallways": ("rl_basement_hallways_5cm/basement_hallways_5cm.png", 0.05),
    "willow": ("willow_2010_0.10/willow-2010-02-18-0.10.pgm", 0.1),
    "depot": ("nav2_depot/depot.pgm", 0.05),
    "sandbox": ("nav2_tb3_sandbox/tb3_sandbox.pgm", 0.05),
    "huge": ("rl_huge/huge_map.png", 0.05),
}


def maps() -> Iterator[tuple[str, mrs.OccupancyGrid]]:
    """An office of our own, and the real maps of the folder beside the project."""
    yield "office", mrs.floor_plan("office", seed=SEED, size=(40.0, 40.0))
    folder = FOLDER.parent / "shared/maps"
    if not folder.is_dir():
        print(f"passed over: no real maps in {folder}")
        return
    for name, (path, resolution) in REAL.items():
        if (folder / path).is_file():
            pixels = np.asarray(Image.open(folder / path).convert("L"))[::-1]
            # Dark is occupied, white is free, and grey is unknown, where no pose is put.
            cells = np.where(pixels < 90, 100, np.where(pixels < 250, -1, 0)).astype(np.int8)
            yield name, mrs.OccupancyGrid(cells, resolution=resolution)


def poses(grid: mrs.OccupancyGrid, count: int) -> np.ndarray:
    """Uniform in the free space of a grid at the origin."""
    generator = np.random.default_rng(SEED)
    rows, cols = np.nonzero(grid.cells == 0)
    chosen = generator.integers(len(rows), size=count)
    corners = np.column_stack((cols[chosen], rows[chosen]))
    places = (corners + generator.random((count, 2))) * grid.resolution
    return np.column_stack((places, generator.random(count) * math.tau))


class Worker:
    """A process that measures what it is asked to."""

    def __init__(self, command: list[str], environment: dict[str, str]) -> None:
        environment = {**os.environ, **environment}
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment, cwd=FOLDER
        )

    def ask(self, question: str) -> Any:
        """What it says to a line."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(question + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        if not answer:
            raise SystemExit(f"{self._process.args!r} ended with {self._process.wait()}")
        return json.loads(answer)

    def close(self) -> None:
        """Let it end."""
        self._process.communicate()


def work(folder: Path) -> None:
    """Be a worker: for each line on standard input, the seconds that it took."""
    about = json.loads((folder / "about").read_text())
    cells = np.fromfile(folder / "cells", np.int8).reshape(-1, about["width"])
    starts = np.fromfile(folder / "poses").reshape(-1, 3)
    grid = mrs.OccupancyGrid(cells, resolution=about["resolution"])
    grid.prepare()
    max_range = CELLS * grid.resolution
    laser = mrs.LaserScanner(fov=FOV, beam_count=BEAMS, max_range=max_range)
    rays, model = poses(grid, RAYS), mrs.BeamModel()
    room = np.empty((10 * SCANS, BEAMS), np.float32)

    def scan(count: int, threads: int) -> None:
        laser.scan_batch(grid, starts[:count], threads=threads, out=room[:count])

    tasks: dict[str, Callable[[], object]] = {
        "scan": lambda: scan(SCANS, 1),
        "noisy": lambda: laser.scan_batch(grid, starts[:SCANS], noise=model, seed=1, threads=1, out=room[:SCANS]),
        "rays": lambda: mrs.cast_rays(grid, rays, max_range=max_range, threads=1),
        "new array": lambda: laser.scan_batch(grid, starts[:SCANS], threads=1),
        "one": lambda: scan(1, 1),
        "one thread": lambda: scan(10 * SCANS, 1),
        "two threads": lambda: scan(10 * SCANS, 2),
        "all threads": lambda: scan(10 * SCANS, os.cpu_count() or 1),
    }
    for line in sys.stdin:
        task = line.strip()
        if task == "memory":
            print(peak_memory(), flush=True)
        else:
            start = time.perf_counter()
            tasks[task]()
            print(time.perf_counter() - start, flush=True)


def peak_memory() -> float:
    """Of this process so far [MB]."""
    status = Path("/proc/self/status")
    if status.exists():
        # What the kernel's resource usage says includes the process that this one was forked from.
        return float(status.read_text().split("VmHWM:")[1].split()[0]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def in_turns(workers: dict[str, Worker], questions: dict[str, str], turns: int = TURNS) -> dict[str, float]:
    """Median seconds of each worker for its question."""
    times: dict[str, list[float]] = {name: [] for name in questions}
    for turn in range(turns + 1):
        for name, question in questions.items():
            took = workers[name].ask(question)
            if turn:
                times[name].append(took)
    return {name: statistics.median(took) for name, took in times.items()}


def kernels() -> list[str]:
    """Those of this machine, the plain traversal first."""
    code = "import mobile_robot_simulator as mrs; grid = mrs.floor_plan(); mrs.LaserScanner().scan(grid, (1.0, 1.0, 0.0))"
    fine = []
    for name in ("traversal", "portable", "avx2", "avx512"):
        environment = {**os.environ, "MOBILE_ROBOT_SIMULATOR_KERNEL": name}
        if subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=False).returncode == 0:
            fine.append(name)
        else:
            print(f"passed over: this machine has no {name}")
    return fine


def measure(name: str, grid: mrs.OccupancyGrid, names: list[str]) -> None:
    """Print all lines of a map."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        grid.cells.tofile(folder / "cells")
        poses(grid, 10 * SCANS).tofile(folder / "poses")
        (folder / "about").write_text(json.dumps({"width": grid.cells.shape[1], "resolution": grid.resolution}))
        command = [sys.executable, __file__, "--work", scratch]
        workers = {kernel: Worker(command, {"MOBILE_ROBOT_SIMULATOR_KERNEL": kernel}) for kernel in names}
        print(f"\n{name}: {grid.cells.shape[1]} x {grid.cells.shape[0]} cells")
        for workload, count in {"scan": SCANS * BEAMS, "noisy": SCANS * BEAMS, "rays": RAYS}.items():
            times = in_turns(workers, dict.fromkeys(workers, workload))
            for kernel, took in times.items():
                ratio = times["traversal"] / took
                memory = workers[kernel].ask("memory")
                print(f"{workload + '/' + name + '/' + kernel:32s}{took / count * 1e9:9.2f} ns{ratio:8.2f}x{memory:8.0f} MB")
        best = workers[names[-1]]
        batch = {"one thread": best, "two threads": best, "all threads": best}
        times = in_turns(batch, {task: task for task in batch}, 3 * TURNS)
        for task in ("two threads", "all threads"):
            print(f"{10 * SCANS} scans, {task}, {os.cpu_count()} cores: {times['one thread'] / times[task]:.2f}x one thread")
        rust = {"MOBILE_ROBOT_SIMULATOR_KERNEL": names[-1], "CARGO_TERM_QUIET": "true"}
        command = ["cargo", "bench", "--locked", "--bench", "call", "--", scratch]
        workers["rust"] = Worker([*command, str(grid.cells.shape[1]), str(grid.resolution)], rust)
        workers["python"] = workers["new array"] = best
        times = in_turns(workers, {"rust": str(SCANS), "python": "scan", "new array": "new array"}, 15 * TURNS)
        for task in ("python", "new array"):
            print(f"{SCANS} scans from {task} over the Rust call: {times[task] / times['rust']:.3f}x")
        times = in_turns(workers, {"rust": "1", "python": "one"}, 50 * TURNS)
        print(f"one scan from Python over the Rust call: {(times['python'] - times['rust']) * 1e6:.1f} us more")
        for worker in {id(worker): worker for worker in workers.values()}.values():
            worker.close()


def peers(name: str, grid: mrs.OccupancyGrid) -> None:
    """Print the lines of other packages, scan by scan from the centres of cells, and how far off they are."""
    starts = poses(grid, 50)
    starts[:, :2] = (np.floor(starts[:, :2] / grid.resolution) + 0.5) * grid.resolution
    laser = mrs.LaserScanner(fov=FOV, beam_count=BEAMS, max_range=CELLS * grid.resolution)
    exact = laser.scan_batch(grid, starts)
    for peer, make in {"raycast2D": raycast2d, "irsim": ir_sim}.items():
        if importlib.util.find_spec(peer) is None:
            print(f"passed over: {peer} is not installed")
            continue
        scan = make(grid)
        times, off = [], []
        deadline = time.perf_counter() + 60.0
        for start, expected in zip(starts, exact, strict=True):
            begun = time.perf_counter()
            found = scan(start)
            times.append(time.perf_counter() - begun)
            off.append(np.abs(np.minimum(found, CELLS * grid.resolution) - expected) / grid.resolution)
            if time.perf_counter() > deadline:
                break
        took, errors = statistics.median(times) / BEAMS * 1e9, np.concatenate(off)
        far = np.mean(errors > 2.0)
        print(
            f"{'scan/' + name + '/' + peer:32s}{took:9.2f} ns{'':9s}{peak_memory():8.0f} MB   {len(times)} scans, off by "
            f"{errors.mean():.3f} cells in the mean, {errors.max():.0f} at most, {far:.2%} by more than 2"
        )


def raycast2d(grid: mrs.OccupancyGrid) -> Callable[[np.ndarray], np.ndarray]:
    """Scans by raycast2D, to the corners of cells as it names them."""
    import raycast2D  # type: ignore[import-untyped]

    image = np.where(grid.cells >= 60, 0, 255).astype(np.uint8)
    lidar = raycast2D.Lidar2D(num_rays=BEAMS, FOV=270, ray_length=CELLS, occupancy_grid=image)

    def scan(pose: np.ndarray) -> np.ndarray:
        col, row = int(pose[0] / grid.resolution), int(pose[1] / grid.resolution)
        hits = lidar.scan((col, row, pose[2] + math.pi / 2), only_true_collisions=False).astype(np.int32)
        return np.hypot(hits[:, 0] - col, hits[:, 1] - row) * grid.resolution

    return scan


def ir_sim(grid: mrs.OccupancyGrid) -> Callable[[np.ndarray], np.ndarray]:
    """Scans by ir-sim's 2D lidar, over its map of an image."""
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


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("maps", nargs="*", help=f"office, {', '.join(REAL)}; all but the last if none is named")
    parser.add_argument("--work", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(options.work)
        return
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, {platform.machine()}, version {mrs.__version__}")
    names = kernels()
    for name, grid in maps():
        if name in options.maps or (not options.maps and name != "huge"):
            measure(name, grid, names)
            peers(name, grid)


if __name__ == "__main__":
    main()
