"""Faults on the real ROS: they act on what leaves the process, on what it receives, and on its robots and nodes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from test_nodes import ODOM, QUIET, SCAN, odom_pose, twist
from worlds import COMMAND, seconds, wait_until

pytestmark = pytest.mark.ros

TEXT = "std_msgs/msg/String"


def start(world: Any, *faults: str, map_file: Path | None = None, node: str = "all", **parameters: Any) -> Any:
    options = [word for fault in faults for word in ("--fault", fault)]
    maps = [str(map_file)] if map_file else []
    return world.run(*COMMAND, node, *maps, *options, *world.arguments({**QUIET, **parameters}, ()))


def test_faults_change_what_leaves_the_process(world: Any, map_file: Path) -> None:
    start(
        world,
        "Drop('odom', probability=0.5, seed=1)",
        "BlockedSector(-0.2, 0.2, distance=0.3)",
        map_file=map_file,
        publish_rate=50.0,
        laser_min_range=0.1,
    )
    odom, scan, reports = world.subscribe("/odom", ODOM), world.subscribe("/scan", SCAN), world.subscribe("/faults", TEXT)
    wait_until(lambda: len(odom) > 50, "odometry")
    stamps = np.array([seconds(message.header.stamp) for message in odom])
    share = len(stamps) / (round((stamps[-1] - stamps[0]) * 50.0) + 1)
    assert 0.2 < share < 0.8
    last = scan.next()
    middle = np.abs(last.angle_min + last.angle_increment * np.arange(len(last.ranges))) < 0.2
    assert np.max(np.array(last.ranges)[middle]) <= np.float32(0.3) < np.max(np.array(last.ranges)[~middle])
    texts = {message.data for message in reports}
    assert "drop /odom" in texts and any(text.endswith("beams of /scan blocked") for text in texts)


def test_faults_change_what_the_process_receives(world: Any) -> None:
    process = start(world, "Delay('cmd_vel', 0.5)", node="robot", velocity_timeout=10.0, cmd_vel_stamped=False)
    odom, publish = world.subscribe("/odom", ODOM), world.publisher("/cmd_vel", "geometry_msgs/msg/Twist")
    before = odom.next()
    publish(twist(0.5, 0.0))
    sent = seconds(before.header.stamp)
    moved = odom.next(lambda message: odom_pose(message).x > 0.0)
    assert seconds(moved.header.stamp) - sent > 0.5, process.output


def test_faults_stop_nodes_and_start_them_again(world: Any, map_file: Path) -> None:
    start(world, "Outage('laser', start=1.0, end=2.5)", map_file=map_file, laser_frequency=20.0)
    reports, scan = world.subscribe("/faults", TEXT), world.subscribe("/scan", SCAN)
    wait_until(lambda: "laser is back" in [message.data for message in reports], "the end of the outage")
    scan.wait_for(2)
    stamps = np.array([seconds(message.header.stamp) for message in scan])
    assert np.max(np.diff(stamps)) == pytest.approx(1.5, abs=0.2)


def test_the_fault_of_one_robot_leaves_the_others_alone(world: Any, map_file: Path) -> None:
    # Not even the first scan passes, at a rate at which one is due while the nodes start.
    start(world, "Blackout('/robot1/scan')", map_file=map_file, robots="[robot1, robot2]", laser_frequency=200.0)
    odom = world.subscribe("/robot1/odom", ODOM)
    first, second = (world.subscribe(f"/{name}/scan", SCAN) for name in ("robot1", "robot2"))
    second.wait_for(10)
    odom.wait_for(2)
    assert not first


def test_parameters_have_faults(world: Any, map_file: Path) -> None:
    world.start("all", map_file=map_file, remap=world.in_namespace("here"), faults="""["Blackout('scan')"]""", **QUIET)
    reports, scan = world.subscribe("/here/faults", TEXT), world.subscribe("/here/scan", SCAN)
    reports.wait_for(3)
    assert reports[-1].data == "blackout of /here/scan" and not scan


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("Drops('/scan')", "unknown fault 'Drops'; did you mean 'Drop'?"),
        ("Drop('/scan', probability=2)", "the probability must be in 0..1, got 2"),
        ("Drop('no name')", "unknown topic 'no name'; there are /"),
        ("Drop('/scna')", "unknown topic '/scna'; did you mean /scan?"),
        ("StuckRanges('/odom')", "StuckRanges needs a topic of LaserScan, /odom carries Odometry"),
        ("ClockJump(1.0)", "needs the simulated clock of a Simulation; on ROS, clocks cannot jump"),
        ("Slip(0.1, robot='b')", "unknown robot 'b'; the only robot has no name"),
        ("Outage('map_server')", "this process does not run a map server"),
    ],
)
def test_wrong_faults_are_errors(world: Any, fault: str, message: str) -> None:
    process = start(world, fault)
    assert process.wait() == 1 and message in " ".join(process.output.split())
