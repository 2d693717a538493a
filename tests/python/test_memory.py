"""memory: where an input decides how much is needed, running out of it raises MemoryError, and the process goes on."""

from __future__ import annotations

import subprocess
import sys

import pytest

resource = pytest.importorskip("resource", reason="the memory of a process can be limited where this module is")

START = """
import resource
import numpy as np
import mobile_robot_simulator as mrs

def vm_size():
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmSize:")) * 1024

def limit(megabytes):
    resource.setrlimit(resource.RLIMIT_AS, (vm_size() + megabytes * 10**6,) * 2)

def needs(bytes, call):
    try:
        call()
    except MemoryError as error:
        assert f"need {bytes} bytes" in str(error), error
    else:
        raise AssertionError("there was enough memory")

def needs_for(what, call):
    try:
        call()
    except MemoryError as error:
        assert f"not enough memory for {what}, which need " in str(error), error
    else:
        raise AssertionError("there was enough memory")

def runs_out(call):
    needs_for("the obstacles", call)

def view(shape, dtype):  # It takes no memory, however large it is.
    return np.broadcast_to(np.zeros((), dtype), shape)

small = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
laser = mrs.LaserScanner(beam_count=3, max_range=5.0)
laser.scan_batch(small, np.zeros((10000, 3)), threads=2)
"""

CASES = {
    "a grid": """
limit(100)
needs(18000**2, lambda: mrs.OccupancyGrid(view((18000, 18000), np.int8), resolution=1.0))
""",
    "new cells": """
limit(100)
needs(20000**2, lambda: small.set_cells(0, 0, view((20000, 20000), np.int8)))
""",
    "the cells of a grid": """
grid = mrs.OccupancyGrid(np.zeros((6000, 6000), np.int8), resolution=1.0)
limit(20)
needs(36000000, lambda: grid.cells)
""",
    "a change of a copied grid": """
import copy
grid = mrs.OccupancyGrid(np.zeros((6000, 6000), np.int8), resolution=1.0)
other = copy.copy(grid)
limit(20)
needs(36000000, lambda: other.set_cells(0, 0, np.array([[100]], np.int8)))
del grid
other.set_cells(0, 0, np.array([[100]], np.int8))
""",
    "free boxes": """
grid = mrs.OccupancyGrid(np.zeros((4000, 4000), np.int8), resolution=1.0)
limit(60)
bytes = 8 * 4002**2
needs(bytes, grid.prepare)
needs(bytes, lambda: laser.scan(grid, (0.5, 0.5, 0.0)))
needs(bytes, lambda: laser.scan_batch(grid, [(0.5, 0.5, 0.0)]))
needs(bytes, lambda: mrs.cast_rays(grid, [(0.5, 0.5, 0.0)], 5.0))
""",
    "free places": """
grid = mrs.OccupancyGrid(np.zeros((4000, 4000), np.int8), resolution=1.0)
limit(50)
needs(4 * 4000**2, lambda: grid.draw_free_pose(radius=0.5, seed=1))
needs(4 * 4000**2, lambda: grid.draw_free_poses(10, radius=0.5, seed=1))
""",
    "poses of a batch": """
limit(100)
needs(24 * 10**8, lambda: laser.scan_batch(small, view((10**8, 3), np.float64)))
needs(24 * 10**8, lambda: mrs.cast_rays(small, view((10**8, 3), np.float64), 5.0))
""",
    "motion": """
few = np.zeros((2000000, 3))
limit(30)
needs(48000000, lambda: mrs.integrate_twist(few, few, 1.0))
needs(24 * 10**8, lambda: mrs.integrate_twist(view((10**8, 3), np.float64), few, 1.0))
""",
    "likelihoods and readings": """
limit(100)
needs(8 * 10**9, lambda: mrs.BeamModel().likelihood(view((10**9,), np.float32), view((10**9,), np.float32), 5.0))
needs(4 * 10**9, lambda: laser.end_points((0.0, 0.0, 0.0), view((10**9,), np.float32)))
""",
    "obstacles": """
disc, square = mrs.Shape.disc(0.2), mrs.Shape.rectangle(0.2, 0.2)
discs, squares = [(disc, (3.0, 3.0, 0.0))] * 300000, [(square, (3.0, 3.0, 0.0))] * 300000
limit(30)
runs_out(lambda: laser.scan(small, (0.5, 0.5, 0.0), obstacles=discs))
runs_out(lambda: mrs.cast_rays(small, [(0.5, 0.5, 0.0)], 5.0, obstacles=discs))
runs_out(lambda: mrs.touches(small, disc, (0.5, 0.5, 0.0), obstacles=squares))
""",
    "obstacles in view": """
discs = [(mrs.Shape.disc(0.2), (3.0, 3.0, 0.0))] * 100000
hard, used = resource.RLIM_INFINITY, vm_size()
for megabytes in range(1, 80, 2):
    resource.setrlimit(resource.RLIMIT_AS, (used + megabytes * 10**6, hard))
    try:
        laser.scan(small, (0.5, 0.5, 0.0), obstacles=discs)
        break
    except MemoryError as error:
        assert "not enough memory for the obstacles" in str(error), error
assert megabytes > 9
""",
    "walls near a footprint": """
cells = np.zeros((1000, 1000), np.int8)
cells[::2, ::2] = 100
grid = mrs.OccupancyGrid(cells, resolution=1.0)
huge, here = mrs.Shape.rectangle(9000.0, 1.0), (0.0, -1.0, 0.0)
limit(20)
needs_for("the walls and obstacles near a footprint", lambda: mrs.touches(grid, huge, here))
needs_for("the walls and obstacles near a footprint", lambda: mrs.advance(grid, huge, here, (0.0, 1.0, 0.0), 1.0))
needs_for("the walls and obstacles near a footprint", lambda: mrs.clearance(grid, huge, here, limit=1.0))
needs_for("the walls and obstacles near a footprint", lambda: mrs.clearance_batch(grid, huge, [here] * 5000, limit=1.0))
""",
    "beams from off the grid": """
fine = mrs.LaserScanner(beam_count=1000000)
out = np.zeros((1, 1000000), np.float32)
fine.scan_batch(small, [(1.0, 1.0, 0.0)], threads=1, out=out)
limit(20)
needs_for("the beams", lambda: fine.scan_batch(small, [(-9.0, 1.0, 0.0)], threads=1, out=out))
""",
    "beams": """
limit(4)
needs(8000000, lambda: mrs.LaserScanner(beam_count=1000000))
""",
    "results that NumPy allocates": """
limit(100)
poses = np.zeros((100000, 3))
for call in (
    lambda: mrs.LaserScanner(beam_count=10000).scan_batch(small, poses),
    lambda: small.draw_free_poses(10**9, radius=0.1, seed=1),
    lambda: laser.mark_invalid(view((10**9,), np.float32)),
    lambda: laser.scan_batch(small, view((10**9, 3), np.float32)),
):
    try:
        call()
    except MemoryError:
        continue
    raise AssertionError("there was enough memory")
""",
}

WORKS = """
assert laser.scan(small, (0.5, 0.5, 0.0)).tolist() == [5.0, 5.0, 5.0]
print("goes on")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not enforce the limit")
@pytest.mark.parametrize("case", CASES)
def test_the_process_survives(case: str) -> None:
    script = START + CASES[case] + WORKS
    ran = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False)
    assert (ran.returncode, ran.stdout.strip()) == (0, "goes on"), ran.stderr[-2000:]
