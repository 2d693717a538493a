"""map node: the map as a message, a service and a latched topic."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.nodes.map_messages import from_message, to_message

CELLS = np.array([[0, 100, -1], [59, 60, 1]], np.int8)


@pytest.fixture
def grid() -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(CELLS, resolution=0.05, origin=(1.0, -2.0, 0.3))


def test_the_message_holds_the_map_field_by_field(grid: mrs.OccupancyGrid) -> None:
    message = to_message(grid, "world")
    assert message.header == mrs.messages.Header(frame_id="world")
    assert (message.info.width, message.info.height, message.info.resolution) == (3, 2, 0.05)
    assert (message.info.origin.position.x, message.info.origin.position.y) == (1.0, -2.0)
    orientation = message.info.origin.orientation
    assert (orientation.x, orientation.y) == (0.0, 0.0)
    assert (orientation.z, orientation.w) == pytest.approx((math.sin(0.15), math.cos(0.15)), abs=1e-15)
    # Row-major from the lower left.
    assert message.data.dtype == np.int8
    assert message.data.tolist() == [0, 100, -1, 59, 60, 1]
    assert type(message.info.width) is int and type(message.info.resolution) is float


def test_a_map_goes_there_and_back(grid: mrs.OccupancyGrid) -> None:
    back = from_message(to_message(grid), unknown="occupied")
    assert np.array_equal(back.cells, grid.cells)
    assert tuple(back.origin) == pytest.approx(tuple(grid.origin), abs=1e-15)
    assert (back.resolution, back.unknown) == (0.05, "occupied")


@pytest.mark.parametrize("data", [[0, 100, -1, 59, 60, 1], (0, 100, -1, 59, 60, 1), CELLS.reshape(-1).astype(np.int64)])
def test_data_may_be_a_list(grid: mrs.OccupancyGrid, data: Any) -> None:
    message = to_message(grid)
    message.data = data
    assert np.array_equal(from_message(message).cells, CELLS)


def broken(**changes: Any) -> messages.OccupancyGrid:
    message = to_message(mrs.OccupancyGrid(CELLS, resolution=0.05))
    for name, value in changes.items():
        if name == "data":
            message.data = value
        elif name == "x":
            message.info.origin.position.x = value
        else:
            setattr(message.info, name, value)
    return message


@pytest.mark.parametrize(
    "message",
    [
        broken(data=np.zeros(5, np.int8)),
        broken(data=np.zeros(0, np.int8)),
        broken(data=np.full(6, 101, np.int8)),
        broken(data=[0, 0, 0, 0, 0, 200]),
        broken(data=np.array([0, 0, 0, 0, 0, 255], np.uint8)),
        broken(data=np.array([0, 0, 0, 0, 0, 0.5])),
        broken(data=["a"] * 6),
        broken(width=0, height=0, data=np.zeros(0, np.int8)),
        broken(width=-3, height=-2),
        broken(width=6, height=2),
        broken(resolution=0.0),
        broken(resolution=math.nan),
        broken(x=math.inf),
    ],
    ids=[
        "short",
        "none",
        "101",
        "list of 200",
        "uint8",
        "float",
        "text",
        "empty",
        "negative",
        "wide",
        "point",
        "nan",
        "inf",
    ],
)
def test_a_map_that_is_none_is_refused(message: messages.OccupancyGrid) -> None:
    with pytest.raises(ValueError):
        from_message(message)


def test_the_server_answers_and_latches(grid: mrs.OccupancyGrid) -> None:
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


def test_a_stopped_server_answers_no_more_and_can_start_again(grid: mrs.OccupancyGrid) -> None:
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
