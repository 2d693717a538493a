"""Fixtures of the tests on the real ROS: run them with make test-ros."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from worlds import VERSION, Ros1World, Ros2World, new_world

collect_ignore = {"1": ["test_ros2.py", "test_controller.py"], "2": ["test_ros1.py"]}.get(VERSION, [])


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if VERSION not in ("1", "2"):
        raise pytest.UsageError("these tests need ROS: run them with make test-ros")
    for item in items:
        item.add_marker(pytest.mark.ros)


@pytest.fixture
def world() -> Iterator[Any]:
    with new_world() as world:
        yield world


@pytest.fixture(scope="session", autouse=True)
def _end_all() -> Iterator[None]:
    yield
    Ros1World.end_all()
    Ros2World.end_all()


def room(width: int = 160, height: int = 120, resolution: float = 0.05) -> mrs.OccupancyGrid:
    """A room with two pillars, whose origin lies within it."""
    cells = np.zeros((height, width), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[80:90, 100:110] = cells[20:30, 30:34] = 100
    return mrs.OccupancyGrid(cells, resolution=resolution, origin=(-3.0, -2.0, 0.0))


@pytest.fixture
def map_file(tmp_path: Path) -> Path:
    file = tmp_path / "map.yaml"
    mrs.save_map(room(), file)
    return file


def record_drive(map_file: Path, folder: Path, format: Any) -> Path:
    """The recording of five seconds of a robot that drives in the map."""
    from mobile_robot_simulator.recording.recorder import Recorder

    simulation = mrs.Simulation(mrs.load_map(map_file))
    with Recorder(folder, format=format) as recorder:
        simulation.record(recorder.write)
        simulation.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.2)))
        simulation.run_for(5.0)
    return recorder.path
