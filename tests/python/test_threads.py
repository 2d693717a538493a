"""threads: how many threads a process has after calls with `threads=`, and that no result depends on it."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs

COUNT = """
import os, sys, time
import numpy as np
import mobile_robot_simulator as mrs

grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
grid.prepare()
laser = mrs.LaserScanner(beam_count=101, max_range=5.0)
poses = np.zeros((100, 3))
count = lambda: len(os.listdir("/proc/self/task"))

first = laser.scan_batch(grid, poses, threads=1).tobytes()
before = count()
for threads in range(2, 41):
    assert laser.scan_batch(grid, poses, threads=threads).tobytes() == first
bound = before + 40 + 39 + 38 + 37
until = time.monotonic() + 20.0
while count() > bound and time.monotonic() < until:  # A pool that ends does not wait for its threads.
    time.sleep(0.01)
print(count() - bound)

names = lambda: set(os.listdir("/proc/self/task"))
kept = names()
for threads in [40, 37, 39, 38] * 5:
    laser.scan_batch(grid, poses, threads=threads)
print(names() == kept)
"""


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="the threads of a process are listed there")
def test_a_process_keeps_the_threads_of_four_pools_and_uses_them_again() -> None:
    ran = subprocess.run([sys.executable, "-c", COUNT], capture_output=True, text=True, timeout=120, check=False)
    surplus, same = ran.stdout.split() or [ran.stderr, ""]
    assert int(surplus) <= 0 and same == "True", ran.stderr


def scans(threads: int) -> bytes:
    grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
    return mrs.LaserScanner(beam_count=101, max_range=5.0).scan_batch(grid, np.zeros((100, 3)), threads=threads).tobytes()


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="this system cannot fork")
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_forked_process_starts_its_own_pools() -> None:
    """It inherits pools without threads, and needs more pools than are kept."""
    counts = [2, 3, 4, 5]
    expected = [scans(threads) for threads in counts]
    with multiprocessing.get_context("fork").Pool(1) as pool:
        found = pool.map_async(scans, [*counts, 6, 7, *counts]).get(timeout=60)
    assert found == [*expected, expected[0], expected[0], *expected]
