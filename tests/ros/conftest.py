"""Fixtures of the tests on the real ROS. Run these tests with `make test-ros`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from scenes import room
from worlds import VERSION, Ros1World, Ros2World, new_world

collect_ignore = {"1": ["test_ros2.py", "test_controller.py", "test_rclpy_nodes.py"], "2": ["test_ros1.py", "clients"]}.get(
    VERSION, []
)


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


@pytest.fixture
def map_file(tmp_path: Path) -> Path:
    file = tmp_path / "map.yaml"
    mrs.save_map(room(), file)
    return file
