"""Settings and fixtures of all tests."""

from __future__ import annotations

import signal

import numpy as np
import pytest
from hypothesis import settings

import mobile_robot_simulator as mrs

settings.register_profile("repeatable", derandomize=True, deadline=None, database=None, max_examples=60)
settings.load_profile("repeatable")

# A shell that runs `make test &` makes its child processes ignore SIGINT, and nohup makes them ignore SIGHUP. Tests that
# send these signals need the default handlers.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


@pytest.fixture
def post() -> mrs.OccupancyGrid:
    """A grid of 5x5 cells of 1 m. Only cell (2, 2) blocks."""
    cells = np.zeros((5, 5), np.int8)
    cells[2, 2] = 100
    return mrs.OccupancyGrid(cells, resolution=1.0)


@pytest.fixture
def room() -> mrs.OccupancyGrid:
    """A closed room of 20 m by 16 m around the origin, with cells of 0.1 m and a pillar away from the middle."""
    cells = np.zeros((160, 200), np.int8)
    cells[[0, -1], :] = 100
    cells[:, [0, -1]] = 100
    cells[100:110, 120:130] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-10.0, -8.0, 0.0))
