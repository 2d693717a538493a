"""Goal: a driver that takes a robot around walls and obstacles."""

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.goal import MARGINS, Goal, Travel, plan

RADIUS = 0.2


def divided_room(*, yaw: float = 0.0) -> mrs.OccupancyGrid:
    """A room of 12 m by 8 m, in halves that a door of 1 m at its upper end joins."""
    cells = np.zeros((160, 240), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[:140, 118:122] = 100
    return mrs.OccupancyGrid(cells, resolution=0.05, origin=(1.0, -2.0, yaw))


def travel(grid, start, goal, *, obstacles=(), seconds=60.0, moved=None):
    """Drives to a goal. Returns the simulation and the time until the driver says that it is there, or None."""
    sim = mrs.Simulation(grid, parameters={"robot_radius": RADIUS, "laser_frequency": 0.1}, start=start)
    for each in obstacles:
        sim.add_obstacle(*each)
    driver = Travel(Goal(mrs.Pose(*goal), RADIUS))
    for turn in range(round(seconds / 0.1)):
        if moved is not None and turn == moved[0]:
            sim.move_obstacle("1", moved[1])
        around = [(each.shape, each.pose(round(sim.time * 1e9))) for each in sim.obstacles]
        velocity = driver.velocity(grid, around, sim.pose)
        if velocity is None:
            return sim, sim.time
        vx, vy, wz = velocity
        sim.publish("/cmd_vel", mrs.messages.Twist(mrs.messages.Vector3(vx, vy), mrs.messages.Vector3(z=wz)))
        sim.run_for(0.1)
    return sim, None


def is_at(pose, goal):
    return math.dist(tuple(pose)[:2], goal[:2]) < 0.06 and abs(math.remainder(pose.yaw - goal[2], 2 * math.pi)) < 0.04


@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_it_goes_through_the_door(yaw):
    grid = divided_room(yaw=yaw)
    start, goal = (tuple(grid.origin * mrs.Pose(*each)) for each in ((2.0, 1.0, 0.0), (10.0, 1.0, 1.5)))
    sim, time = travel(grid, start, goal)
    assert time is not None and is_at(sim.pose, goal)
    assert not sim.truth.contacts
    # Straight to the door, through it and down again takes 2 * hypot(4, 6.5) = 15.3 m.
    assert 15.0 < sim.truth.distance < 18.0


def test_it_finds_another_way_when_an_obstacle_comes():
    grid, goal = divided_room(), (8.0, -1.0, 0.0)
    cells = np.array(grid.cells)
    cells[10:40, 118:122] = 0  # a second door, near the start and the goal
    grid = mrs.OccupancyGrid(cells, resolution=0.05, origin=(1.0, -2.0, 0.0))
    block = (mrs.Shape.rectangle(0.5, 3.0), (3.0, 3.0, 0.0))
    sim, time = travel(grid, (5.0, -1.0, 0.0), goal, obstacles=[block], moved=(5, (7.0, -1.0, 0.0)))
    assert time is not None and is_at(sim.pose, goal) and not sim.truth.contacts
    assert sim.truth.distance > 10.0  # through the far door


def test_the_route_keeps_the_largest_margin_that_there_is_room_for():
    grid, start, goal = divided_room(), mrs.Pose(3.0, 0.0), mrs.Pose(11.0, 0.0)
    route, margin = plan(grid, [], RADIUS, start, goal)
    assert margin == MARGINS[1] and tuple(route[-1]) == (11.0, 0.0)  # the door is 0.95 m wide
    _, margin = plan(grid, [], 0.45, start, goal)
    assert margin < 0.05


def test_no_way_is_an_error():
    cells = np.zeros((100, 100), np.int8)
    cells[:, 50] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    driver = Travel(Goal(mrs.Pose(8.0, 5.0), RADIUS))
    with pytest.raises(ValueError, match=r"no way to the goal \(8.00, 5.00\) that is wide enough"):
        driver.velocity(grid, [], mrs.Pose(2.0, 5.0))
    with pytest.raises(ValueError, match="needs the goal on the map"):
        Travel(Goal(mrs.Pose(80.0, 5.0), RADIUS)).velocity(grid, [], mrs.Pose(2.0, 5.0))


@pytest.mark.parametrize("seed", range(3))
def test_it_reaches_places_of_an_office_without_contact(seed):
    grid = mrs.floor_plan("office", seed=1)
    start, goal = grid.draw_free_poses(2, radius=0.6, seed=seed)
    sim, time = travel(grid, tuple(start), tuple(goal), seconds=200.0)
    assert time is not None and is_at(sim.pose, tuple(goal)) and not sim.truth.contacts
