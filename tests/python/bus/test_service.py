"""Services and clients."""

from __future__ import annotations

from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode

SECOND = 1_000_000_000


def crash(message: object = None) -> None:
    raise RuntimeError("out of coffee")


def answer(request: Any, response: Any) -> Any:
    response.map.info.width = 7
    return response


def test_the_response_arrives_after_the_caller_has_returned(bus: Bus, node: BusNode) -> None:
    node.create_service(mrs.messages.GetMap, "/static_map", answer)
    client = node.create_client(mrs.messages.GetMap, "static_map")
    assert client.service_is_ready() and client.wait_for_service(timeout_sec=1.0)
    future = client.call_async(mrs.messages.GetMap.Request())
    called: list[Any] = []
    future.add_done_callback(called.append)
    assert not future.done() and future.result() is None and called == []
    bus.run_until(0)
    assert future.done() and future.result().map.info.width == 7 and called == [future]
    future.add_done_callback(called.append)
    assert called == [future, future]


def test_a_call_without_a_server_never_completes(bus: Bus, node: BusNode) -> None:
    client = node.create_client(mrs.messages.GetMap, "/static_map")
    assert not client.service_is_ready() and not client.wait_for_service(timeout_sec=1.0)
    future = client.call_async(mrs.messages.GetMap.Request())
    bus.run_until(SECOND)
    assert not future.done()
    service = node.create_service(mrs.messages.GetMap, "/static_map", answer)
    assert client.service_is_ready()
    node.destroy_service(service)
    assert not client.service_is_ready()


def test_a_service_has_one_type_and_one_server(node: BusNode) -> None:
    assert isinstance(mrs.messages.GetMapRequest(), mrs.messages.GetMap.Request)
    node.create_service(mrs.messages.GetMap, "/static_map", answer)
    with pytest.raises(ValueError, match="/static_map"):
        node.create_service(mrs.messages.GetMap, "/static_map", answer)
    with pytest.raises(TypeError, match="/static_map"):
        node.create_client(mrs.messages.Twist, "/static_map")
    with pytest.raises(TypeError, match="GetMapRequest, got Twist"):
        node.create_client(mrs.messages.GetMap, "/static_map").call_async(mrs.messages.Twist())


def test_an_exception_in_a_service_is_raised_by_the_run(bus: Bus, node: BusNode) -> None:
    node.create_service(mrs.messages.GetMap, "/static_map", lambda request, response: crash())
    node.create_client(mrs.messages.GetMap, "/static_map").call_async(mrs.messages.GetMap.Request())
    with pytest.raises(RuntimeError, match="out of coffee"):
        bus.run_until(0)


def test_a_blocking_call_is_refused(node: BusNode) -> None:
    client = node.create_client(mrs.messages.GetMap, "/static_map")
    with pytest.raises(RuntimeError, match="use call_async"):
        client.call(mrs.messages.GetMap.Request())
