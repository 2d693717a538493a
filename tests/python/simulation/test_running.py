"""Running a simulation: for a duration, until a condition holds, or to the next event."""

from __future__ import annotations

import traceback
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from simulations import drive, small_room, twist


@pytest.fixture
def sim() -> mrs.Simulation:
    return small_room()


def test_run_until_stops_when_the_condition_holds(sim):
    drive(sim)
    assert sim.run_until(lambda sim: sim.pose.x >= 2.0, 10.0) == 2.0
    assert sim.time == 2.0


def test_run_until_checks_the_condition_before_it_runs(sim):
    assert sim.run_until(lambda sim: True, 0.0) == 0.0


def test_run_until_includes_the_events_at_its_timeout(sim):
    seen = []
    sim.subscribe("/cmd_vel", mrs.messages.Twist, seen.append)
    drive(sim)
    assert sim.run_until(lambda sim: seen, 0.0) == 0.0
    assert sim.run_until(lambda sim: sim.latest("/scan") is not None, 0.1) == pytest.approx(0.1)


def test_a_timeout_reports_the_state_of_the_simulation(sim):
    drive(sim)

    def home(sim):
        return sim.pose.x if sim.pose.x < 0 else None

    with pytest.raises(TimeoutError) as raised:
        sim.run_until(home, 1.55)
    text = str(raised.value)
    assert sim.time == 1.55
    for part in (
        "the predicate home did not hold within 1.55 s, from 0 s to 1.55 s: it last returned None; ",
        "the robot at (1.77, 1.00, 0.00), moving at (0.50 m/s, 0.00 m/s, 0.00 rad/s); last messages: ",
        "/initialpose never, /map at 0 s, /odom at 1.5 s, ",
    ):
        assert part in text


def test_step_runs_to_the_next_event(sim):
    assert sim.step() == 0.0  # the map and the first messages
    assert sim.step() == pytest.approx(0.1)
    assert sim.latest("/odom") is not None and sim.latest("/scan") is not None
    assert sim.step() == pytest.approx(0.2)


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf")])
def test_negative_and_infinite_durations_are_refused(sim, seconds):
    with pytest.raises(ValueError, match="the timeout must be finite"):
        sim.run_until(lambda sim: False, seconds)
    with pytest.raises(ValueError, match="the duration must be finite"):
        sim.run_for(seconds)


def test_callbacks_can_publish_create_timers_and_call_services(sim):
    node, seen = sim.create_node("clerk"), []
    client = node.create_client(mrs.messages.GetMap, "static_map")

    def on_scan(scan):
        if not seen:
            seen.append("scan")
            drive(sim)
            node.create_timer(0.25, lambda: seen.append(f"timer {sim.time:g}"))
            client.call_async(mrs.messages.GetMap.Request()).add_done_callback(
                lambda future: seen.append(f"map {future.result().map.info.width}")
            )

    sim.subscribe("/scan", mrs.messages.LaserScan, on_scan)
    sim.run_for(0.4)
    assert seen == ["scan", "map 50", "timer 0.35"]
    assert sim.pose.x == pytest.approx(1.15)


def test_an_exception_in_a_callback_keeps_its_traceback_and_the_simulation_can_be_run_further(sim):
    def on_scan(scan):
        raise KeyError("mine")

    subscription = sim.subscribe("/scan", mrs.messages.LaserScan, on_scan)
    with pytest.raises(KeyError, match="mine") as raised:
        sim.run_for(1.0)
    assert raised.traceback[-1].name == "on_scan"
    sim.unsubscribe(subscription)
    sim.run_for(1.0)
    assert sim.time == pytest.approx(1.1)


def test_endless_loops_at_one_time_are_an_error(sim):
    node = sim.create_node("clerk")
    with pytest.raises(ValueError, match="period must be at least 1 ns"):
        node.create_timer(0.0, lambda: None)
    publisher = node.create_publisher(mrs.messages.Twist, "/ping")
    node.create_subscription(mrs.messages.Twist, "/ping", publisher.publish)
    publisher.publish(mrs.messages.Twist())
    with pytest.raises(RuntimeError, match="time stands still at 0"):
        sim.run_for(1.0)


def test_closing_twice_does_no_harm(sim):
    with sim:
        sim.close()
    with pytest.raises(RuntimeError, match="the simulation is closed"):
        sim.run_for(1.0)


def test_an_exception_in_a_callback_stops_the_run_at_that_time(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    seen: list[Any] = []

    def complain(scan: mrs.messages.LaserScan) -> None:
        seen.append(scan)
        if len(seen) == 3:
            raise RuntimeError("too dark")

    sim.subscribe("/scan", mrs.messages.LaserScan, complain)
    with pytest.raises(RuntimeError, match="too dark") as caught:
        sim.run_for(1.0)
    assert "complain" in [frame.name for frame in traceback.extract_tb(caught.value.__traceback__)]
    assert sim.time == pytest.approx(0.3)
    sim.run_for(0.7)
    assert (len(seen), sim.time) == (10, 1.0)


def test_a_callback_that_publishes_to_itself_is_an_error(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.subscribe("/cmd_vel", mrs.messages.Twist, lambda message: sim.publish("/cmd_vel", message))
    sim.publish("/cmd_vel", twist(1.0))
    with pytest.raises(RuntimeError, match="time stands still"):
        sim.run_for(1.0)


def test_a_callback_must_not_run_the_simulation(room: mrs.OccupancyGrid) -> None:
    sim = mrs.Simulation(room)
    sim.subscribe("/scan", mrs.messages.LaserScan, lambda scan: sim.run_for(1.0))
    with pytest.raises(RuntimeError, match="must not run"):
        sim.run_for(1.0)


def test_ten_minutes_run_without_waiting(room: mrs.OccupancyGrid) -> None:
    """A run with 6000 scans and 6000 transforms ends soon, because nothing sleeps."""
    sim = mrs.Simulation(room, parameters={"laser_beam_count": 31})
    sim.run_for(600.0)
    assert sim.latest("/scan").header.stamp == mrs.messages.Time(600, 0)


def test_a_predicate_must_be_callable(sim):
    with pytest.raises(TypeError, match="predicate must be a function of the simulation, got True"):
        sim.run_until(True, 1.0)
