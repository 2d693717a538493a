"""The controller of the example runs unchanged on the bus and on the real rclpy, and drives the same path."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

import mobile_robot_simulator as mrs
from test_nodes import ODOM
from worlds import wait_until

EXAMPLE = Path(__file__).parents[2] / "examples/testing"
PATH = [0.0, 0.0, 2.0, 0.0, 2.0, 1.5]


def drive_on_the_bus() -> np.ndarray[Any, Any]:
    """Drives the path on the bus, with the stand-in for rclpy. Returns the robot's positions x, y [m], shape (N, 2)."""
    from mobile_robot_simulator.testing.rclpy_shim import stand_in

    sys.path.insert(0, str(EXAMPLE))
    with stand_in():
        from followers.pure_pursuit import PurePursuit
    grid = mrs.OccupancyGrid(np.zeros((10, 10), np.int8), resolution=1.0, origin=(-5.0, -5.0, 0.0))
    parameters = {"publish_map_transform": False, "publish_rate": 50.0}
    sim = mrs.Simulation(grid, parameters=parameters)
    sim.spawn(PurePursuit, parameters={"path": PATH})
    sim.run_until(lambda sim: math.hypot(sim.pose.x - 2.0, sim.pose.y - 1.5) < 0.12, 30.0)
    return sim.truth.path[:, 1:3]


def test_one_controller_drives_the_same_path_on_the_bus_and_on_rclpy(world: Any) -> None:
    expected = drive_on_the_bus()
    world.start("robot", publish_rate=50.0, cmd_vel_stamped=False)
    odom = world.subscribe("/odom", ODOM)
    odom.wait_for(1)
    world.environment = {**world.environment, "PYTHONPATH": str(EXAMPLE)}
    controller = world.run(
        sys.executable, "-m", "followers.pure_pursuit", "--ros-args", "-p", f"path:={PATH}", "-p", "use_sim_time:=true"
    )

    def positions() -> np.ndarray[Any, Any]:
        return np.array([(it.pose.pose.position.x, it.pose.pose.position.y) for it in odom])

    wait_until(lambda: math.hypot(*(positions()[-1] - (2.0, 1.5))) < 0.12, "the end of the path", 60.0)
    assert controller.running, controller.output
    distances = [np.hypot(*(expected - point).T).min() for point in positions()]
    assert max(distances) < 0.1
