"""The pure-pursuit controller follows its path, also with lost and late messages and with drifting odometry."""

import math

import numpy as np
import pytest
from followers.pure_pursuit import PurePursuit

from mobile_robot_simulator import OccupancyGrid, faults
from mobile_robot_simulator.testing.assertions import assert_clearance, assert_no_contact, assert_rate, assert_reaches

PATH = [(2.0, 2.0), (8.0, 2.0), (8.0, 7.0), (3.0, 7.0)]


def hall():
    """Returns a hall of 10 m by 9 m with a block of 3 m by 2 m in its middle."""
    cells = np.zeros((180, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[70:110, 70:130] = 100
    return OccupancyGrid(cells, resolution=0.05)


@pytest.fixture
def follow(simulation):
    """Returns a function that makes a simulation with a controller that follows PATH, which is in the map frame."""

    def follow(**parameters):
        given = {"publish_map_transform": False, "publish_rate": 20.0, "robot_radius": 0.25, **parameters}
        sim = simulation(hall(), start=(2.0, 2.0, 0.0), parameters=given)
        sim.spawn(PurePursuit, parameters={"path": [number for point in PATH for number in point]})
        return sim

    return follow


def test_the_robot_reaches_the_end_of_the_path(follow):
    sim = follow()
    assert_reaches(sim, PATH[-1], within=40.0, tolerance=0.15)
    assert_no_contact(sim)
    assert_clearance(sim, 0.5)


def test_commands_are_published_at_the_configured_rate(follow):
    assert_rate(follow(), "/cmd_vel", 20.0, over=5.0)


def test_lost_and_late_odometry_is_tolerated(follow):
    sim = follow()
    sim.add_fault(faults.Drop("/odom", probability=0.3, seed=1))
    sim.add_fault(faults.Delay("/odom", 0.05, jitter=0.1, seed=2))
    assert_reaches(sim, PATH[-1], within=45.0, tolerance=0.3)
    assert_no_contact(sim)


def test_the_robot_stops_within_its_acceleration_limits(follow):
    sim = follow(acceleration_limits=(0.5, 0.5, 3.0))
    assert_reaches(sim, PATH[-1], within=60.0, tolerance=0.3)
    sim.run_for(3.0)
    assert sim.truth.velocity == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("seed", range(3))
def test_a_small_drift_causes_a_small_error(follow, seed):
    sim = follow(odometry_alphas=(0.01, 0.002, 0.002, 0.01, 0.001, 0.001), odometry_seed=seed)
    assert_reaches(sim, PATH[-1], within=45.0, tolerance=1.0)
    believed, true = sim.robot.believed_pose, sim.truth.pose
    assert 0.0 < math.hypot(believed.x - true.x, believed.y - true.y) < 1.0


def test_a_restored_run_ends_the_same_way(follow):
    sim = follow()
    sim.run_for(8.0)
    state = sim.save()
    ends = []
    for _ in range(2):
        assert_reaches(sim, PATH[-1], within=40.0, tolerance=0.15)
        ends.append((sim.time, tuple(sim.pose)))
        sim.restore(state)
    assert ends[0] == ends[1]
