"""Signals during long calls of the core: Ctrl-C ends a call soon, handlers run meanwhile, and the next call works."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot send SIGINT to one process")

SETUP = """
import os, signal, sys, threading, time
import numpy as np
import mobile_robot_simulator as mrs

threads = int(sys.argv[2])
cells = (np.random.default_rng(1).random((200, 300)) < 0.01).astype(np.int8) * 100
grid = mrs.OccupancyGrid(cells, resolution=0.05)
laser = mrs.LaserScanner(beam_count=541)
poses = np.random.default_rng(2).uniform(1.0, 9.0, (20_000, 3))
noise = mrs.BeamModel(sigma_hit=0.1)
"""

# With this many obstacles, each of the two calls takes from half a minute to minutes.
CTRL_C = (
    SETUP
    + """
obstacles = [(mrs.Shape.disc(0.01), (x, y, 0.0)) for x, y in np.random.default_rng(3).uniform(0.0, 15.0, (20_000, 2))]

def scan_batch(count, out):
    ranges = out[: count * 541].reshape(-1, 541)
    laser.scan_batch(grid, poses[:count], obstacles=obstacles, noise=noise, seed=1, threads=threads, out=ranges)

def cast_rays(count, out):
    rays = np.tile(poses, (200, 1))[: 200 * count]
    mrs.cast_rays(grid, rays, 9.0, obstacles=obstacles, threads=threads, out=out[: 200 * count])

call = globals()[sys.argv[1]]
size = {"scan_batch": 541, "cast_rays": 200}[sys.argv[1]]
out = np.full(len(poses) * size, -7.0, np.float32)

def tell_when_it_runs():
    while out[0] == -7.0:
        time.sleep(0.01)
    print("runs", flush=True)

threading.Thread(target=tell_when_it_runs, daemon=True).start()
try:
    call(len(poses), out)
except KeyboardInterrupt:
    print("KeyboardInterrupt", flush=True)
assert out[0] != -7.0 and (out == -7.0).mean() > 0.5
again = np.empty_like(out)
call(10, again)
is_done = out[: 10 * size] != -7.0
assert is_done.any() and (again[: 10 * size] == out[: 10 * size])[is_done].all()
print("works")
"""
)

# Handlers run at most every 50 ms, and a test counts two during a call. So each call takes at least 0.2 s.
HANDLERS = (
    SETUP
    + """
class Raised(Exception):
    pass

count = 0
may_raise = False

def handle(number, frame):
    global count
    count += 1
    if may_raise:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        # A handler may use what the interrupted call is using.
        assert laser.scan(used, poses[0]).tobytes() == scan
        raise Raised

def integrate_twist(grid):
    return mrs.integrate_twist(many, many, 0.1)

def prepare(grid):
    grid.prepare()
    return poses

def first_draw(grid):
    return grid.draw_free_poses(100, radius=0.3, seed=1, threads=threads)

def draw(grid):
    return grid.draw_free_poses(12_000_000, radius=0.3, seed=1, threads=threads)

def scan_batch(grid):
    return laser.scan_batch(grid, many[:100_000], noise=noise, seed=1, threads=threads, out=out)

def cast_rays(grid):
    return mrs.cast_rays(grid, many, 9.0, obstacles=obstacles, threads=threads)

call = globals()[sys.argv[1]]
many = np.tile(poses, (500, 1)) if call in (integrate_twist, cast_rays) else np.tile(poses, (10, 1))
out = np.empty((100_000, 541), np.float32) if call is scan_batch else None
obstacles = [(mrs.Shape.disc(0.01), (x, y, 0.0)) for x, y in np.random.default_rng(3).uniform(0.0, 15.0, (100, 2))]
large = np.tile(cells, {prepare: (48, 30), first_draw: (4, 4)}.get(call, (1, 1)))

def new_grid():
    return mrs.OccupancyGrid(large, resolution=0.05)

expected, scan = call(new_grid()).tobytes(), laser.scan(new_grid(), poses[0]).tobytes()
signal.signal(signal.SIGALRM, handle)

used = new_grid()
signal.setitimer(signal.ITIMER_REAL, 0.02, 0.02)
found = call(used)
during, _ = count, signal.setitimer(signal.ITIMER_REAL, 0.0)
assert found.tobytes() == expected and laser.scan(used, poses[0]).tobytes() == scan
assert during >= 2, f"{during} calls of the handler"

used, count, may_raise = new_grid(), 0, True
signal.setitimer(signal.ITIMER_REAL, 0.02, 0.02)
try:
    call(used)
except Raised:
    print("raised")
assert call(used).tobytes() == expected and laser.scan(used, poses[0]).tobytes() == scan

# On other threads, no handler runs, and none is needed.
results = []
thread = threading.Thread(target=lambda: results.append(call(new_grid()).tobytes()))
thread.start()
thread.join()
assert results == [expected]
print("works")
"""
)


@pytest.mark.parametrize("threads", ["1", "2"])
@pytest.mark.parametrize("call", ["scan_batch", "cast_rays"])
def test_ctrl_c_ends_a_long_call(call: str, threads: str) -> None:
    command = [sys.executable, "-c", CTRL_C, call, threads]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout and process.stdout.readline() == "runs\n"
            process.send_signal(signal.SIGINT)
            printed, errors = process.communicate(timeout=30)
        finally:
            process.kill()
    assert (printed, process.returncode) == ("KeyboardInterrupt\nworks\n", 0), errors


@pytest.mark.parametrize("threads", ["1", "2"])
@pytest.mark.parametrize("call", ["scan_batch", "cast_rays", "integrate_twist", "prepare", "first_draw", "draw"])
def test_signal_handlers_run_during_a_call_and_may_end_it(call: str, threads: str) -> None:
    command = [sys.executable, "-c", HANDLERS, call, threads]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert (ran.stdout, ran.returncode) == ("raised\nworks\n", 0), ran.stderr
