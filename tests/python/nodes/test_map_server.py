"""Map servers: the map on a service and on a latched topic."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.nodes.map_messages import to_message
from mobile_robot_simulator.nodes.map_server import MapFileServer
from mobile_robot_simulator.parameters import MapParameters

CELLS = np.array([[0, 100, -1], [59, 60, 1]], np.int8)


@pytest.fixture
def grid() -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(CELLS, resolution=0.05, origin=(1.0, -2.0, 0.3))


def test_the_server_answers_requests_and_publishes_a_latched_map(grid: mrs.OccupancyGrid) -> None:
    bus = Bus()
    server = mrs.nodes.MapServer(NoCopyNode(bus, "map_server"), grid, topic="/floor", service="/floor_map", frame_id="world")
    client = NoCopyNode(bus, "client")
    assert bus.latest("/floor") is None
    server.start()
    server.start()
    bus.run_until(5)
    seen: list[Any] = []
    client.create_subscription(messages.OccupancyGrid, "/floor", seen.append)
    future = client.create_client(mrs.messages.GetMap, "/floor_map").call_async(mrs.messages.GetMap.Request())
    bus.run_until(6)
    assert seen == [to_message(grid, "world")]
    assert future.result() == messages.GetMapResponse(to_message(grid, "world"))


def test_a_server_can_be_stopped_and_started_again(grid: mrs.OccupancyGrid) -> None:
    bus = Bus()
    server = mrs.nodes.MapServer(NoCopyNode(bus, "map_server"), grid)
    server.stop()
    server.start()
    server.stop()
    server.stop()
    client = NoCopyNode(bus, "client").create_client(mrs.messages.GetMap, "/static_map")
    assert not client.service_is_ready()
    server.start()
    assert client.service_is_ready()


def hall(side: int = 100) -> mrs.OccupancyGrid:
    cells = np.zeros((side, side), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1, origin=(-side / 20, -side / 20, 0.0))


def test_a_file_server_can_change_its_file(tmp_path: Path) -> None:
    for side in (40, 60):
        mrs.save_map(hall(side), tmp_path / f"{side}.yaml")
    sim = mrs.Simulation(hall(100), parameters={"map_topic": ""})
    node = sim.create_node("files")
    names = {"topic_name": "/other_map", "service_name": "/other"}
    server = MapFileServer(node, MapParameters(yaml_filename=f"{tmp_path}/40.yaml", **names))  # type: ignore[arg-type]
    server.start()
    with pytest.raises(OSError, match="absent"):
        server.set_parameters(yaml_filename=f"{tmp_path}/absent.yaml")
    assert sim.latest("/other_map").info.width == 40
    server.set_parameters(yaml_filename=f"{tmp_path}/60.yaml")
    assert sim.latest("/other_map").info.width == 60
