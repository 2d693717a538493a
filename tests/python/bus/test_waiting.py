"""Waits: they run the bus outside a run, and none of them is endless."""

from __future__ import annotations

from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode

SECOND = 1_000_000_000
Trigger = mrs.messages.Trigger


def answer(request: Any, response: Any) -> Any:
    return response


def test_a_wait_outside_a_run_ends_when_the_service_is_there(bus: Bus, node: BusNode) -> None:
    client = node.create_client(Trigger, "/go")
    bus.schedule(3 * SECOND, lambda: node.create_service(Trigger, "/go", answer))
    assert not client.wait_for_service(timeout_sec=1.0) and bus.time_ns == SECOND
    assert client.wait_for_service(timeout_sec=10.0) and bus.time_ns == 3 * SECOND
    assert client.wait_for_service() and bus.time_ns == 3 * SECOND


@pytest.mark.parametrize(("timeout", "tries"), [(1.0, 300), (7.0, 43), (0.0, 101), (None, 1), (-1.0, 1)])
def test_a_loop_that_waits_for_a_missing_service_ends_with_an_error(bus, node, timeout, tries) -> None:
    client, tried = node.create_client(Trigger, "/go"), 0
    with pytest.raises(RuntimeError, match=r"service /go .*: spawn the node that offers it before this one"):
        while True:
            tried += 1
            assert not client.wait_for_service(timeout)
    assert tried == tries
    bus.run_until(bus.time_ns + 1)
    assert not client.wait_for_service(1.0)


@pytest.mark.parametrize(("timeout", "tries"), [(1.0, 101), (None, 1)])
def test_a_callback_does_not_wait_and_its_loop_ends_with_an_error(bus, node, timeout, tries) -> None:
    client, tried = node.create_client(Trigger, "/go"), 0

    def loop() -> None:
        nonlocal tried
        while not client.wait_for_service(timeout):
            assert bus.time_ns == SECOND
            tried += 1

    node.create_timer(1.0, loop)
    with pytest.raises(RuntimeError, match="stands still: spawn the node"):
        bus.run_until(SECOND)
    assert tried == tries - 1


def test_a_callback_that_asks_once_per_period_is_not_a_loop(bus: Bus, node: BusNode) -> None:
    client = node.create_client(Trigger, "/go")
    future = client.call_async(Trigger.Request())
    asked = list[bool]()
    node.create_timer(0.1, lambda: asked.append(client.wait_for_service(1.0) or future.done()))
    bus.run_until(100 * SECOND)
    assert asked == [False] * 1000


def test_a_loop_that_asks_whether_a_response_is_there_ends_with_an_error(bus: Bus, node: BusNode) -> None:
    node.create_service(Trigger, "/go", answer)
    client = node.create_client(Trigger, "/go")

    def loop() -> None:
        future = client.call_async(Trigger.Request())
        while not future.done():
            pass

    node.create_timer(1.0, loop)
    with pytest.raises(RuntimeError, match=r"asked for the response of /go 100 times .*: use add_done_callback or await"):
        bus.run_until(SECOND)


def test_a_clock_sleeps_outside_callbacks_only(bus: Bus, node: BusNode) -> None:
    clock = node.get_clock()
    assert clock.sleep_for(mrs.instant.Duration(seconds=1.5)) and bus.time_ns == 1_500_000_000
    assert clock.sleep_until(mrs.instant.Instant()) and bus.time_ns == 1_500_000_000
    node.create_timer(1.0, lambda: clock.sleep_for(mrs.instant.Duration(seconds=1.0)))
    with pytest.raises(RuntimeError, match=r"must not sleep.*use a timer"):
        bus.run_until(3 * SECOND)
    with pytest.raises(RuntimeError, match="use create_timer"):
        node.create_rate(10.0)


def test_a_timer_can_be_created_without_starting_it(bus: Bus, node: BusNode) -> None:
    fired = list[int]()
    timer = node.create_timer(1.0, lambda: fired.append(bus.time_ns), autostart=False)
    bus.run_until(2 * SECOND)
    timer.reset()
    bus.run_until(3 * SECOND)
    assert fired == [3 * SECOND]
