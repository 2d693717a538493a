"""Forked processes: grids, scanners and random streams work in them, whatever threads of the parent did during the fork."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")

SETUP = """
import os, pickle, signal, sys, threading, time, warnings
import numpy as np
import mobile_robot_simulator as mrs

warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 and later warn of forks with threads.

FORKS = int(sys.argv[2])
CELLS = (np.random.default_rng(1).random((200, 300)) < 0.01).astype(np.int8) * 100
LASER = mrs.LaserScanner(beam_count=181, max_range=8.0)
POSES = np.random.default_rng(2).uniform(1.0, 9.0, (60, 3))
WALL = np.full((3, 4), 100, np.int8)

def new_grid():
    return mrs.OccupancyGrid(CELLS, resolution=0.05)

def results(grid):
    \"\"\"The bytes of what a process can do with a grid. The grid is the same before and after.\"\"\"
    noise, stream = mrs.BeamModel(sigma_hit=0.1), mrs.RandomStream(7)
    def scan(threads):
        return LASER.scan_batch(grid, POSES, noise=noise, seed=3, threads=threads)
    found = [scan(1), scan(2), scan(None), LASER.scan(grid, POSES[0]), mrs.cast_rays(grid, POSES, 9.0, threads=2)]
    old = grid.cells[7:10, 8:12]
    grid.set_cells(7, 8, WALL)
    found += [scan(2), grid.cells]
    grid.set_cells(7, 8, old)
    found += [scan(2), grid.draw_free_poses(9000, radius=0.1, seed=stream, threads=2), np.uint64(stream.next_index)]
    found.append(np.array(grid.draw_free_pose(radius=0.15, seed=4)))
    found += [pickle.loads(pickle.dumps(grid)).cells, mrs.integrate_twist(POSES, POSES, 0.1)]
    return b"".join(part.tobytes() for part in found)

def fork_and_check(grid, expected):
    \"\"\"Forks; the child ends with status 0 if it has the expected results. A child that hangs is ended by SIGALRM.\"\"\"
    child = os.fork()
    if child == 0:
        status = 1
        try:
            signal.alarm(30)
            status = 0 if results(grid) == expected else 2
        finally:
            os._exit(status)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if status != 0:
        print(f"the child ended with {status}")
        os._exit(1)
"""

FORKS_WITH_BUSY_THREADS = (
    SETUP
    + """
expected = results(new_grid())
grid = new_grid()
ends = threading.Event()
fresh = [new_grid()]  # A grid that is being scanned for the first time, or is about to be.

def nothing():
    ends.wait()

def scan():
    LASER.scan_batch(grid, POSES, threads=2)

def scan_on_one_thread():
    LASER.scan_batch(grid, POSES, threads=1)

def first_scan():
    fresh[0] = new_grid()
    LASER.scan_batch(fresh[0], POSES, threads=1)

def prepare():
    fresh[0] = new_grid()
    fresh[0].prepare()

def set_cells():
    # Leaves the grid as it is.
    grid.set_cells(0, 0, CELLS)

def draw():
    fresh[0] = new_grid()
    fresh[0].draw_free_poses(9000, radius=0.1, seed=1, threads=2)

def draw_again():
    for _ in range(100):
        grid.draw_free_pose(radius=0.1, seed=1)

def start_pools():
    for threads in (2, 3, 4, 5, 6):
        LASER.scan_batch(grid, POSES, threads=threads)

def take_cells():
    grid.set_cells(0, 0, CELLS[:1])
    grid.cells

def pickle_it():
    pickle.loads(pickle.dumps(grid))

def simulate():
    sim = mrs.Simulation(grid, start=grid.draw_free_pose(radius=0.2, seed=1))
    sim.add_obstacle(mrs.Shape.disc(0.2), (1.0, 1.0, 0.0))
    sim.run_for(0.2)

def go_on(work):
    while not ends.is_set():
        work()

work = globals()[sys.argv[1]]
busy = [threading.Thread(target=go_on, args=(work,), daemon=True) for _ in range(2)]
for thread in busy:
    thread.start()
