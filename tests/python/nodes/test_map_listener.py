"""MapListener: the map from a service that may be late or fail, and later maps from a topic."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.handle import Handles
from mobile_robot_simulator.messages import GetMap
from mobile_robot_simulator.nodes.future import Future
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.nodes.map_listener import MapListener
from mobile_robot_simulator.nodes.map_messages import to_message

SECOND = 1_000_000_000


def grid_of(value: int) -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(np.full((3, 4), value, np.int8), resolution=0.5)


class Rig:
    """A listener on its own bus, with the maps that it passes on."""

    def __init__(self, grid: mrs.OccupancyGrid | None = None) -> None:
        self.bus, self.used, self.handles = Bus(), list[mrs.OccupancyGrid](), Handles()
        self.node = NoCopyNode(self.bus, "listener")
        self.server = NoCopyNode(self.bus, "server")
        self.listener = MapListener(self.node, self.used.append, "free", grid)

    def start(self) -> None:
        self.listener.start(topic="/map", service="/static_map", handles=self.handles)

    def publish(self, grid: mrs.OccupancyGrid) -> None:
        self.server.create_publisher(mrs.messages.OccupancyGrid, "/map", QoS.LATCHED).publish(to_message(grid))

    def run_to(self, seconds: float) -> None:
        self.bus.run_until(round(seconds * SECOND))


def test_the_map_is_requested_until_it_arrives_and_later_maps_replace_it() -> None:
    rig = Rig()
    rig.start()
    rig.run_to(5.0)
    assert rig.listener.grid is None
    mrs.nodes.MapServer(rig.server, grid_of(0), topic="/elsewhere").start()
    rig.run_to(6.0)
    rig.publish(grid_of(100))
    rig.publish(grid_of(100))
    rig.run_to(7.0)
    assert [grid.cells[0, 0] for grid in rig.used] == [0, 100]
    assert rig.listener.grid is rig.used[-1]


def test_a_failed_request_is_repeated_after_one_period(monkeypatch: pytest.MonkeyPatch) -> None:
    rig, requests = Rig(), list[float]()

    class Client:
        def service_is_ready(self) -> bool:
            return True

        def call_async(self, request: Any) -> Future:
            requests.append(rig.bus.time_ns / SECOND)
            future = Future()
            future.set_exception(OSError("the server died"))
            return future

    monkeypatch.setattr(rig.node, "create_client", lambda *_: Client())
    rig.start()
    rig.run_to(3.5)
    assert requests == [0.0, 1.0, 2.0, 3.0]
    source = "on topic /map or from service /static_map, whose last call failed: the server died"
    assert rig.listener.find_missing() == {"the map": source}


def test_a_request_without_an_answer_is_repeated_after_ten_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    rig, requests = Rig(), list[float]()

    class Client:
        def service_is_ready(self) -> bool:
            return True

        def call_async(self, request: Any) -> Future:
            requests.append(rig.bus.time_ns / SECOND)
            return Future()

    monkeypatch.setattr(rig.node, "create_client", lambda *_: Client())
    rig.start()
    rig.run_to(25.0)
    assert requests == [0.0, 10.0, 20.0]


def test_a_map_that_is_known_is_not_requested() -> None:
    rig = Rig(grid_of(0))
    rig.server.create_service(GetMap, "/static_map", lambda request, response: pytest.fail("requested"))
    rig.start()
    rig.run_to(3.0)
    assert rig.used == []


def test_nothing_arrives_after_the_handles_are_closed() -> None:
    rig = Rig()
    rig.start()
    rig.handles.close()
    mrs.nodes.MapServer(rig.server, grid_of(0)).start()
    rig.run_to(20.0)
    assert rig.listener.grid is None


def test_the_treatment_of_unknown_cells_can_change() -> None:
    rig = Rig(grid_of(-1))
    rig.listener.set_unknown("free")
    assert rig.used == []
    rig.listener.set_unknown("occupied")
    assert [grid.unknown for grid in rig.used] == ["occupied"]
    rig.start()
    rig.publish(grid_of(0))
    rig.run_to(1.0)
    assert rig.used[-1].unknown == "occupied"


def test_a_restored_listener_has_its_map_again() -> None:
    rig = Rig(grid_of(0))
    state = rig.listener.save()
    rig.listener.set_unknown("occupied")
    rig.listener.restore(state)
    assert rig.listener.grid is state.grid
    assert rig.listener.save() == state
