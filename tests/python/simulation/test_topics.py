"""Topics of a simulation: publishing, subscribing and reading, and what happens with misspelled names."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.nodes.interface import QoS
from simulations import drive, small_room


@pytest.fixture
def sim() -> mrs.Simulation:
    return small_room()


def test_a_published_message_can_be_changed_and_published_again(sim):
    node, got = sim.create_node("clerk"), []
    twist, speeds = mrs.messages.Twist(), node.create_publisher(mrs.messages.Twist, "/speeds")
    sim.subscribe("/speeds", mrs.messages.Twist, lambda message: got.append(message.linear.x))
    for speed in (1.0, 2.0):
        twist.linear.x = speed
        speeds.publish(twist)
    twist.linear.x = 0.5
    sim.publish("/cmd_vel", twist)
    twist.linear.x = 9.0
    sim.run_for(1.0)
    assert got == [1.0, 2.0] and sim.latest("/speeds").linear.x == 2.0
    assert sim.pose.x == pytest.approx(1.5)
    scan = mrs.messages.LaserScan(ranges=np.ones(3, np.float32))
    node.create_publisher(mrs.messages.LaserScan, "/scan").publish(scan)
    scan.ranges[0] = 7.0
    assert sim.latest("/scan").ranges[0] == 1.0


def test_unknown_topics_and_wrong_types_are_refused(sim):
    with pytest.raises(ValueError, match=r"unknown topic '/scam'; did you mean /scan\?"):
        sim.latest("/scam")
    with pytest.raises(TypeError, match="/scan carries LaserScan, got Twist"):
        sim.subscribe("/scan", mrs.messages.Twist, print)
    with pytest.raises(TypeError, match="/cmd_vel carries Twist, got Odometry"):
        sim.publish("/cmd_vel", mrs.messages.Odometry())


def test_late_subscribers_get_latched_messages(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.run_for(3.0)
    seen: list[Any] = []
    sim.subscribe("/map", messages.OccupancyGrid, seen.append)
    sim.run_for(0.0)
    assert seen == [sim.latest("/map")]
    assert seen[0].data.tolist() == room.cells.reshape(-1).tolist()


def test_a_topic_can_be_subscribed_before_there_is_a_publisher(sim: mrs.Simulation) -> None:
    seen: list[Any] = []
    sim.subscribe("/plan", messages.String, lambda message: seen.append(message.data))
    with pytest.raises(TypeError, match="/plan carries String, got Twist"):
        sim.create_node("planner").create_publisher(messages.Twist, "plan")
    sim.create_node("planner").create_publisher(messages.String, "plan").publish(messages.String("left"))
    sim.run_for(0.1)
    assert seen == ["left"] and sim.latest("/plan").data == "left"


def test_a_new_name_near_a_known_one_is_subscribed_with_one_warning(
    sim: mrs.Simulation, caplog: pytest.LogCaptureFixture
) -> None:
    seen: list[Any] = []
    for _ in range(2):
        sim.subscribe("scan2", messages.LaserScan, seen.append)
    assert caplog.messages == ["nobody publishes on /scan2 yet; did you mean /scan?"]
    sim.create_node("second").create_publisher(messages.LaserScan, "/scan2").publish(messages.LaserScan())
    sim.subscribe("/plan", messages.String, print)
    sim.run_for(0.0)
    assert len(seen) == 2 and len(caplog.messages) == 1


def test_a_name_that_is_no_text_is_refused(sim: mrs.Simulation) -> None:
    with pytest.raises(TypeError, match=r"name of a topic or service must be a text, got Twist\("):
        sim.publish(messages.Twist(), "/cmd_vel")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="name of a topic or service must be a text, got 3"):
        sim.subscribe(3, messages.Twist, print)  # type: ignore[arg-type]


def test_unsubscribing_ends_the_calls_even_if_done_twice(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    seen: list[Any] = []
    subscription = sim.subscribe("/scan", mrs.messages.LaserScan, seen.append)
    sim.run_for(0.3)
    sim.unsubscribe(subscription)
    sim.unsubscribe(subscription)
    sim.run_for(0.3)
    assert len(seen) == 3


def test_a_callback_must_be_callable(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    with pytest.raises(TypeError, match="callback"):
        sim.subscribe("/scan", mrs.messages.LaserScan, None)  # type: ignore[arg-type]


def test_publishing_many_times_uses_one_publisher_per_topic_and_type(sim, monkeypatch):
    made = []
    create = sim._node.create_publisher
    monkeypatch.setattr(sim._node, "create_publisher", lambda *arguments: made.append(arguments) or create(*arguments))
    for speed in (0.1, 0.2, 0.3):
        drive(sim, speed)
    assert made == [(mrs.messages.Twist, "/cmd_vel", QoS.DEFAULT)]


def test_a_topic_that_a_restore_removed_is_unknown_again(sim):
    state = sim.save()
    sim.create_node("clerk").create_publisher(mrs.messages.Twist, "/speeds")
    sim.publish("/speeds", mrs.messages.Twist())
    sim.restore(state)
    with pytest.raises(ValueError, match="unknown topic '/speeds'"):
        sim.publish("/speeds", mrs.messages.Twist())


def test_a_closed_simulation_has_no_topics_and_says_so(sim):
    drive(sim)
    sim.close()
    for use in (
        lambda: sim.publish("/cmd_vel", mrs.messages.Twist()),
        lambda: sim.latest("/scan"),
        lambda: sim.subscribe("/scan", mrs.messages.LaserScan, print),
        lambda: sim.record(print),
        lambda: sim.record_lazily(print),
        lambda: sim.create_node("late"),
        lambda: sim.spawn(lambda: mrs.bus.Node("late")),
        sim.show,
    ):
        with pytest.raises(RuntimeError, match="the simulation is closed"):
            use()


def test_a_recording_starts_with_the_latched_messages(sim):
    seen: list[tuple[str, int]] = []

    def tap(topic: str, message: Any, time_ns: int) -> None:
        seen.append((topic, time_ns))

    sim.run_for(0.05)
    sim.record(tap)
    assert seen == [("/map", 0)]
    drive(sim)
    sim.stop_recording(tap)
    drive(sim)
    assert seen == [("/map", 0), ("/cmd_vel", 50_000_000)]
    with pytest.raises(ValueError):
        sim.stop_recording(tap)


def test_a_lazy_tap_gets_the_calls_that_build_messages_unless_somebody_else_needs_them(sim):
    lazy: list[tuple[str, Any, int]] = []
    sim.record_lazily(lambda *sent: lazy.append(sent))
    assert [topic for topic, *_ in lazy] == ["/map"] and isinstance(lazy[0][1], mrs.messages.OccupancyGrid)
    sim.run_for(0.1)
    sent = {topic: message for topic, message, _ in lazy}
    assert isinstance(sent["/odom"], partial) and isinstance(sent["/scan"], partial)
    assert sent["/odom"]() == sim.latest("/odom") and sent["/scan"]() == sim.latest("/scan")
    assert [time_ns for topic, _, time_ns in lazy if topic == "/scan"] == [100_000_000]
    sim.subscribe("/odom", mrs.messages.Odometry, lambda message: None)
    drive(sim)
    lazy.clear()
    sim.run_for(0.1)
    sent = {topic: message for topic, message, _ in lazy}
    assert sent["/odom"] is sim.latest("/odom") and isinstance(sent["/scan"], partial)


def test_lazy_taps_can_be_removed_and_must_be_callable(sim):
    def tap(topic: str, message: Any, time_ns: int) -> None:
        seen.append(topic)

    seen: list[str] = []
    sim.record_lazily(tap)
    sim.stop_recording(tap)
    sim.run_for(0.1)
    assert seen == ["/map"]
    with pytest.raises(ValueError, match="must be one that is recording"):
        sim.stop_recording(tap)
    with pytest.raises(TypeError):
        sim.record_lazily("tap")
