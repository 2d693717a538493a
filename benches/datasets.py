"""Benchmark of data sets: time, size and memory of many noisy beams, compared with a plain loop.

Run: python benches/datasets.py [--beams N] [--folder DIR]. Each way runs in a process of its own, in turns, and writes to a
new folder, which is removed. Peak memory is that of the whole process, including Python and NumPy.

CPU is the time of all cores, which a busy machine and a slow disk change little.

- cast: `scan_batch` without writing, which is what the other ways cannot be faster than;
- loop: a plain loop of `draw_free_poses`, `scan_batch` and `numpy.save`; it does not flush files to the disk;
- the others: `datasets.generate`, which flushes each file to the disk, so that no kill or loss of power leaves a part.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator import datasets

BEAMS = 541
SHARD = 16384
SEED = 1
TURNS = 3
SIGMA = 0.01
WAYS: dict[str, dict[str, Any]] = {
    "cast": {},
    "loop": {},
    "zarr, no compression": {"compression": "none"},
    "zarr, lz4": {"compression": "lz4"},
    "zarr, lz4, 1/1024 m": {"compression": "lz4", "quantization": 0.001},
    "zarr, zstd, 1/1024 m": {"compression": "zstd", "quantization": 0.001},
}


def work(way: str, scans: int, folder: Path) -> None:
    """Makes scans in one way, and prints time [s], time of all cores [s], size [bytes] and peak memory [bytes] as JSON."""
    began, busy = time.perf_counter(), time.process_time()
    if way in ("cast", "loop"):
        grid, laser = mrs.floor_plan("office", seed=SEED), mrs.LaserScanner(beam_count=BEAMS)
        noise = mrs.BeamModel(sigma_hit=SIGMA)
        for first in range(0, scans, SHARD):
            count = min(SHARD, scans - first)
            poses = grid.draw_free_poses(count, radius=0.3, seed=SEED, first_index=first)
            ranges = laser.scan_batch(grid, poses, noise=noise, seed=SEED, first_index=first)
            if way == "loop":
                np.save(folder / f"{first}.npy", ranges)
    else:
        plan = datasets.Plan(
            count=scans,
            seed=SEED,
            maps=[{"floor_plan": "office", "seeds": SEED}],
            scanner={"beam_count": BEAMS},
            noise={"sigma_hit": SIGMA},
            scans_per_scene=1024,
            scans_per_shard=SHARD,
            **WAYS[way],
        )
        datasets.generate(plan, out=folder / "data")
    taken = time.perf_counter() - began
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps({"seconds": taken, "cpu": time.process_time() - busy, "bytes": size, "peak": peak}))


def main() -> None:
    """Runs all ways in turns and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--beams", type=float, default=1e8, help="number of beams")
    parser.add_argument("--folder", type=Path, help="where to write; default the folder for temporary files")
    parser.add_argument("--turns", type=int, default=TURNS, help="number of times that each way runs")
    parser.add_argument("--ways", nargs="*", choices=WAYS, default=list(WAYS), help="ways to run")
    parser.add_argument("--work", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.work:
        way, scans, folder = arguments.work
        work(way, int(scans), Path(folder))
        return
    scans = round(arguments.beams / BEAMS)
    print(f"{mrs.__version__}, Python {platform.python_version()}, {os.cpu_count()} cores, {platform.machine()}")
    print(f"{scans} scans of {BEAMS} noisy beams in a floor plan; median of {arguments.turns} turns")
    found: dict[str, list[dict[str, float]]] = {way: [] for way in arguments.ways}
    for _ in range(arguments.turns):
        for way in arguments.ways:
            with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
                command = [sys.executable, __file__, "--work", way, str(scans), folder]
                ran = subprocess.run(command, check=True, capture_output=True, text=True)
            found[way].append(json.loads(ran.stdout))
    beams = scans * BEAMS
    medians = {way: statistics.median(each["seconds"] for each in runs) for way, runs in found.items()}
    print(f"{'way':<22} {'time [s]':>9} {'to loop':>8} {'casting':>8} {'CPU [s]':>8} {'bytes/beam':>11} {'peak [MB]':>10}")
    for way, runs in found.items():
        to_loop = f"{medians[way] / medians['loop']:.2f}" if "loop" in medians else ""
        casting = f"{medians['cast'] / medians[way]:.0%}" if "cast" in medians else ""
        cpu = statistics.median(each["cpu"] for each in runs)
        size, peak = runs[0]["bytes"] / beams, max(each["peak"] for each in runs) / 1e6
        print(f"{way:<22} {medians[way]:>9.2f} {to_loop:>8} {casting:>8} {cpu:>8.2f} {size:>11.3f} {peak:>10.0f}")


if __name__ == "__main__":
    main()
