"""The command, and a map to run it on."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

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


@pytest.fixture
def drive_for_ever(room: Path, tmp_path: Path) -> Iterator[Callable[..., "subprocess.Popen[str]"]]:
    """Starts `run` without an end into the folder `out`, and returns its process once messages are on the disk."""
    processes = []

    def start(*arguments: object, **options: Any) -> "subprocess.Popen[str]":
        out = tmp_path / "out"
        words = [sys.executable, "-m", "mobile_robot_simulator", "run", room, "--duration", 1e6, "--out", out, *arguments]
        pipe = subprocess.PIPE
        process = subprocess.Popen([*map(str, words)], stdout=pipe, stderr=pipe, text=True, **options)
        processes.append(process)
        deadline = time.monotonic() + 60.0
        # An empty recording has a few kilobytes. The writer's chunks have a megabyte.
        while not any(file.stat().st_size > 1_500_000 for file in out.rglob("recording*") if file.is_file()):
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < deadline
            time.sleep(0.02)
        return process

    yield start
    for process in processes:
        process.kill()
        process.communicate()
