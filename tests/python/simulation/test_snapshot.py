"""Snapshots: a run after a restore repeats the first run byte for byte."""

from __future__ import annotations

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.bus.node import Node

SEED = 7


def room() -> mrs.OccupancyGrid:
    cells = np.zeros((100, 120), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[40:60, 70:75] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1)


class Patrol(Node):
    """A node whose commands depend on how often its timer has fired and on the scans so far."""

    def __init__(self) -> None:
        super().__init__("patrol")
        self.count, self.turns = 0, [0.3, -0.5, 0.9]
        self.publisher = self.create_publisher(mrs.messages.Twist, "/cmd_vel", 10)
        self.create_subscription(mrs.messages.LaserScan, "/scan", self.on_scan, 10)
        self.timer = self.create_timer(0.13, self.on_timer)

    def on_scan(self, scan: mrs.messages.LaserScan) -> None:
        self.turns.append(float(np.min(scan.ranges)) * 0.1)

    def on_timer(self) -> None:
        self.count += 1
        wz = self.turns[self.count % len(self.turns)]
        self.publisher.publish(mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.4), angular=mrs.messages.Vector3(z=wz)))


def told(messages: list[tuple[str, object, int]]) -> bytes:
    return "\n".join(f"{time} {topic} {message!r}" for topic, message, time in messages).encode()


def run(simulation: mrs.Simulation, seconds: float) -> bytes:
    messages: list[tuple[str, object, int]] = []

    def tap(topic: str, message: object, time_ns: int) -> None:
        messages.append((topic, message, time_ns))

    simulation.record(tap)
    simulation.run_for(seconds)
    simulation.stop_recording(tap)
    with np.printoptions(threshold=1_000_000, floatmode="unique"):
        return told(messages)


def simulation() -> mrs.Simulation:
    simulation = mrs.Simulation(room(), parameters={"laser_beam_count": 31, "z_rand": 0.1}, seed=SEED, start=(2, 2, 0.3))
    simulation.spawn(Patrol)
    return simulation


def test_a_snapshot_can_be_restored_any_number_of_times():
    sim = simulation()
    sim.run_for(3.21)
    state = sim.save()
    first = run(sim, 5.0)
    assert len(first) > 10_000
    for _ in range(2):
        sim.restore(state)
        assert sim.time == pytest.approx(3.21)
        assert run(sim, 5.0) == first


def test_a_restored_run_equals_a_run_that_was_never_saved():
    whole = simulation()
    whole.run_for(2.0)
    expected = run(whole, 4.0)
    sim = simulation()
    sim.run_for(2.0)
    state = sim.save()
    sim.set_pose((8.0, 8.0, 1.0))
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=2.0)))
    sim.laser.stop()
    sim.run_for(1.7)
    sim.restore(state)
    assert run(sim, 4.0) == expected


def test_messages_in_transit_timers_and_calls_are_restored():
    sim = simulation()
    seen: list[str] = []
    node = sim.create_node("clerk")
    timer = node.create_timer(1.0, lambda: seen.append("timer"))
    client = node.create_client(mrs.messages.GetMap, "/static_map")
    future = client.call_async(mrs.messages.GetMap.Request())
    subscription = sim.subscribe("/cmd_vel", mrs.messages.Twist, lambda message: seen.append("message"))
    sim.publish("/cmd_vel", mrs.messages.Twist())
    state = sim.save()
    for _ in range(2):
        seen.clear()
        sim.run_for(0.1)
        assert seen == ["message"] and future.done()
        sim.run_for(0.95)
        assert "timer" in seen
        node.destroy_timer(timer)
        sim.unsubscribe(subscription)
        node.create_timer(0.1, lambda: seen.append("new"))
        sim.run_for(0.3)
        assert "new" in seen
        sim.restore(state)
        assert not future.done() and not timer.is_canceled()


def test_wrong_snapshots_and_saving_in_a_callback_are_refused():
    sim, other = simulation(), simulation()
    with pytest.raises(ValueError, match="must be of this simulation, got one of another"):
        sim.restore(other.save())
    with pytest.raises(TypeError, match="must be a Snapshot from save"):
        sim.restore(3)  # type: ignore[arg-type]
    sim.subscribe("/scan", mrs.messages.LaserScan, lambda scan: sim.save())
    with pytest.raises(RuntimeError, match="a callback must not save"):
        sim.run_for(1.0)


def test_the_error_names_an_attribute_that_cannot_be_copied():
    import threading

    sim = simulation()
    sim.spawn(Patrol).lock = threading.Lock()  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match="lock of node patrol cannot be saved"):
        sim.save()


def test_throttled_log_messages_repeat():
    class Talker(Node):
        def __init__(self) -> None:
            super().__init__("talker")
            self.said: list[bool] = []
            self.create_timer(0.1, self.on_timer)

        def on_timer(self) -> None:
            self.said += [
                self.get_logger().info("so far", throttle_duration_sec=0.25),
                self.get_logger().info("begun", once=True),
            ]

    sim = simulation()
    talker = sim.spawn(Talker)
    state = sim.save()
    sim.run_for(0.45)
    said = list(talker.said)
    assert said == [True, True, False, False, False, False, True, False]
    sim.restore(state)
    sim.run_for(0.45)
    assert talker.said == said


def test_changed_cells_of_the_map_are_restored():
    sim = simulation()
    state = sim.save()
    first = run(sim, 1.0)
    sim.grid.set_cells(10, 30, np.full((80, 1), 100, np.int8))
    second = run(sim, 1.0)
    for _ in range(2):
        sim.restore(state)
        assert sim.grid.cells[50, 30] == 0 and run(sim, 1.0) == first
        sim.grid.set_cells(10, 30, np.full((80, 1), 100, np.int8))
        assert run(sim, 1.0) == second


def test_obstacles_faults_and_kept_objects_added_later_are_removed_and_can_be_added_again():
    sim = simulation()
    sim.run_for(1.05)
    state = sim.save()
    first = run(sim, 0.5)
    box, drop = mrs.Shape.disc(0.4), faults.Drop("/odom")
    probe = type("Probe", (), {})()
    for _ in range(2):
        sim.restore(state)
        sim.add_obstacle(box, (3.0, 2.0, 0.0))
        sim.add_fault(drop)
        sim.keep(probe).count = 1
        assert run(sim, 0.5) != first
        sim.restore(state)
        probe.count = 2
        assert run(sim, 0.5) == first and sim.faults == ()
        sim.restore(state)
        assert probe.count == 2


def test_robots_and_outages_added_later_are_removed():
    sim = mrs.Simulation(room(), robots={"one": (2, 2, 0)}, parameters={"laser_beam_count": 11})
    sim.run_for(1.0)
    state = sim.save()
    sim.add_robot("two", start=(5, 5, 0))
    sim.add_fault(faults.Outage("map_server"))
    sim.run_for(1.0)
    sim.restore(state)
    assert list(sim.robots) == ["one"]
    with pytest.raises(ValueError, match="unknown topic"):
        sim.latest("/two/odom")
    future = (
        sim.create_node("clerk").create_client(mrs.messages.GetMap, "/static_map").call_async(mrs.messages.GetMap.Request())
    )
    sim.run_for(0.1)
    assert future.result().map.info.width == 120
    sim.add_robot("two", start=(5, 5, 0))
    sim.add_fault(faults.Outage("map_server", start=1.5, end=2.0))
    sim.run_for(0.5)
    during = sim.save()
    sim.run_for(1.0)
    sim.restore(during)
    sim.map_server.start()
    assert sim.create_node("clerk").create_client(mrs.messages.GetMap, "/static_map").service_is_ready()
