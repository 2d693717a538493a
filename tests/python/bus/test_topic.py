"""Topics: names, types, subscriptions and latched messages."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode
from mobile_robot_simulator.nodes.interface import QoS

SECOND = 1_000_000_000


def at(seconds: int) -> mrs.messages.Clock:
    return mrs.messages.Clock(mrs.messages.Time(sec=seconds))


def test_a_leading_slash_makes_no_difference_in_the_root_namespace(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    node.create_subscription(mrs.messages.Clock, "clock", seen.append)
    node.create_publisher(mrs.messages.Clock, "/clock").publish(at(1))
    bus.run_until(0)
    assert seen == [at(1)]
    assert bus.latest("clock") == bus.latest("/clock") == at(1)


def test_a_destroyed_subscription_receives_nothing_more(bus: Bus, node: BusNode) -> None:
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


def test_a_late_subscriber_receives_the_last_message_of_a_latched_topic(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    publisher = node.create_publisher(mrs.messages.Clock, "/map", QoS.LATCHED)
    publisher.publish(at(1))
    publisher.publish(at(2))
    bus.run_until(SECOND)
    node.create_subscription(mrs.messages.Clock, "/map", seen.append, QoS.LATCHED)
    bus.run_until(2 * SECOND)
    assert seen == [at(2)]


def test_a_message_that_nobody_receives_is_built_when_it_is_read_and_only_once(bus: Bus, node: BusNode) -> None:
    built: list[int] = []

    def build(seconds: int) -> mrs.messages.Clock:
        built.append(seconds)
        return at(seconds)

    publisher = node.create_publisher(mrs.messages.Clock, "/a")
    publisher.publish_lazily(build, 1)
    publisher.publish_lazily(build, 2)
    assert built == []
    assert bus.latest("/a") == at(2)
    assert bus.latest("/a") is bus.latest("/a")
    assert built == [2]


@pytest.mark.parametrize("receiver", ["subscription", "tap", "filter", "latched"])
def test_a_message_that_is_received_is_built_at_once(bus: Bus, node: BusNode, receiver: str) -> None:
    seen: list[Any] = []
    if receiver == "subscription":
        node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    elif receiver == "tap":
        bus.taps.append(lambda name, message, time_ns: seen.append(message))
    elif receiver == "filter":
        bus.filters.append(lambda name, message: seen.append(message))
    publisher = node.create_publisher(mrs.messages.Clock, "/a", QoS.LATCHED if receiver == "latched" else QoS.DEFAULT)
    built: list[int] = []
    publisher.publish_lazily(lambda: built.append(1) or at(1))
    assert built == [1]
    if receiver == "latched":
        node.create_subscription(mrs.messages.Clock, "/a", seen.append, QoS.LATCHED)
    bus.run_until(0)
    assert seen == [at(1)]
    assert bus.latest("/a") == at(1)


def test_a_message_that_is_built_must_be_of_the_type_of_the_topic(bus: Bus, node: BusNode) -> None:
    node.create_subscription(mrs.messages.Clock, "/a", print)
    with pytest.raises(TypeError, match=r"/a carries Clock, got Time"):
        node.create_publisher(mrs.messages.Clock, "/a").publish_lazily(mrs.messages.Time)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (mrs.messages.LaserScan(ranges="abc"), r"LaserScan\.ranges must be an array of numbers, got 'abc'"),  # type: ignore
        (mrs.messages.LaserScan(ranges=[1.0, "a"]), r"LaserScan\.ranges\[1\] must be a number, got 'a'"),  # type: ignore
        (mrs.messages.LaserScan(ranges=np.array(["a"])), r"LaserScan\.ranges must be an array of numbers, got array"),
        (mrs.messages.TFMessage([1]), r"TFMessage\.transforms\[0\] must be a TransformStamped, got 1"),  # type: ignore
        (mrs.messages.TFMessage(3), r"TFMessage\.transforms must be a list of TransformStamped, got 3"),  # type: ignore
        (
            mrs.messages.TFMessage([mrs.messages.TransformStamped(child_frame_id=3)]),  # type: ignore
            r"TransformStamped\.child_frame_id must be a str, got 3",
        ),
    ],
)
def test_items_of_lists_and_arrays_are_checked(bus: Bus, message: Any, words: str) -> None:
    with pytest.raises(TypeError, match=words):
        BusNode(bus, "clerk").create_publisher(type(message), "/a").publish(message)
    assert bus.topics()[0].latest is None


@pytest.mark.parametrize("kind", [mrs.messages.PoseWithCovariance, mrs.messages.TwistWithCovariance])
@pytest.mark.parametrize(
    ("covariance", "words"),
    [
        (np.zeros(35), "must be 36 numbers, got 35"),
        ([0.0] * 37, "must be 36 numbers, got 37"),
        (np.zeros(0), "must be 36 numbers, got 0"),
        (np.zeros((6, 6)), r"must be an array of one dimension, got shape \(6, 6\)"),
    ],
)
def test_a_covariance_has_36_numbers(bus: Bus, kind: Any, covariance: Any, words: str) -> None:
    publisher = BusNode(bus, "clerk").create_publisher(kind, "/a")
    with pytest.raises(ValueError, match=f"{kind.__name__}.covariance {words}$"):
        publisher.publish(kind(covariance=covariance))
    assert bus.topics()[0].latest is None
    publisher.publish(kind(covariance=[0.0] * 36))
    assert bus.topics()[0].latest is not None


def test_ranges_have_one_dimension_and_any_length(bus: Bus) -> None:
    publisher = BusNode(bus, "clerk").create_publisher(mrs.messages.LaserScan, "/a")
    with pytest.raises(ValueError, match=r"LaserScan.ranges must be an array of one dimension, got shape \(2, 3\)"):
        publisher.publish(mrs.messages.LaserScan(ranges=np.zeros((2, 3), np.float32)))
    publisher.publish(mrs.messages.LaserScan(ranges=np.zeros(3, np.float32)))
    assert bus.topics()[0].latest is not None


def test_numbers_that_are_not_finite_may_be_sent(bus: Bus) -> None:
    scan = mrs.messages.LaserScan(ranges=[np.nan, np.inf, 1], range_max=np.inf)  # type: ignore
    BusNode(bus, "clerk").create_publisher(mrs.messages.LaserScan, "/a").publish(scan)
    assert str(bus.latest("/a").ranges) == "[nan, inf, 1]"


def test_a_late_subscriber_receives_nothing_from_other_topics(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    node.create_publisher(mrs.messages.Clock, "/a").publish(at(1))
    bus.run_until(SECOND)
    node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    bus.run_until(2 * SECOND)
    assert seen == []


def test_a_latched_message_under_way_reaches_a_new_subscriber_once(bus: Bus, node: BusNode) -> None:
    seen: list[Any] = []
    publisher = node.create_publisher(mrs.messages.Clock, "/map", QoS.LATCHED)
    node.create_subscription(mrs.messages.Clock, "/map", lambda message: None)
    publisher.publish(at(1))
    node.create_subscription(mrs.messages.Clock, "/map", seen.append)
    bus.run_until(SECOND)
    assert seen == [at(1)]


@pytest.mark.parametrize("others", [0, 1])
def test_a_message_does_not_reach_subscriptions_created_after_it_was_sent(bus: Bus, node: BusNode, others: int) -> None:
    """A message goes to the subscriptions that exist when it is sent."""
    seen: list[Any] = []
    for _ in range(others):
        node.create_subscription(mrs.messages.Clock, "/a", lambda message: None)
    node.create_publisher(mrs.messages.Clock, "/a").publish(at(1))
    node.create_subscription(mrs.messages.Clock, "/a", seen.append)
    bus.run_until(SECOND)
    assert seen == []


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
def test_an_empty_topic_name_is_refused(node: BusNode, name: str) -> None:
    with pytest.raises(ValueError, match="must have a name"):
        node.create_publisher(mrs.messages.Twist, name)


def test_a_refused_type_creates_no_topic(bus: Bus, node: BusNode) -> None:
    with pytest.raises(TypeError):
        node.create_publisher(int, "/a")  # type: ignore[type-var]
    assert bus.topic_names() == []


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (mrs.messages.Twist(0.5, 0.1), r"Twist\.linear must be a Vector3, got 0\.5"),
        (mrs.messages.Twist(mrs.messages.Vector3("1")), r"Vector3\.x must be a float, got '1'"),
        (mrs.messages.TwistStamped(), r"/cmd_vel carries Twist, got TwistStamped"),
        ((1, 2), r"/cmd_vel carries Twist, got \(1, 2\)"),
        (None, r"/cmd_vel carries Twist, got None"),
    ],
)
def test_a_message_of_wrong_types_is_refused_when_it_is_published(message, text):
    sim = mrs.Simulation(mrs.OccupancyGrid(np.zeros((60, 60), np.int8), resolution=0.1), start=(3, 3, 0))
    publisher = sim.create_node("driver").create_publisher(mrs.messages.Twist, "/cmd_vel", 10)
    with pytest.raises(TypeError, match=text):
        publisher.publish(message)
    with pytest.raises(TypeError, match=r"must be a|/cmd_vel carries Twist, got"):
        sim.publish("/cmd_vel", message)
    publisher.publish(mrs.messages.Twist(mrs.messages.Vector3(np.float32(0.5), 0)))
    sim.run_for(0.1)
    assert sim.truth.velocity[0] == 0.5


def test_a_late_subscriber_receives_the_last_message_of_each_latched_publisher(bus: Bus, node: BusNode) -> None:
    """In the order in which they were sent; a destroyed publisher takes its message along, as on ROS 2."""
    first, second, third = (node.create_publisher(mrs.messages.Clock, "/map", QoS.LATCHED) for _ in range(3))
    for seconds, publisher in enumerate([first, second, third, first]):
        publisher.publish(at(seconds))
    node.create_publisher(mrs.messages.Clock, "/map").publish(at(9))
    saved = bus.save()
    seen: list[Any] = []
    node.create_subscription(mrs.messages.Clock, "/map", seen.append)
    bus.run_until(0)
    assert seen == [at(1), at(2), at(3)] and bus.latest("/map") == at(9)
    node.destroy_publisher(second)
    assert [message for _, message, _ in bus.latched()] == [at(2), at(3)]
    bus.restore(saved)
    assert [message for _, message, _ in bus.latched()] == [at(1), at(2), at(3)]
    other = BusNode(bus, "other")
    other.create_publisher(mrs.messages.Clock, "/map", QoS.LATCHED).publish(at(4))
    other.destroy_node()
    assert [message for _, message, _ in bus.latched()] == [at(1), at(2), at(3)]


def test_publishers_and_subscriptions_are_counted(bus: Bus, node: BusNode) -> None:
    assert (node.count_publishers("/a"), node.count_subscribers("/a")) == (0, 0)
    bus.topic("/a", mrs.messages.Clock)
    saved = bus.save()
    publisher, other = (node.create_publisher(mrs.messages.Clock, "/a", QoS.DEFAULT) for _ in range(2))
    subscription = node.create_subscription(mrs.messages.Clock, "a", print)
    assert (node.count_publishers("a"), node.count_subscribers("a")) == (2, 1)
    node.destroy_publisher(publisher)
    node.destroy_subscription(subscription)
    assert other.topic.publishers == (other,) and node.count_subscribers("/a") == 0
    node.destroy_node()
    assert node.count_publishers("/a") == 0
    node.create_publisher(mrs.messages.Clock, "/a", QoS.DEFAULT)
    bus.restore(saved)
    assert node.count_publishers("/a") == 0
