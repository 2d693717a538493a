"""Async callbacks: they pause at an await and continue when the future is done."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode
from mobile_robot_simulator.nodes.future import Future

SECOND = 1_000_000_000
Trigger = mrs.messages.Trigger


def test_an_async_subscription_and_timer_wait_for_a_service(bus: Bus, node: BusNode) -> None:
    ready, seen = Future(), list[Any]()

    async def answer(request: Any, response: Any) -> Any:
        response.message = await ready
        return response

    client = node.create_client(Trigger, "/go")

    async def ask(*message: Any) -> None:
        seen.append((bus.time_ns, "asks"))
        response = await client.call_async(Trigger.Request())
        seen.append((bus.time_ns, response.message))

    node.create_service(Trigger, "/go", answer)
    node.create_subscription(mrs.messages.Clock, "/start", ask)
    node.create_timer(1.0, ask).cancel()
    node.create_publisher(mrs.messages.Clock, "/start").publish(mrs.messages.Clock())
    bus.run_until(SECOND)
    assert seen == [(0, "asks")]
    bus.schedule(2 * SECOND, lambda: ready.set_result("gone"))
    bus.run_until(3 * SECOND)
    assert seen == [(0, "asks"), (2 * SECOND, "gone")]
    node.create_timer(1.0, ask)
    bus.run_until(4 * SECOND)
    assert seen[2:] == [(4 * SECOND, "asks"), (4 * SECOND, "gone")] and not bus.tasks


def test_an_exception_in_an_async_callback_is_raised_by_the_run_also_after_an_await(bus: Bus, node: BusNode) -> None:
    ready = Future()

    async def fail(request: Any, response: Any) -> Any:
        await ready
        raise OSError("out of coffee")

    node.create_service(Trigger, "/go", fail)
    node.create_client(Trigger, "/go").call_async(Trigger.Request())
    bus.run_until(SECOND)
    ready.set_result(None)
    with pytest.raises(OSError, match="out of coffee"):
        bus.run_until(2 * SECOND)
    assert not bus.tasks


def test_awaiting_a_failed_future_raises_its_exception_in_the_callback(bus: Bus, node: BusNode) -> None:
    ready, seen = Future(), list[Any]()

    async def wait() -> None:
        try:
            await ready
        except OSError as error:
            seen.append(str(error))

    node.create_timer(1.0, wait)
    bus.run_until(SECOND)
    ready.set_exception(OSError("the server died"))
    bus.run_until(SECOND)
    assert seen == ["the server died"]


@pytest.mark.parametrize(
    ("awaited", "words"), [(asyncio.sleep(1.0), "no running event loop"), (asyncio.sleep(0), "stands still")]
)
def test_asyncio_has_no_loop_on_the_bus(bus: Bus, node: BusNode, awaited: Any, words: str) -> None:
    async def wait() -> None:
        await awaited
        while True:
            await asyncio.sleep(0)

    node.create_timer(1.0, wait)
    with pytest.raises(RuntimeError, match=words):
        bus.run_until(SECOND)


def test_a_bus_with_a_waiting_callback_cannot_be_saved_and_a_restore_ends_it(bus: Bus, node: BusNode) -> None:
    ready, seen = Future(), list[str]()

    async def wait_for_it() -> None:
        try:
            await ready
            seen.append("went on")
        finally:
            seen.append("ended")

    saved = bus.save()
    node.create_timer(1.0, wait_for_it)
    bus.run_until(SECOND)
    with pytest.raises(RuntimeError, match=r"cannot be saved while async callbacks wait: .*wait_for_it"):
        bus.save()
    bus.restore(saved)
    ready.set_result(None)
    bus.run_until(3 * SECOND)
    assert seen == ["ended"]


def test_a_done_callback_must_not_be_async() -> None:
    async def late(future: Future) -> None: ...

    with pytest.raises(TypeError, match=r"must not be async, got .*late: await the future"):
        Future().add_done_callback(late)  # type: ignore[arg-type]
