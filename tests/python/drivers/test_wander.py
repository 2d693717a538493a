"""Wander: a driver that touches no wall."""

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.commander import Commander
from mobile_robot_simulator.drivers.wander import HEADINGS, NO_RETURN_MARGIN, Wander, Wandering

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


def free_lane(scan, heading, half_width):
    """The specification: how far the lane along a heading is free. Beam by beam, with the roundings of the driver."""
    free = np.float32(scan.range_max)
    for beam, reading in enumerate(scan.ranges):
        if not reading < scan.range_max - NO_RETURN_MARGIN:
            continue
        offset = scan.angle_min + beam * scan.angle_increment - heading
        reading = max(reading, np.float32(1e-3))
        along, across = reading * np.float32(np.cos(offset)), abs(reading * np.float32(np.sin(offset)))
        if along > 0.0 and across < half_width:
            free = min(free, along)
    return free


@pytest.mark.parametrize("beams", [1, 2, 181, 541])
def test_a_lane_is_free_up_to_the_nearest_return_in_it(beams):
    random = np.random.default_rng(SEED)
    driver = Wander()
    for span in (1.0, 4.7, 6.28):
        ranges = (random.random(beams) ** 3 * 12.0).astype(np.float32)
        for mark in (np.inf, -np.inf, np.nan, 10.0, 9.9, 0.0):
            ranges[random.random(beams) < 0.1] = mark
        scan = mrs.messages.LaserScan(angle_min=-span / 2, angle_increment=span / beams, range_max=10.0, ranges=ranges)
        free = Wandering(driver, SEED)._free_distances(scan)
        assert free.dtype == np.float32
        assert free.tolist() == [free_lane(scan, heading, driver.radius + driver.margin) for heading in HEADINGS]
