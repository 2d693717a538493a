"""The command, and a map to run it on."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs


@pytest.fixture
def command() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Runs the command in its own process, as users do."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "mobile_robot_simulator", *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=120,
            env={**os.environ, "COLUMNS": "200", "NO_COLOR": "1"},
        )

    return run


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """The file of a map with four walls, 6 m x 4 m."""
    cells = np.zeros((80, 120), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    file = tmp_path / "room.yaml"
    mrs.save_map(mrs.OccupancyGrid(cells, resolution=0.05), file)
    return file
