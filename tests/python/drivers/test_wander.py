"""Wander: a driver that touches no wall."""

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.commander import Commander
from mobile_robot_simulator.drivers.wander import Wander

SEED = 4


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("beams", [3, 90, 541])
def test_wander_touches_no_wall(seed, beams):
    cells = np.zeros((160, 240), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[60:64, :150] = cells[100:104, 90:] = cells[20:30, 100:110] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.05)
    # Three beams, straight ahead and to the sides, miss obstacles between them. So that drive is only one second long.
    driver, seconds = Wander(speed=0.5), 120.0 if beams > 3 else 1.0
    simulation = mrs.Simulation(
        grid, parameters={"laser_beam_count": beams}, seed=seed, start=grid.draw_free_pose(radius=0.6, seed=seed)
    )
    touched = []
    simulation.subscribe(
        "/odom", mrs.messages.Odometry, lambda _: touched.append(not grid.is_free_disc(*tuple(simulation.pose)[:2], 0.2))
    )
    node = simulation.create_node("driver")
    driver.start(node, Commander(node, "/cmd_vel", stamped=False), "/scan", seed)
    simulation.run_for(seconds)
    assert not any(touched)
    assert simulation.robot.distance > 0.1 * seconds


def test_one_seed_gives_one_path():
    grid = mrs.floor_plan("office", seed=1)
    ends = []
    for _ in range(2):
        simulation = mrs.Simulation(grid, seed=SEED, start=grid.draw_free_pose(radius=0.5, seed=SEED))
        node = simulation.create_node("driver")
        Wander().start(node, Commander(node, "/cmd_vel", stamped=False), "/scan", SEED)
        simulation.run_for(30.0)
        ends.append(tuple(simulation.pose))
    assert ends[0] == ends[1]


def test_the_mark_of_a_beam_without_a_return_does_not_change_the_path():
    grid = mrs.floor_plan("office", seed=1)
    ends = set()
    for no_return in ("inf", "max", "below_max"):
        parameters = {"no_return": no_return, "laser_max_range": 3.0}
        start = grid.draw_free_pose(radius=0.5, seed=SEED)
        simulation = mrs.Simulation(grid, parameters=parameters, seed=SEED, start=start)
        node = simulation.create_node("driver")
        Wander().start(node, Commander(node, "/cmd_vel", stamped=False), "/scan", SEED)
        simulation.run_for(20.0)
        ends.add(tuple(simulation.pose))
    assert len(ends) == 1
