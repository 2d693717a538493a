"""barn: length of paths and optimal times by hand, and files that are none."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.barn_worlds import write_path, write_world
from mobile_robot_simulator.benchmarks import barn_task


def test_the_optimal_time_is_that_of_the_path_with_start_and_goal(tmp_path: Path) -> None:
    """Cell (12, 0) is at (-4.575 + 1.8, 5.075) = (-2.775, 5.075), and (12, 10) 1.5 m above it."""
    task = barn_task(write_world(tmp_path, "world_0", []), write_path(tmp_path, "path_0", [(12, 0), (12, 10)]))
    length = math.hypot(0.525, 2.075) + 1.5 + math.hypot(0.525, 13 - 6.575)
    assert task.optimal_time == pytest.approx(length / 2, abs=1e-12)
    assert (task.name, task.goal, tuple(task.start)) == ("world_0", (-2.25, 13.0), (-2.25, 3.0, 1.57))
    assert (task.tolerance, task.time_limit, task.grid.resolution) == (1.0, 100.0, 0.025)


def test_the_robot_is_the_jackal_and_can_be_changed(tmp_path: Path) -> None:
    files = write_world(tmp_path, "world_0", []), write_path(tmp_path, "path_0", [(12, 0)])
    simulation = barn_task(*files, parameters={"laser_beam_count": 181}).simulation()
    simulation.run_for(0.1)
    assert len(simulation.latest("/scan").ranges) == 181
    assert simulation.truth.clearance == pytest.approx(4.35 / 2 - 0.075 - 0.2078, abs=0.01)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "not a NumPy file"),
        (b"hello", "not a NumPy file"),
        (np.zeros(3), r"a path must be numbers of shape \(N, 2\), got float64 \(3,\)"),
        (np.zeros((3, 2), bool), r"a path must be numbers of shape \(N, 2\), got bool \(3, 2\)"),
        (np.full((3, 2), np.nan), "the cells of a path must be finite"),
        (np.array([[None, 1]], object), "not a NumPy file"),
    ],
)
def test_a_path_that_is_none_is_an_error(tmp_path: Path, data: bytes | np.ndarray, message: str) -> None:
    path = tmp_path / "path_0.npy"
    if isinstance(data, bytes):
        path.write_bytes(data)
    else:
        np.save(path, data, allow_pickle=True)
    with pytest.raises(ValueError, match=f"path_0.npy: {message}"):
        barn_task(write_world(tmp_path, "world_0", []), path)
