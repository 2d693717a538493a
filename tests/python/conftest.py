"""What all tests share."""

from __future__ import annotations

import signal

import numpy as np
import pytest
from hypothesis import settings

import mobile_robot_simulator as mrs

settings.register_profile("repeatable", derandomize=True, deadline=None, database=None, max_examples=60)
settings.load_profile("repeatable")

# A shell that starts `make test &` has SIGINT ignored, which processes inherit. Tests that send SIGINT need it to be heard.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def post() -> mrs.OccupancyGrid:
    """5x5 cells of 1 m of which only (2, 2) blocks."""
    cells = np.zeros((5, 5), np.int8)
    cells[2, 2] = 100
    return mrs.OccupancyGrid(cells, resolution=1.0)


@pytest.fixture
def room() -> mrs.OccupancyGrid:
    """A closed room of 20x16 m, 0.1 m cells, around the origin, with a pillar that is not in its middle."""
    cells = np.zeros((160, 200), np.int8)
    cells[[0, -1], :] = 100
    cells[:, [0, -1]] = 100
    cells[100:110, 120:130] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-10.0, -8.0, 0.0))
