"""Benchmarks of ray casting from Python: kernels, maps and threads, compared with calls from Rust and with other packages.

Run: python benches/throughput.py [MAP...]. Each kernel runs in its own process. The processes take turns on the same work,
so a busy machine slows all of them equally. Each figure is a median. All work is done on one thread unless the printed
line says otherwise. Peak memory is that of the whole process, including Python and NumPy. The Rust call needs cargo.
Other packages are measured if they are installed; see `casters.py`.
"""

from __future__ import annotations

import argparse
import contextlib
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
from casters import BATCHES, BEAMS, CELLS, FOV, PACKAGES, Cast, our_batches
from PIL import Image

import mobile_robot_simulator as mrs

SEED = 5
TURNS = 7
SCANS = 1000
RAYS = 100_000

FOLDER = Path(__file__).parents[1]
REAL = {
    "hallways": ("rl_basement_hallways_5cm/basement_hallways_5cm.png", 0.05),
    "willow": ("willow_2010_0.10/willow-2010-02-18-0.10.pgm", 0.1),
    "depot": ("nav2_depot/depot.pgm", 0.05),
    "sandbox": ("nav2_tb3_sandbox/tb3_sandbox.pgm", 0.05),
    "huge": ("rl_huge/huge_map.png", 0.05),
}


def maps() -> Iterator[tuple[str, mrs.OccupancyGrid]]:
    """Yields a generated office, and real maps if the folder with them exists beside the project."""
    yield "office", mrs.floor_plan("office", seed=SEED, size=(40.0, 40.0))
    folder = FOLDER.parent / "shared/maps"
    if not folder.is_dir():
        print(f"skipped: no real maps in {folder}")
        return
    for name, (path, resolution) in REAL.items():
        if (folder / path).is_file():
            pixels = np.asarray(Image.open(folder / path).convert("L"))[::-1]
            # Dark pixels are occupied, white ones free and grey ones unknown. Poses are in free cells only.
            cells = np.where(pixels < 90, 100, np.where(pixels < 250, -1, 0)).astype(np.int8)
            yield name, mrs.OccupancyGrid(cells, resolution=resolution)


def poses(grid: mrs.OccupancyGrid, count: int) -> np.ndarray:
    """Returns random poses, uniform in the free cells of a grid whose origin is (0, 0, 0): (count, 3) float64."""
    generator = np.random.default_rng(SEED)
    rows, cols = np.nonzero(grid.cells == 0)
    chosen = generator.integers(len(rows), size=count)
    corners = np.column_stack((cols[chosen], rows[chosen]))
    places = (corners + generator.random((count, 2))) * grid.resolution
    return np.column_stack((places, generator.random(count) * math.tau))


class Worker:
    """A process that runs tasks and measures them."""

    def __init__(self, command: list[str], environment: dict[str, str]) -> None:
        environment = {**os.environ, **environment}
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment, cwd=FOLDER
        )

    def ask(self, question: str) -> Any:
        """Sends a line to the process and returns its answer."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(question + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        if not answer:
            raise SystemExit(f"{self._process.args!r} ended with {self._process.wait()}")
        return json.loads(answer)

    def close(self) -> None:
        """Ends the process."""
        self._process.communicate()


def work(folder: Path) -> None:
    """Runs in a worker process. Reads tasks from standard input and prints the result of each: mostly its duration [s]."""
    about = json.loads((folder / "about").read_text())
    cells = np.fromfile(folder / "cells", np.int8).reshape(-1, about["width"])
    starts, rays = (np.fromfile(folder / name).reshape(-1, 3) for name in ("poses", "rays"))
    grid = mrs.OccupancyGrid(cells, resolution=about["resolution"])
    del cells
    grid.prepare()
    max_range = CELLS * grid.resolution
    laser, model = mrs.LaserScanner(fov=FOV, beam_count=BEAMS, max_range=max_range), mrs.BeamModel()
    out = np.empty((10 * SCANS, BEAMS), np.float32)

    def scan(count: int, threads: int) -> None:
        laser.scan_batch(grid, starts[:count], threads=threads, out=out[:count])

    tasks: dict[str, Callable[[], object]] = {
        "scan": lambda: scan(SCANS, 1),
        "noisy": lambda: laser.scan_batch(grid, starts[:SCANS], noise=model, seed=1, threads=1, out=out[:SCANS]),
        "rays": lambda: mrs.cast_rays(grid, rays, max_range=max_range, threads=1),
        "new array": lambda: laser.scan_batch(grid, starts[:SCANS], threads=1),
        # One scan with the default number of threads.
        "one": lambda: laser.scan_batch(grid, starts[:1], out=out[:1]),
        "one thread": lambda: scan(10 * SCANS, 1),
        "two threads": lambda: scan(10 * SCANS, 2),
        "all threads": lambda: scan(10 * SCANS, os.cpu_count() or 1),
    }
    for line in sys.stdin:
        task = line.strip()
        if task == "memory":
            print(peak_memory(), flush=True)
        elif task in PACKAGES | BATCHES:
            # What packages print must not mix with the answer on standard output.
            with contextlib.redirect_stdout(sys.stderr):
                found = single_scans(grid, starts, task) if task in PACKAGES else batches(grid, starts[:SCANS], task)
            print(json.dumps(found), flush=True)
        else:
            start = time.perf_counter()
            tasks[task]()
            print(time.perf_counter() - start, flush=True)


def peak_memory() -> float:
    """Returns the peak memory of this process [MB]."""
    status = Path("/proc/self/status")
    if status.exists():
        # getrusage would include the memory of the process that this one was forked from.
        return float(status.read_text().split("VmHWM:")[1].split()[0]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def in_turns(workers: dict[str, Worker], questions: dict[str, str], turns: int = TURNS) -> dict[str, float]:
    """Returns the median time of each worker for its question [s]. The workers take turns. The first turn is not counted."""
    times: dict[str, list[float]] = {name: [] for name in questions}
    for turn in range(turns + 1):
        for name, question in questions.items():
            took = workers[name].ask(question)
            if turn:
                times[name].append(took)
    return {name: statistics.median(took) for name, took in times.items()}


def kernels() -> list[str]:
    """Returns the names of the kernels that this machine supports, the plain traversal first."""
    code = "import mobile_robot_simulator as mrs; grid = mrs.floor_plan(); mrs.LaserScanner().scan(grid, (1.0, 1.0, 0.0))"
    supported = []
    for name in ("traversal", "portable", "avx2", "avx512", "avx512-gather"):
        environment = {**os.environ, "MOBILE_ROBOT_SIMULATOR_KERNEL": name}
        ran = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
        if ran.returncode == 0:
            supported.append(name)
        else:
            print(f"skipped: {name}: {ran.stderr.splitlines()[-1]}")
    return supported


def measure(name: str, grid: mrs.OccupancyGrid, names: list[str]) -> None:
    """Runs and prints all benchmarks on a map."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        grid.cells.tofile(folder / "cells")
        poses(grid, 10 * SCANS).tofile(folder / "poses")
        poses(grid, RAYS).tofile(folder / "rays")
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
        for package in (*PACKAGES, *BATCHES):
            module = package.split()[0]
            if importlib.util.find_spec(module) is None:
                print(f"skipped: {module} is not installed")
                continue
            worker = Worker([sys.executable, __file__, "--work", scratch], {"MPLBACKEND": "Agg", "NUMBA_NUM_THREADS": "1"})
            print(f"{package:36s}{worker.ask(package)}")
            worker.close()


