"""Benchmarks of `scan_batch` over its whole range: 1 to 10⁶ poses, 1 to 10⁴ beams, one to all threads, and memory.

Run: python benches/scale.py [--threads N]. Each figure is a median. The calls that are compared take turns, so a busy
machine slows all of them. Batches with more than 10⁸ readings are left out. Scans are those of an office, with a maximum
range of 30 m.
"""

from __future__ import annotations

import argparse
import gc
import math
import os
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import mobile_robot_simulator as mrs

POSES = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000]
BEAMS = [1, 10, 100, 1_000, 10_000]
MOST = 10**8
"""Largest number of readings of a batch."""
SECONDS = 0.4
"""Time to spend on each figure, at least."""


def medians(calls: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Returns the median time [s] of each of some calls, which take turns."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for call in calls.values():
        call()
    start = time.perf_counter()
    while len(times[next(iter(calls))]) < 3 or time.perf_counter() - start < SECONDS * len(calls):
        for name, call in calls.items():
            begun = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - begun)
    return {name: statistics.median(found) for name, found in times.items()}


def memory(call: Callable[[], object]) -> float:
    """Returns by how much the peak memory of the process is above its memory before a call [bytes]."""
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")  # forgets the peak
    status = Path("/proc/self/status")
    before = int(status.read_text().split("VmRSS:")[1].split()[0])
    result = call()
    peak = int(status.read_text().split("VmHWM:")[1].split()[0])
    del result
    return 1024.0 * (peak - before)


def main() -> None:
    """Runs all benchmarks and prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)), help="the larger number of threads")
    threads = parser.parse_args().threads
    print(f"Python {platform.python_version()}, NumPy {np.__version__}, {platform.machine()}, {threads} threads")
    grid = mrs.floor_plan("office", seed=1)
    grid.prepare()
    poses = grid.draw_free_poses(POSES[-1], radius=0.1, seed=1)
    print("ns a reading with one thread; times as fast with all; times as fast into a given array; memory beyond the result")
    for count in POSES:
        for beams in BEAMS:
            if count * beams > MOST:
                continue
            laser = mrs.LaserScanner(fov=0.75 * math.tau, beam_count=beams, max_range=30.0)
            chosen, out = poses[:count].copy(), np.empty((count, beams), np.float32)
            times = medians(
                {
                    "one": lambda laser=laser, chosen=chosen: laser.scan_batch(grid, chosen, threads=1),
                    "all": lambda laser=laser, chosen=chosen: laser.scan_batch(grid, chosen, threads=threads),
                    "given": lambda laser=laser, chosen=chosen, out=out: laser.scan_batch(grid, chosen, threads=1, out=out),
                }
            )
            more = memory(lambda laser=laser, chosen=chosen: laser.scan_batch(grid, chosen, threads=threads)) - out.nbytes
            print(
                f"{count:9,d} poses {beams:6,d} beams: {times['one'] / (count * beams) * 1e9:10.1f} ns"
                f" {times['one'] / times['all']:6.2f}x {times['one'] / times['given']:6.2f}x"
                f" {max(more, 0.0) / 2**20:8.1f} MiB",
                flush=True,
            )


if __name__ == "__main__":
    main()
