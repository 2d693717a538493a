"""Order of events, exceptions in callbacks, and the checks against endless loops."""

from __future__ import annotations

import traceback
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode

SECOND = 1_000_000_000


def at(seconds: int) -> mrs.messages.Clock:
    return mrs.messages.Clock(mrs.messages.Time(sec=seconds))


def crash(message: object = None) -> None:
    raise RuntimeError("out of coffee")


def test_messages_arrive_in_the_order_in_which_they_were_sent(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    node.create_subscription(mrs.messages.Clock, "/a", lambda message: seen.append(("first", message)))
    node.create_subscription(mrs.messages.Clock, "/b", lambda message: seen.append(("b", message)))
    node.create_subscription(mrs.messages.Clock, "/a", lambda message: seen.append(("second", message)))
    a, b = node.create_publisher(mrs.messages.Clock, "/a"), node.create_publisher(mrs.messages.Clock, "/b")
    a.publish(at(1))
    b.publish(at(2))
    a.publish(at(3))
    assert seen == []
    bus.run_until(0)
    assert seen == [("first", at(1)), ("second", at(1)), ("b", at(2)), ("first", at(3)), ("second", at(3))]


def test_a_message_arrives_after_the_callback_that_sent_it_has_returned(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    answers = node.create_publisher(mrs.messages.Clock, "/answer")

    def ask(message: mrs.messages.Clock) -> None:
        answers.publish(message)
        seen.append("asked")

    node.create_subscription(mrs.messages.Clock, "/ask", ask)
    node.create_subscription(mrs.messages.Clock, "/answer", lambda message: seen.append("answered"))
    node.create_publisher(mrs.messages.Clock, "/ask").publish(at(1))
    bus.run_until(0)
    assert seen == ["asked", "answered"]


def test_messages_arrive_before_timers_of_the_same_time_fire(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    publisher = node.create_publisher(mrs.messages.Clock, "/a")
    node.create_timer(1.0, lambda: (seen.append("first timer"), publisher.publish(at(1))))
    node.create_timer(1.0, lambda: seen.append("second timer"))
    node.create_subscription(mrs.messages.Clock, "/a", lambda message: seen.append("message"))
    bus.run_until(SECOND)
    assert seen == ["first timer", "message", "second timer"]


def test_timers_due_at_the_same_time_fire_in_order_of_creation(bus: Bus, node: BusNode) -> None:
    fired: list[str] = []
    node.create_timer(0.5, lambda: fired.append("half"))
    node.create_timer(1.0, lambda: fired.append("whole"))
    node.create_timer(0.25, lambda: fired.append("quarter"))
    bus.run_until(SECOND)
    assert fired == ["quarter", "half", "quarter", "quarter", "half", "whole", "quarter"]


def test_a_run_in_pieces_equals_a_run_at_once(node: BusNode, bus: Bus) -> None:
    fired: list[int] = []
    node.create_timer(0.3, lambda: fired.append(bus.time_ns))
    for stop in range(0, 3 * SECOND, 70_000_001):
        bus.run_until(stop)
    bus.run_until(3 * SECOND)
    assert fired == [count * 300_000_000 for count in range(1, 11)]


def test_time_does_not_go_back(bus: Bus) -> None:
    bus.run_until(5)
    with pytest.raises(ValueError, match="got 4 ns at 5 ns"):
        bus.run_until(4)
    bus.run_until(5)
    assert bus.time_ns == 5


def test_taps_see_every_message_when_it_is_sent(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    bus.taps.append(lambda topic, message, time_ns: seen.append((topic, message, time_ns)))
    publisher = node.create_publisher(mrs.messages.Clock, "a")
    publisher.publish(at(1))
    bus.run_until(5)
    publisher.publish(at(2))
    assert seen == [("/a", at(1), 0), ("/a", at(2), 5)]


def test_an_exception_in_a_callback_is_raised_by_the_run_with_its_traceback(bus: Bus, node: BusNode) -> None:
    node.create_timer(1.0, crash)
    with pytest.raises(RuntimeError, match="out of coffee") as caught:
        bus.run_until(5 * SECOND)
    assert "crash" in [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert bus.time_ns == SECOND


def test_the_run_can_continue_after_an_exception_in_a_callback(bus: Bus, node: BusNode) -> None:
    fired: list[int] = []
    node.create_timer(1.0, lambda: crash() if bus.time_ns == 2 * SECOND else fired.append(bus.time_ns))
    with pytest.raises(RuntimeError, match="out of coffee"):
        bus.run_until(4 * SECOND)
    bus.run_until(4 * SECOND)
    assert fired == [SECOND, 3 * SECOND, 4 * SECOND]
    assert bus.time_ns == 4 * SECOND


def test_an_exception_in_one_subscriber_does_not_drop_messages_of_others(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    node.create_subscription(mrs.messages.Clock, "/a", crash)
    node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    node.create_publisher(mrs.messages.Clock, "/a").publish(at(1))
    with pytest.raises(RuntimeError, match="out of coffee"):
        bus.run_until(SECOND)
    bus.run_until(SECOND)
    assert seen == [at(1)]


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit])
def test_an_interrupt_ends_the_run(bus: Bus, node: BusNode, error: type[BaseException]) -> None:
    def interrupt() -> None:
        raise error

    node.create_timer(1.0, interrupt)
    with pytest.raises(error):
        bus.run_until(5 * SECOND)
    bus.run_until(int(1.5 * SECOND))


def test_an_endless_exchange_of_messages_is_an_error(bus: Bus, node: BusNode) -> None:
    ping, pong = node.create_publisher(mrs.messages.Clock, "/ping"), node.create_publisher(mrs.messages.Clock, "/pong")
    node.create_subscription(mrs.messages.Clock, "/ping", pong.publish)
    node.create_subscription(mrs.messages.Clock, "/pong", ping.publish)
    ping.publish(at(1))
    with pytest.raises(RuntimeError, match=r"time stands still at 0\.0 s"):
        bus.run_until(SECOND)


def test_an_endless_multiplication_of_messages_is_an_error(bus: Bus, node: BusNode) -> None:
    """Two replies to every message: the chains stay short, but there are 2 to the power of their length."""
    publisher, calls = node.create_publisher(mrs.messages.Clock, "/a"), [0]

    def answer_again(message: mrs.messages.Clock) -> None:
        calls[0] += 1
        assert calls[0] <= 400_000, "the bus did not stop the loop"
        publisher.publish(message)

    for _ in range(2):
        node.create_subscription(mrs.messages.Clock, "/a", answer_again)
    publisher.publish(at(1))
    with pytest.raises(RuntimeError, match="time stands still"):
        bus.run_until(SECOND)


def test_an_endless_chain_of_service_calls_is_an_error(bus: Bus, node: BusNode) -> None:
    client = node.create_client(mrs.messages.GetMap, "/map")
    node.create_service(mrs.messages.GetMap, "/map", lambda request, response: (client.call_async(request), response)[1])
    client.call_async(mrs.messages.GetMap.Request())
    with pytest.raises(RuntimeError, match="time stands still"):
        bus.run_until(SECOND)


def test_many_messages_sent_before_a_run_are_not_an_endless_loop(bus: Bus, node: BusNode) -> None:
    """Only replies count. Messages sent before the run are finite in number."""
    seen: list[Any] = []
    node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    publisher = node.create_publisher(mrs.messages.Clock, "/a")
    message = at(1)
    for _ in range(100_001):
        publisher.publish(message)
    bus.run_until(SECOND)
    assert len(seen) == 100_001


def test_a_callback_must_not_run_the_bus(bus: Bus, node: BusNode) -> None:
    node.create_timer(1.0, lambda: bus.run_until(9 * SECOND))
    with pytest.raises(RuntimeError, match="already running"):
        bus.run_until(5 * SECOND)
    assert bus.time_ns == SECOND


def test_callbacks_may_create_and_destroy_subscriptions_and_timers(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    publisher = node.create_publisher(mrs.messages.Clock, "/a")

    def first(message: mrs.messages.Clock) -> None:
        seen.append("first")
        node.destroy_subscription(subscription)
        node.destroy_subscription(second)
        node.create_subscription(mrs.messages.Clock, "/a", lambda message: seen.append("third"))
        node.create_timer(1.0, lambda: seen.append("timer"))
        publisher.publish(at(2))

    subscription = node.create_subscription(mrs.messages.Clock, "/a", first)
    second = node.create_subscription(mrs.messages.Clock, "/a", lambda message: seen.append("second"))
    publisher.publish(at(1))
    bus.run_until(SECOND)
    assert seen == ["first", "third", "timer"]


def test_events_of_one_time_run_in_the_documented_order(bus: Bus, node: BusNode) -> None:
    """The picture in the module's docstring: a delayed message and two timers at 1.0 s, each followed by what it sends."""
    seen: list[str] = []
    echo = node.create_publisher(mrs.messages.String, "/echo")

    def record(message: mrs.messages.String) -> None:
        seen.append(message.data)
        if "echo" not in message.data:
            echo.publish(mrs.messages.String(f"echo of {message.data}"))

    publisher = node.create_publisher(mrs.messages.String, "/a")
    node.create_subscription(mrs.messages.String, "/a", record)
    node.create_subscription(mrs.messages.String, "/echo", record)
    for name in "AB":
        node.create_timer(
            1.0, lambda name=name: (seen.append(f"timer {name}"), publisher.publish(mrs.messages.String(f"from {name}")))
        )
    bus.filters.append(lambda topic, message: [(SECOND, message)] if message.data == "delayed" else None)
    publisher.publish(mrs.messages.String("delayed"))
    bus.run_until(SECOND)
    assert seen == [
        *("delayed", "echo of delayed"),
        *("timer A", "from A", "echo of from A"),
        *("timer B", "from B", "echo of from B"),
    ]


def test_a_restored_bus_repeats_messages_timers_and_calls(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    publisher = node.create_publisher(mrs.messages.String, "/a")
    node.create_subscription(mrs.messages.String, "/a", lambda message: seen.append(message.data))
    node.create_timer(1.0, lambda: seen.append("timer"))
    node.create_service(mrs.messages.Trigger, "/b", lambda request, response: (seen.append("call"), response)[1])
    publisher.publish(mrs.messages.String("message"))
    node.create_client(mrs.messages.Trigger, "/b").call_async(mrs.messages.Trigger.Request())
    state = bus.save()
    for _ in range(2):
        node.create_subscription(mrs.messages.String, "/a", lambda message: seen.append("later subscription"))
        bus.restore(state)
        bus.run_until(SECOND)
    assert seen == ["message", "call", "timer"] * 2


def test_a_closed_bus_drops_everything_and_does_not_run(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    node.create_timer(1.0, lambda: seen.append("timer"))
    bus.close()
    bus.close()
    with pytest.raises(RuntimeError, match="closed"):
        bus.run_until(SECOND)
    assert (seen, bus.nodes, bus.next_ns()) == ([], [], None)


def test_durations_add_up_before_they_are_rounded(bus: Bus) -> None:
    for _ in range(100_000):
        bus.run_for(1 / 30)
    assert bus.time_ns == 3_333_333_333_333
    state = bus.save()
    bus.run_for(1 / 30)
    after = bus.time_ns
    bus.restore(state)
    bus.run_for(1 / 30)
    assert bus.time_ns == after == 3_333_366_666_667
    bus.run_until(4 * 10**12)
    bus.run_for(1 / 3)
    assert bus.time_ns == 4 * 10**12 + 333_333_333