def at_centers(grid: mrs.OccupancyGrid, starts: np.ndarray) -> np.ndarray:
    """Returns poses at the centres of their cells, because some packages know no others."""
    places = (np.floor(starts[:, :2] / grid.resolution) + 0.5) * grid.resolution
    return np.column_stack((places, starts[:, 2]))


def errors(grid: mrs.OccupancyGrid, starts: np.ndarray, found: np.ndarray) -> str:
    """Returns how wrong ranges [m] are, as a text."""
    laser = mrs.LaserScanner(fov=FOV, beam_count=BEAMS, max_range=CELLS * grid.resolution)
    exact = laser.scan_batch(grid, starts)
    off = np.abs(np.minimum(found, laser.max_range) - exact) / grid.resolution
    return f"mean error {off.mean():.3f} cells, largest {off.max():.0f}, {np.mean(off > 2.0):.2%} off by more than 2"


def single_scans(grid: mrs.OccupancyGrid, starts: np.ndarray, package: str) -> str:
    """Returns the time and the errors of single scans from the centres of cells."""
    starts = at_centers(grid, starts[:50])
    cast = PACKAGES[package](grid)
    seconds, found = [], []
    deadline = time.perf_counter() + 30.0
    for start in starts:
        begun = time.perf_counter()
        found.append(cast(start))
        seconds.append(time.perf_counter() - begun)
        if time.perf_counter() > deadline:
            break
    memory, wrong = peak_memory(), errors(grid, starts[: len(found)], np.array(found))
    took = statistics.median(seconds) / BEAMS * 1e9
    return f"single scans: {took:7.0f} ns a beam, {memory:5.0f} MB; {len(found)} scans, {wrong}"


def batches(grid: mrs.OccupancyGrid, starts: np.ndarray, package: str) -> str:
    """Returns the time of a batch, as a ratio to that of this package in turns with it, and its errors."""
    starts = at_centers(grid, starts)
    begun = time.perf_counter()
    cast = BATCHES[package](grid)
    cast(starts[:1])
    built = time.perf_counter() - begun
    casts: dict[str, Cast] = {"ours": our_batches(grid), package: cast}
    times: dict[str, list[float]] = {name: [] for name in casts}
    for _ in range(TURNS):
        for name, each in casts.items():
            begun = time.perf_counter()
            each(starts)
            times[name].append(time.perf_counter() - begun)
    took, own = (statistics.median(times[name]) for name in (package, "ours"))
    return (
        f"{len(starts)} scans: {took / (len(starts) * BEAMS) * 1e9:6.1f} ns a beam, {took / own:5.2f} times the time of "
        f"this package; built in {built:.2f} s; {errors(grid, starts, cast(starts))}"
    )


def main() -> None:
    """Runs and prints the benchmarks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("maps", nargs="*", help=f"office, {', '.join(REAL)}; by default all but the last")
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


if __name__ == "__main__":
    main()
