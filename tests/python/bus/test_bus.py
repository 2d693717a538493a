"""bus: topics, timers and services on a virtual clock, in an order that never changes."""

from __future__ import annotations

import math
import traceback
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode, OwnNode
from mobile_robot_simulator.nodes.interface import QoS

SECOND = 1_000_000_000


@pytest.fixture
def bus() -> Bus:
    return Bus()


@pytest.fixture
def node(bus: Bus) -> BusNode:
    return OwnNode(bus, "tester")


def at(seconds: int) -> mrs.messages.Clock:
    return mrs.messages.Clock(mrs.messages.Time(sec=seconds))


# --- topics -----------------------------------------------------------------------------------------------------------


def test_messages_arrive_in_the_order_they_were_sent(bus: Bus, node: BusNode) -> None:
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


def test_a_name_is_the_same_with_and_without_its_slash(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    node.create_subscription(mrs.messages.Clock, "clock", seen.append)
    node.create_publisher(mrs.messages.Clock, "/clock").publish(at(1))
    bus.run_until(0)
    assert seen == [at(1)]
    assert bus.latest("clock") == bus.latest("/clock") == at(1)


def test_nobody_gets_a_message_twice_or_after_leaving(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    subscription = node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    publisher = node.create_publisher(mrs.messages.Clock, "/a")
    publisher.publish(at(1))
    bus.run_until(1)
    bus.run_until(2)
    publisher.publish(at(2))
    node.destroy_subscription(subscription)
    bus.run_until(3)
    assert seen == [at(1)]


def test_late_subscribers_get_the_last_message_of_a_latched_topic(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    publisher = node.create_publisher(mrs.messages.Clock, "/map", QoS.LATCHED)
    publisher.publish(at(1))
    publisher.publish(at(2))
    bus.run_until(SECOND)
    node.create_subscription(mrs.messages.Clock, "/map", seen.append, QoS.LATCHED)
    bus.run_until(2 * SECOND)
    assert seen == [at(2)]


def test_late_subscribers_get_nothing_of_other_topics(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    node.create_publisher(mrs.messages.Clock, "/a").publish(at(1))
    bus.run_until(SECOND)
    node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    bus.run_until(2 * SECOND)
    assert seen == []


def test_a_latched_message_comes_once_to_who_subscribes_while_it_is_on_its_way(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    publisher = node.create_publisher(mrs.messages.Clock, "/map", QoS.LATCHED)
    node.create_subscription(mrs.messages.Clock, "/map", lambda message: None)
    publisher.publish(at(1))
    node.create_subscription(mrs.messages.Clock, "/map", seen.append)
    bus.run_until(SECOND)
    assert seen == [at(1)]


@pytest.mark.parametrize("others", [0, 1])
def test_who_subscribes_after_a_message_was_sent_does_not_get_it(bus: Bus, node: BusNode, others: int) -> None:
    """A message goes to those who are subscribed when it is sent."""
    seen: list[Any] = []
    for _ in range(others):
        node.create_subscription(mrs.messages.Clock, "/a", lambda message: None)
    node.create_publisher(mrs.messages.Clock, "/a").publish(at(1))
    node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    bus.run_until(SECOND)
    assert seen == []


def test_taps_see_every_message_when_it_is_sent(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    bus.taps.append(lambda topic, message, time_ns: seen.append((topic, message, time_ns)))
    publisher = node.create_publisher(mrs.messages.Clock, "a")
    publisher.publish(at(1))
    bus.run_until(5)
    publisher.publish(at(2))
    assert seen == [("/a", at(1), 0), ("/a", at(2), 5)]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda node: node.create_publisher(mrs.messages.Twist, "/a").publish(at(1)), "/a carries Twist, got Clock"),
        (lambda node: node.create_publisher(mrs.messages.Twist, "/a").publish("go"), "/a carries Twist, got str"),
        (lambda node: node.create_publisher(mrs.messages.Twist, "/a").publish(None), "/a carries Twist, got NoneType"),
        (
            lambda node: (node.create_publisher(mrs.messages.Twist, "/a"), node.create_publisher(mrs.messages.Clock, "a")),
            "/a carries Twist, got Clock",
        ),
        (
            lambda node: (
                node.create_publisher(mrs.messages.Twist, "/a"),
                node.create_subscription(mrs.messages.Clock, "/a", print),
            ),
            "/a carries Twist, got Clock",
        ),
        (lambda node: node.create_publisher(str, "/a"), "message class"),
        (lambda node: node.create_publisher("Twist", "/a"), "message class"),
        (lambda node: node.create_publisher(mrs.messages.Twist(), "/a"), "message class"),
    ],
)
def test_wrong_types_are_refused(node: BusNode, call: Any, words: str) -> None:
    with pytest.raises(TypeError, match=words):
        call(node)


@pytest.mark.parametrize("name", ["", "/", "//"])
def test_a_topic_has_a_name(node: BusNode, name: str) -> None:
    with pytest.raises(ValueError, match="must have a name"):
        node.create_publisher(mrs.messages.Twist, name)


def test_a_refused_type_leaves_no_topic_behind(bus: Bus, node: BusNode) -> None:
    with pytest.raises(TypeError):
        node.create_publisher(int, "/a")  # type: ignore[type-var]
    assert bus.topic_names() == []


# --- the clock and its timers -----------------------------------------------------------------------------------------


def test_the_clock_shows_the_time_run_to(bus: Bus, node: BusNode) -> None:
    assert node.get_clock().now().nanoseconds == 0
    bus.run_until(1_234_567_890)
    assert node.get_clock().now().nanoseconds == 1_234_567_890
    assert node.get_clock().now().to_msg() == mrs.messages.Time(1, 234_567_890)


def test_time_does_not_go_back(bus: Bus) -> None:
    bus.run_until(5)
    with pytest.raises(ValueError, match="got 4 ns at 5 ns"):
        bus.run_until(4)
    bus.run_until(5)
    assert bus.time_ns == 5


@pytest.mark.parametrize(("rate", "seconds"), [(10.0, 60), (3.0, 1000), (30.0, 600), (7.0, 700), (1000.0, 5), (0.1, 1000)])
def test_timers_fire_at_multiples_of_their_period_without_drift(bus: Bus, node: BusNode, rate: float, seconds: int) -> None:
    fired: list[int] = []
    node.create_timer(1.0 / rate, lambda: fired.append(bus.time_ns))
    bus.run_until(seconds * SECOND)
    assert fired == [round(count / rate * SECOND) for count in range(1, round(seconds * rate) + 1)]


def test_timers_count_from_their_creation(bus: Bus, node: BusNode) -> None:
    fired: list[int] = []
    bus.run_until(7)
    node.create_timer(1.0, lambda: fired.append(bus.time_ns))
    bus.run_until(3 * SECOND)
    assert fired == [SECOND + 7, 2 * SECOND + 7]


def test_timers_of_one_moment_fire_in_the_order_of_their_creation(bus: Bus, node: BusNode) -> None:
    fired: list[str] = []
    node.create_timer(0.5, lambda: fired.append("half"))
    node.create_timer(1.0, lambda: fired.append("whole"))
    node.create_timer(0.25, lambda: fired.append("quarter"))
    bus.run_until(SECOND)
    assert fired == ["quarter", "half", "quarter", "quarter", "half", "whole", "quarter"]


def test_messages_come_before_the_timers_of_their_moment(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    publisher = node.create_publisher(mrs.messages.Clock, "/a")
    node.create_timer(1.0, lambda: (seen.append("first timer"), publisher.publish(at(1))))
    node.create_timer(1.0, lambda: seen.append("second timer"))
    node.create_subscription(mrs.messages.Clock, "/a", lambda message: seen.append("message"))
    bus.run_until(SECOND)
    assert seen == ["first timer", "message", "second timer"]


def test_pieces_of_a_run_are_the_whole(node: BusNode, bus: Bus) -> None:
    fired: list[int] = []
    node.create_timer(0.3, lambda: fired.append(bus.time_ns))
    for stop in range(0, 3 * SECOND, 70_000_001):
        bus.run_until(stop)
    bus.run_until(3 * SECOND)
    assert fired == [count * 300_000_000 for count in range(1, 11)]


def test_a_cancelled_timer_never_fires(bus: Bus, node: BusNode) -> None:
    fired: list[str] = []
    timer = node.create_timer(1.0, lambda: fired.append("one"))
    other = node.create_timer(1.0, lambda: (fired.append("two"), node.destroy_timer(other)))
    third = node.create_timer(1.0, lambda: fired.append("three"))
    node.create_timer(0.5, third.cancel)
    timer.cancel()
    assert timer.is_canceled()
    bus.run_until(5 * SECOND)
    assert fired == ["two"]


@pytest.mark.parametrize("period", [0.0, -1.0, math.nan, 1e-10, math.inf])
def test_a_timer_has_a_period(node: BusNode, period: float) -> None:
    with pytest.raises(ValueError, match="period"):
        node.create_timer(period, lambda: None)


# --- what callbacks may do --------------------------------------------------------------------------------------------


def crash(message: object = None) -> None:
    raise RuntimeError("out of coffee")


def test_what_a_callback_raises_comes_out_with_its_traceback(bus: Bus, node: BusNode) -> None:
    node.create_timer(1.0, crash)
    with pytest.raises(RuntimeError, match="out of coffee") as caught:
        bus.run_until(5 * SECOND)
    assert "crash" in [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert bus.time_ns == SECOND


def test_the_run_goes_on_after_a_callback_raised(bus: Bus, node: BusNode) -> None:
    fired: list[int] = []
    node.create_timer(1.0, lambda: crash() if bus.time_ns == 2 * SECOND else fired.append(bus.time_ns))
    with pytest.raises(RuntimeError, match="out of coffee"):
        bus.run_until(4 * SECOND)
    bus.run_until(4 * SECOND)
    assert fired == [SECOND, 3 * SECOND, 4 * SECOND]
    assert bus.time_ns == 4 * SECOND


def test_one_subscriber_that_raises_takes_no_message_from_the_others(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    node.create_subscription(mrs.messages.Clock, "/a", crash)
    node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    node.create_publisher(mrs.messages.Clock, "/a").publish(at(1))
    with pytest.raises(RuntimeError, match="out of coffee"):
        bus.run_until(SECOND)
    bus.run_until(SECOND)
    assert seen == [at(1)]


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit])
def test_an_interrupt_comes_out_too(bus: Bus, node: BusNode, error: type[BaseException]) -> None:
    def interrupt() -> None:
        raise error

    node.create_timer(1.0, interrupt)
    with pytest.raises(error):
        bus.run_until(5 * SECOND)
    bus.run_until(int(1.5 * SECOND))


def test_callbacks_that_answer_each_other_for_ever_are_an_error(bus: Bus, node: BusNode) -> None:
    ping, pong = node.create_publisher(mrs.messages.Clock, "/ping"), node.create_publisher(mrs.messages.Clock, "/pong")
    node.create_subscription(mrs.messages.Clock, "/ping", pong.publish)
    node.create_subscription(mrs.messages.Clock, "/pong", ping.publish)
    ping.publish(at(1))
    with pytest.raises(RuntimeError, match=r"time stands still at 0\.0 s"):
        bus.run_until(SECOND)


def test_callbacks_that_multiply_messages_for_ever_are_an_error(bus: Bus, node: BusNode) -> None:
    """Two answers to every message are no long chain, and yet no end: 2 to the power of the chain's length."""
    publisher, calls = node.create_publisher(mrs.messages.Clock, "/a"), [0]

    def answer_again(message: mrs.messages.Clock) -> None:
        calls[0] += 1
        assert calls[0] <= 400_000, "nothing stopped it"
        publisher.publish(message)

    for _ in range(2):
        node.create_subscription(mrs.messages.Clock, "/a", answer_again)
    publisher.publish(at(1))
    with pytest.raises(RuntimeError, match="time stands still"):
        bus.run_until(SECOND)


def test_a_callback_that_calls_its_service_for_ever_is_an_error(bus: Bus, node: BusNode) -> None:
    client = node.create_client(mrs.messages.GetMap, "/map")
    node.create_service(mrs.messages.GetMap, "/map", lambda request, response: (client.call_async(request), response)[1])
    client.call_async(mrs.messages.GetMap.Request())
    with pytest.raises(RuntimeError, match="time stands still"):
        bus.run_until(SECOND)


def test_many_messages_at_one_moment_are_no_endless_loop(bus: Bus, node: BusNode) -> None:
    """What was sent before the run is finite, however much it is."""
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
    with pytest.raises(RuntimeError, match="running already"):
        bus.run_until(5 * SECOND)
    assert bus.time_ns == SECOND


def test_callbacks_may_make_and_unmake_everything(bus: Bus, node: BusNode) -> None:
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


# --- services ---------------------------------------------------------------------------------------------------------


def answer(request: Any, response: Any) -> Any:
    response.map.info.width = 7
    return response


def test_a_service_answers_after_the_caller_has_returned(bus: Bus, node: BusNode) -> None:
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


def test_a_service_that_is_not_there_never_answers(bus: Bus, node: BusNode) -> None:
    client = node.create_client(mrs.messages.GetMap, "/static_map")
    assert not client.service_is_ready() and not client.wait_for_service(timeout_sec=1.0)
    future = client.call_async(mrs.messages.GetMap.Request())
    bus.run_until(SECOND)
    assert not future.done()
    service = node.create_service(mrs.messages.GetMap, "/static_map", answer)
    assert client.service_is_ready()
    node.destroy_service(service)
    assert not client.service_is_ready()


def test_services_have_one_type_and_one_answerer(node: BusNode) -> None:
    node.create_service(mrs.messages.GetMap, "/static_map", answer)
    with pytest.raises(ValueError, match="/static_map"):
        node.create_service(mrs.messages.GetMap, "/static_map", answer)
    with pytest.raises(TypeError, match="/static_map"):
        node.create_client(mrs.messages.Twist, "/static_map")
    with pytest.raises(TypeError, match="GetMapRequest, got Twist"):
        node.create_client(mrs.messages.GetMap, "/static_map").call_async(mrs.messages.Twist())


def test_what_a_service_raises_comes_out(bus: Bus, node: BusNode) -> None:
    node.create_service(mrs.messages.GetMap, "/static_map", lambda request, response: crash())
    node.create_client(mrs.messages.GetMap, "/static_map").call_async(mrs.messages.GetMap.Request())
    with pytest.raises(RuntimeError, match="out of coffee"):
        bus.run_until(0)


def test_nodes_have_names_and_loggers(bus: Bus, caplog: pytest.LogCaptureFixture) -> None:
    node = OwnNode(bus, "robot")
    node.get_logger().warning("low battery")
    assert node.get_name() == "robot"
    assert [(record.levelname, record.getMessage()) for record in caplog.records] == [("WARNING", "low battery")]
    assert "robot" in caplog.records[0].name
    assert isinstance(messages.GetMapRequest(), mrs.messages.GetMap.Request)
