"""The replacement for rclpy: files written for rclpy run unchanged on the bus, and it leaves nothing behind."""

from __future__ import annotations

import copy
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.instant import Duration, Instant
from mobile_robot_simulator.testing.rclpy_shim import stand_in

EXAMPLE = Path(__file__).parents[3] / "examples/testing"


@pytest.fixture
def followers(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLE))
    with stand_in():
        from followers import pure_pursuit, wall_follower
    yield pure_pursuit.PurePursuit, wall_follower.WallFollower
    for name in [name for name in sys.modules if name.partition(".")[0] == "followers"]:
        del sys.modules[name]


def hall(**parameters) -> mrs.Simulation:
    cells = np.zeros((120, 120), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    return mrs.Simulation(grid, parameters={"publish_map_transform": False, **parameters}, start=(2, 2, 0))


def test_a_pure_pursuit_node_for_rclpy_runs_on_the_bus(followers):
    sim = hall()
    node = sim.spawn(followers[0], parameters={"path": [2.0, 2.0, 8.0, 2.0, 8.0, 8.0]})
    assert node.get_name() == "pure_pursuit"
    sim.run_until(lambda sim: np.hypot(sim.pose.x - 8.0, sim.pose.y - 8.0) < 0.15, 40.0)
    path = sim.truth.path
    off = np.minimum(np.abs(path[:, 2] - 2.0), np.abs(path[:, 1] - 8.0))
    assert off.max() < 0.25
    sim.run_for(2.0)
    assert sim.truth.velocity == (0.0, 0.0, 0.0)


def test_a_wall_follower_node_for_rclpy_drives_around_the_hall(followers):
    sim = hall()
    sim.set_pose((6.0, 1.5, 0.0))
    sim.spawn(followers[1])
    sim.run_for(100.0)
    path = sim.truth.path[100:]
    to_wall = np.minimum(np.minimum(path[:, 1], path[:, 2]), np.minimum(12.0 - path[:, 1], 12.0 - path[:, 2])) - 0.1
    assert sim.truth.distance > 35.0 and 0.5 < to_wall.min() and to_wall.max() < 1.3


def test_a_namespace_applies_to_relative_names(followers):
    sim = hall()
    sim.spawn(followers[1], namespace="/second")
    sim.run_for(0.1)
    assert sim.latest("/second/cmd_vel") is None and sim.latest("/cmd_vel") is None


def test_the_stand_in_is_gone_after_its_block():
    before = {name: module for name, module in sys.modules.items() if "rclpy" in name or "_msgs" in name}
    with stand_in():
        import rclpy
        from rclpy.qos import QoSDurabilityPolicy, QoSProfile

        assert QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL).depth == 1
        with pytest.raises(RuntimeError, match=r"sim\.run_for"):
            rclpy.spin(None)
    after = {name: module for name, module in sys.modules.items() if "rclpy" in name or "_msgs" in name}
    assert {name for name in after if name in ("rclpy", "sensor_msgs", "rclpy.node")} <= set(before)


def test_the_clock_of_a_node_shows_simulated_time():
    sim = hall()
    node = sim.create_node("clerk")
    began = node.get_clock().now()
    sim.run_for(1.5)
    now = node.get_clock().now()
    assert (now - began).nanoseconds == 1_500_000_000 and now - Duration(seconds=1.5) == began and now > began
    assert now.seconds_nanoseconds() == (1, 500_000_000) and Instant.from_msg(now.to_msg()) == now


def test_times_parameters_and_classes_have_the_interface_of_rclpy():
    with stand_in():
        from rclpy.parameter import Parameter
        from rclpy.publisher import Publisher
        from rclpy.time import Time
        from rclpy.timer import Timer
    assert Time() == Time(seconds=0) and Time(seconds=1.5, nanoseconds=2).nanoseconds == 1_500_000_002
    node = hall().create_node("clerk")
    assert isinstance(node.get_clock().now(), Time) and copy.deepcopy(Time(seconds=1)) == Time(seconds=1)
    node.declare_parameter("speed", 0.5)
    (result,) = node.set_parameters([Parameter("speed", Parameter.Type.DOUBLE, 0.75)])
    assert result.successful and node.get_parameter("speed").value == 0.75
    assert isinstance(node.create_publisher(mrs.messages.Twist, "/x", 1), Publisher)
    assert isinstance(node.create_timer(1.0, print), Timer)


def test_an_installed_rclpy_is_available_again_after_the_block(monkeypatch):
    real = ModuleType("rclpy")
    monkeypatch.setitem(sys.modules, "rclpy", real)
    with stand_in():
        import rclpy

        assert rclpy is not real
    assert sys.modules["rclpy"] is real and "rclpy.node" not in sys.modules


def test_an_import_of_something_missing_names_what_there_is():
    with stand_in():
        with pytest.raises(ImportError, match=r"geometry_msgs\.msg has no PoseStampd; did you mean PoseStamped"):
            from geometry_msgs.msg import PoseStampd  # noqa: F401
        with pytest.raises(ImportError, match=r"nav_msgs\.srv has no Xyzzy; there are GetMap, GetPlan"):
            from nav_msgs.srv import Xyzzy  # noqa: F401
        with pytest.raises(ModuleNotFoundError, match=r"no module rclpy\.lifecycles; there are rclpy\.action"):
            import rclpy.lifecycles  # noqa: F401
