"""WaitingLog: nodes say what they wait for, not too often, and what they have got."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.handle import Handles
from mobile_robot_simulator.instant import Instant
from mobile_robot_simulator.nodes.waiting import WaitingLog
from mobile_robot_simulator.parameters import LaserParameters, RobotParameters

SECOND = 1_000_000_000
GRID = mrs.OccupancyGrid(np.zeros((10, 10), np.int8), resolution=1.0)


class FakeNode:
    """A node on wall time, which `run` lets pass. Its clock follows only while `clock_runs`."""

    def __init__(self) -> None:
        self.wall, self.time_ns, self.clock_runs = 0, 0, True
        self.log: list[tuple[int, str, str]] = []
        self.timers: list[Callable[[], None]] = []

    def create_wall_timer(self, period: float, callback: Callable[[], None]) -> Any:
        assert period == 1.0
        self.timers.append(callback)
        return callback

    def destroy_timer(self, timer: Any) -> None:
        self.timers.remove(timer)

    def get_clock(self) -> Any:
        return self

    def now(self) -> Instant:
        return Instant(self.time_ns)

    def get_logger(self) -> Any:
        return self

    def info(self, message: str) -> None:
        self.log.append((self.wall, "info", message))

    def warning(self, message: str) -> None:
        self.log.append((self.wall, "warning", message))

    def run(self, seconds: int) -> None:
        for _ in range(seconds):
            self.wall += 1
            self.time_ns += SECOND if self.clock_runs else 0
            for timer in self.timers:
                timer()


class Rig:
    """A log on a fake node, and the dict of what is missing."""

    def __init__(self) -> None:
        self.node, self.missing, self.handles = FakeNode(), dict[str, str](), Handles()
        self.waiting = WaitingLog(self.node, "the cook", lambda: self.missing)  # type: ignore[arg-type]
        self.waiting.start(self.handles)


def test_a_wait_is_logged_once_it_is_two_seconds_long_then_every_ten_until_it_is_over() -> None:
    rig = Rig()
    rig.missing = {"salt": "from the shelf", "water": "from the tap"}
    rig.node.run(24)
    del rig.missing["salt"]
    rig.node.run(1)
    rig.missing.clear()
    rig.node.run(30)
    both = "the cook waits for salt (from the shelf); water (from the tap)"
    assert rig.node.log == [
        (3, "warning", both),
        (13, "warning", both),
        (23, "warning", both),
        (25, "info", "the cook has salt now"),
        (26, "info", "the cook has water now"),
    ]


def test_short_waits_are_not_logged_and_frequent_ones_at_most_every_ten_seconds() -> None:
    rig = Rig()
    for _ in range(10):
        rig.missing = {"salt": "from the shelf"}
        rig.node.run(2)
        rig.missing = {}
        rig.node.run(1)
    assert rig.node.log == []
    for _ in range(10):
        rig.missing = {"salt": "from the shelf"}
        rig.node.run(4)
        rig.missing = {}
        rig.node.run(1)
    reports = [wall for wall, level, _ in rig.node.log if level == "warning"]
    assert len(reports) == 5 and min(np.diff(reports)) >= 10


def test_a_clock_that_stands_still_is_waited_for() -> None:
    rig = Rig()
    rig.node.clock_runs = False
    rig.node.run(5)
    rig.node.clock_runs = True
    rig.node.run(12)
    rig.node.clock_runs = False
    rig.node.run(5)
    assert [message for _, _, message in rig.node.log] == [
        "the cook waits for the time (on topic /clock, where none has arrived)",
        "the cook has the time now",
        "the cook waits for the time (on topic /clock, which stands still at 12.00 s)",
    ]


def test_nothing_is_logged_after_the_handles_are_closed() -> None:
    rig = Rig()
    rig.missing = {"salt": "from the shelf"}
    rig.handles.close()
    rig.node.run(30)
    assert rig.node.log == []


# --- what the nodes wait for ------------------------------------------------------------------------------------------


class Transforms:
    """Publishes transforms that follow the time of a bus."""

    def __init__(self, bus: Bus) -> None:
        self.bus, self.node = bus, NoCopyNode(bus, "transforms")

    def send(self, parent: str, child: str) -> None:
        header = messages.Header(messages.Time.from_nanoseconds(self.bus.time_ns), parent)
        transform = messages.TransformStamped(header, child)
        self.node.create_publisher(messages.TFMessage, "/tf").publish(messages.TFMessage([transform]))

    def send_until(self, seconds: float, *links: tuple[str, str]) -> None:
        while self.bus.time_ns < seconds * SECOND:
            for parent, child in links:
                self.send(parent, child)
            self.bus.run_until(self.bus.time_ns + SECOND // 5)


def test_a_laser_says_what_it_waits_for(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    bus = Bus()
    mrs.nodes.LaserScannerSimulator(
        NoCopyNode(bus, "laser"), LaserParameters(base_link_frame="base_footprint", laser_frame_id="base_footprint")
    ).start()
    transforms = Transforms(bus)
    bus.run_until(5 * SECOND)
    mrs.nodes.MapServer(NoCopyNode(bus, "map_server"), GRID).start()
    transforms.send_until(15, ("map", "odom"), ("odom", "base_link"))
    transforms.send_until(20, ("map", "odom"), ("odom", "base_footprint"))
    bus.run_until(40 * SECOND)
    pose = "the laser waits for the robot's pose (the transform from base_footprint to map, "
    assert [record.message for record in caplog.records if "using a map" not in record.message] == [
        "the laser waits for the map (on topic /map or from service /static_map); "
        "the robot's pose (the transform from base_footprint to map, on topic /tf, where none has arrived)",
        "the laser has the map now",
        f"{pose}on topic /tf, which has the frames base_link, map, odom)",
        "the laser has the robot's pose now",
        f"{pose}but the last one from base_footprint to odom is 3.2 s old)",
        f"{pose}but the last one from base_footprint to odom is 13.2 s old)",
    ]


def test_a_laser_waits_for_its_mount(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    bus = Bus()
    mrs.nodes.LaserScannerSimulator(NoCopyNode(bus, "laser"), LaserParameters(laser_frame_id="scan"), grid=GRID).start()
    transforms = Transforms(bus)
    transforms.send_until(5, ("map", "base_link"))
    assert bus.latest("/scan") is None
    transforms.send_until(6, ("map", "base_link"), ("base_link", "scan"))
    assert bus.latest("/scan") is not None
    assert [record.message for record in caplog.records] == [
        "the laser waits for its mount (laser_mount, or the transform from scan to base_link, on topic /tf, which has the "
        "frames base_link, map)",
        "the laser has its mount now",
    ]


def test_a_robot_waits_for_the_map_only_if_it_has_a_footprint(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    bus = Bus()
    parameters = RobotParameters(map_topic="", map_service="/floor")
    robot = mrs.nodes.MobileRobotSimulator(NoCopyNode(bus, "robot"), parameters)
    robot.start()
    bus.run_until(10 * SECOND)
    assert not caplog.records
    robot.set_parameters(robot_radius=0.2)
    bus.run_until(14 * SECOND)
    mrs.nodes.MapServer(NoCopyNode(bus, "map_server"), GRID, service="/floor").start()
    bus.run_until(30 * SECOND)
    assert [record.message for record in caplog.records if "using a map" not in record.message] == [
        "the robot waits for the map (from service /floor; a robot with a footprint ignores commands without it)",
        "the robot has the map now",
    ]


def test_nodes_of_a_simulation_wait_for_nothing(caplog: pytest.LogCaptureFixture) -> None:
    sim = mrs.Simulation(GRID, start=(5.0, 5.0, 0.0))
    sim.run_for(30.0)
    assert not caplog.records
