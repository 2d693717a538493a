"""GroundTruth: exact poses and paths, distances, contacts and clearances."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from simulations import drive, hall, small_room


@pytest.fixture
def sim() -> mrs.Simulation:
    return small_room()


def test_each_point_of_the_path_is_exact(sim):
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=1.0), angular=mrs.messages.Vector3(z=1.0)))
    sim.run_for(0.75)
    sim.publish("/cmd_vel", mrs.messages.Twist())
    sim.run_for(0.5)
    path = sim.truth.path
    assert path.shape[1] == 4 and np.all(np.diff(path[:, 0]) >= 0.0) and np.diff(path[:, 0]).max() <= 0.1 + 1e-12
    turned = np.minimum(path[:, 0], 0.75)
    assert path[:, 1] == pytest.approx(1.0 + np.sin(turned))
    assert path[:, 2] == pytest.approx(2.0 - np.cos(turned))
    assert path[-1] == pytest.approx([1.25, *sim.truth.pose])
    assert sim.truth.distance == pytest.approx(0.75)


def test_pose_path_and_distance_agree_between_two_steps():
    """The robot starts 0.509 m from a disc, so that they touch in the middle of a time step."""
    parameters = {"velocity_timeout": 0, "apply_noise": False, "robot_radius": 0.3}
    sim = mrs.Simulation(hall(), parameters=parameters, start=(10.0, 10.0, 0.0))
    sim.add_obstacle(mrs.Shape.disc(0.3), (11.109, 10.0, 0.0))
    drive(sim, 1.0)
    for moment in (0.009, 0.507, 0.515):
        sim.run_for(moment - sim.time)
        expected = (10.0 + min(moment, 0.509), 10.0, 0.0)
        assert tuple(sim.truth.pose) == pytest.approx(expected, abs=2e-6)
        assert sim.truth.path[-1] == pytest.approx([moment, *sim.truth.pose], abs=1e-12)
        assert tuple(sim.truth.pose_at(moment)) == pytest.approx(tuple(sim.truth.pose), abs=1e-12)
        assert sim.truth.pose_at(moment - 0.004).x == pytest.approx(10.0 + min(moment - 0.004, 0.509), abs=2e-6)
    (contact,) = sim.truth.contacts
    sim.run_for(0.1)
    assert sim.truth.contacts == [contact] and contact.time == pytest.approx(0.509, abs=1e-5)


def test_clearances_are_limited_to_ten_metres():
    sim = mrs.Simulation(hall(30.0), start=(9.6, 15.0, 0.0))
    assert sim.truth.clearance == pytest.approx(9.5, abs=1e-5)
    sim.set_pose((15.0, 15.0, 0.0))
    assert sim.truth.clearance == 10.0


def test_clearances_know_where_everything_was():
    sim = mrs.Simulation(hall(), parameters={"velocity_timeout": 0, "robot_radius": 0.3}, start=(4.0, 4.0, 0.0))
    disc, start = mrs.Shape.disc(0.3), sim.time
    sim.add_obstacle(disc, (16.0, 4.0, 0.0))
    sim.add_obstacle(disc, [(1.0, 4.0, 8.0, 0.0), (2.0, 7.0, 8.0, 0.0)], name="cart")
    drive(sim, 1.0)
    sim.run_for(3.0)
    path = sim.truth.path
    assert len(path) > 30 and start == 0.0

    def expected(time: float, x: float, y: float, yaw: float) -> float:
        cart = (4.0 + 3.0 * min(1.0, max(0.0, time - 1.0)), 8.0, 0.0)
        around = [(disc, (16.0, 4.0, 0.0)), (disc, cart)]
        return mrs.clearance(sim.grid, disc, (x, y, yaw), limit=3.5, obstacles=around)

    found = sim.truth.clearances(path, limit=3.5)
    assert found == pytest.approx([expected(*row) for row in path], abs=1e-9)
    assert found[0] == pytest.approx(3.4) and 3.4 < found[15] <= 3.5
    assert sim.truth.clearances(path[:0]).shape == (0,)
    assert sim.truth.clearances(path[-1:])[0] == sim.truth.clearance


@pytest.mark.parametrize("time", [-0.1, 0.5, math.inf, math.nan])
def test_the_pose_is_known_until_now_only(sim, time):
    with pytest.raises(ValueError, match=rf"the time must be in 0\.\.0 s, got {time}"):
        sim.truth.pose_at(time)


def test_the_repr_shows_pose_and_distance(sim):
    drive(sim)
    sim.run_for(2.0)
    assert repr(sim.truth) == "GroundTruth(the robot at (2.00, 1.00, 0.00), 1.00 m driven in 2 s)"
