"""Nodes on the bus: names, spawning and destroying."""

from __future__ import annotations

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode, Node, spawn_context
from mobile_robot_simulator.bus.parameter import Parameter

SECOND = 1_000_000_000


def test_a_node_created_outside_of_spawn_is_refused() -> None:
    with pytest.raises(RuntimeError, match=r"Simulation\.spawn"):
        Node("alone")


def test_parameters_given_to_spawn_come_first_and_private_names_are_below_the_node(bus: Bus) -> None:
    class Talker(Node):
        def __init__(self) -> None:
            super().__init__("talker", parameter_overrides=[Parameter("a", value=1), Parameter("b", value=2)])
            self.a, self.b = (self.declare_parameter(name).value for name in "ab")
            self.topic = self.create_publisher(mrs.messages.String, "~/said", 1).topic_name

    with spawn_context(bus, "/robot1", {"b": 3}):
        talker = Talker()
    assert (talker.a, talker.b, talker.topic) == (1, 3, "/robot1/talker/said")


def test_a_destroyed_node_receives_nothing_more(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    leaving = BusNode(bus, "leaving")
    leaving.create_timer(0.1, lambda: seen.append("timer"))
    leaving.create_subscription(mrs.messages.String, "/a", lambda message: seen.append("message"))
    leaving.destroy_node()
    node.create_publisher(mrs.messages.String, "/a").publish(mrs.messages.String("hello"))
    bus.run_until(SECOND)
    assert seen == [] and bus.nodes == [node]


def test_a_node_destroys_only_what_it_has_created(bus: Bus, node: BusNode) -> None:
    seen: list[str] = []
    other = BusNode(bus, "other")
    timer = node.create_timer(0.5, lambda: seen.append("timer"))
    subscription = node.create_subscription(mrs.messages.String, "/a", lambda message: seen.append("message"))
    service = node.create_service(mrs.messages.Trigger, "/b", lambda request, response: seen.append("service") or response)
    assert not other.destroy_timer(timer)
    assert not other.destroy_subscription(subscription)
    assert not other.destroy_service(service)
    other.create_publisher(mrs.messages.String, "/a").publish(mrs.messages.String("hello"))
    other.create_client(mrs.messages.Trigger, "/b").call_async(mrs.messages.Trigger.Request())
    bus.run_until(SECOND // 2)
    assert sorted(seen) == ["message", "service", "timer"]
    assert node.destroy_timer(timer) and node.destroy_subscription(subscription) and node.destroy_service(service)
    assert not (node.destroy_timer(timer) or node.destroy_subscription(subscription) or node.destroy_service(service))
    bus.run_until(2 * SECOND)
    assert len(seen) == 3


@pytest.mark.parametrize("name", ["", "a/b", "/a"])
def test_a_name_that_is_empty_or_contains_a_slash_is_refused(bus: Bus, name: str) -> None:
    with pytest.raises(ValueError, match="must not be empty or contain a slash"):
        BusNode(bus, name)