for _ in range(FORKS):
    time.sleep(np.random.default_rng(os.getpid() + time.monotonic_ns()).uniform(0.0, 0.004))
    fork_and_check(fresh[0] if work in (first_scan, prepare, draw) else grid, expected)
ends.set()
for thread in busy:
    thread.join()
assert results(grid) == expected
print("done")
"""
)

BUSY = [
    "nothing",
    "scan",
    "scan_on_one_thread",
    "first_scan",
    "prepare",
    "set_cells",
    "draw",
    "draw_again",
    "start_pools",
    "take_cells",
    "pickle_it",
    "simulate",
]


FORK_DURING_A_LONG_SCAN = (
    SETUP
    + """
expected = results(new_grid())
grid, poses = new_grid(), np.tile(POSES, (2000, 1))
out = np.zeros((len(poses), LASER.beam_count), np.float32)
scan = threading.Thread(target=lambda: LASER.scan_batch(grid, poses, threads=2, out=out), daemon=True)
scan.start()
while not out[0].any():
    time.sleep(0.001)
for _ in range(FORKS):
    if os.fork() == 0:
        os._exit(0)
    os.wait()
assert not out[-1].any(), "the scan has ended"
fork_and_check(grid, expected)
scan.join()
assert np.array_equal(out.reshape(2000, -1), np.tile(out[: len(POSES)].reshape(1, -1), (2000, 1)))
print("done")
"""
)

POOLS = (
    SETUP.replace("sys.argv[2]", "2")
    + """
import multiprocessing
from concurrent.futures import ProcessPoolExecutor

class Scans:
    \"\"\"What a data loader takes: a length, and an item for each index.\"\"\"
    def __init__(self, grid):
        self.grid = grid
    def __len__(self):
        return 12
    def __getitem__(self, index):
        return results(self.grid) + np.int64(index).tobytes()

def load(scans, indices, items):
    \"\"\"The loop of a worker of a data loader.\"\"\"
    for index in iter(indices.get, None):
        items.put((index, scans[index]))

def main():
    context = multiprocessing.get_context(sys.argv[1])
    grid, ends = new_grid(), threading.Event()
    expected = results(grid)

    def keep_busy():
        while not ends.is_set():
            LASER.scan_batch(grid, POSES, threads=2)
            grid.set_cells(0, 0, CELLS)

    threading.Thread(target=keep_busy, daemon=True).start()
    with context.Pool(2) as pool:
        assert pool.map(results, [grid] * 4) == [expected] * 4
    with ProcessPoolExecutor(2, mp_context=context) as executor:
        assert list(executor.map(results, [grid] * 4)) == [expected] * 4
    scans, indices, items = Scans(grid), context.Queue(), context.Queue()
    workers = [context.Process(target=load, args=(scans, indices, items), daemon=True) for _ in range(3)]
    for worker in workers:
        worker.start()
    for index in range(len(scans)):
        indices.put(index)
    loaded = dict(items.get(timeout=60) for _ in range(len(scans)))
    assert loaded == {index: expected + np.int64(index).tobytes() for index in range(len(scans))}
    for worker in workers:
        indices.put(None)
    for worker in workers:
        worker.join(60)
        assert worker.exitcode == 0
    ends.set()
    print("done")

if __name__ == "__main__":
    main()
"""
)


def run(command: list[str]) -> None:
    ran = subprocess.run([sys.executable, *command], capture_output=True, text=True, timeout=240)
    assert (ran.returncode, ran.stdout) == (0, "done\n"), ran.stdout + ran.stderr


@pytest.mark.parametrize("work", BUSY)
def test_a_child_has_the_results_of_its_parent_whatever_threads_did_during_the_fork(work: str) -> None:
    run(["-c", FORKS_WITH_BUSY_THREADS, work, "100" if work == "nothing" else "8"])


def test_a_fork_does_not_wait_for_a_scan() -> None:
    run(["-c", FORK_DURING_A_LONG_SCAN, "", "5"])


@pytest.mark.parametrize("start_method", ["fork", "spawn"])
def test_pools_and_workers_of_data_loaders_have_the_results_of_their_parent(start_method: str, tmp_path: Path) -> None:
    script = tmp_path / "pools.py"  # A process that is spawned reads it.
    script.write_text(POOLS)
    run([str(script), start_method])
