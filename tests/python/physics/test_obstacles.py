"""obstacles: an obstacle follows its trajectory, scanners see it, and robots collide with it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.physics import Obstacle
from simulations import drive, hall, simulation


def test_waypoints_are_interpolated():
    obstacle = Obstacle("x", mrs.Shape.disc(1.0), [(1.0, 0.0, 0.0, 0.0), (3.0, 4.0, 2.0, 1.0)])
    assert [tuple(obstacle.pose(round(time * 1e9))) for time in (0, 1, 2, 3, 4)] == [
        (0, 0, 0),
        (0, 0, 0),
        (2, 1, 0.5),
        (4, 2, 1),
        (4, 2, 1),
    ]
    with pytest.raises(ValueError, match="times of waypoints must increase"):
        Obstacle("x", mrs.Shape.disc(1.0), [(1.0, 0, 0, 0), (1.0, 1, 1, 1)])
    with pytest.raises(ValueError, match=r"a waypoint must be four finite numbers \(time, x, y, yaw\)"):
        Obstacle("x", mrs.Shape.disc(1.0), [(1.0, 0, 0), (2.0, 1, 1)])


def ranges(sim: mrs.Simulation) -> np.ndarray:
    return np.asarray(sim.latest("/scan").ranges, np.float64)


def test_scans_of_a_moving_disc_equal_the_closed_form():
    sim = simulation(start=(10.0, 10.0, 0.3))
    sim.add_obstacle(mrs.Shape.disc(0.7), lambda time: (10.0 + 3.0 * math.cos(time), 10.0 + 3.0 * math.sin(time), 0.0))
    angles = np.linspace(-math.pi, math.pi, 61, endpoint=False) + 0.3
    for _ in range(20):
        sim.run_for(0.1)
        center = 3.0 * np.exp(1j * sim.time) * np.exp(-1j * angles)
        hits = np.abs(center.imag) < 0.7 - 1e-9
        hits &= center.real > 0
        expected = center.real[hits] - np.sqrt(0.49 - center.imag[hits] ** 2)
        assert hits.sum() >= 3 and ranges(sim)[hits] == pytest.approx(expected, abs=1e-6)
        assert ranges(sim)[~hits].min() > 3.0


def test_scans_of_a_moving_polygon_equal_the_closed_form():
    sim = simulation(start=(10.0, 10.0, 0.0))
    sim.add_obstacle(mrs.Shape.rectangle(0.2, 2.0), [(0.0, 12.0, 10.0, 0.0), (10.0, 17.0, 10.0, 0.0)])
    for _ in range(5):
        sim.run_for(1.0)
        assert ranges(sim)[30:32].min() == pytest.approx(1.9 + 0.5 * sim.time, rel=2e-3)


def test_an_obstacle_on_whole_cells_gives_the_same_scan_as_the_cells():
    sim = simulation(start=(10.0, 10.0, 0.1))
    sim.add_obstacle(mrs.Shape.rectangle(0.5, 0.3), (12.25, 10.45, 0.0))
    cells = hall().cells.copy()
    cells[103:106, 120:125] = 100
    drawn = mrs.Simulation(
        mrs.OccupancyGrid(cells, resolution=0.1),
        parameters={name: getattr(sim.laser.parameters, name) for name in ("apply_noise", "laser_beam_count", "laser_fov")},
        start=(10.0, 10.0, 0.1),
    )
    sim.run_for(0.1)
    drawn.run_for(0.1)
    assert ranges(sim) == pytest.approx(ranges(drawn), abs=1e-6)


def test_a_robot_stops_at_an_obstacle_and_is_touched_by_a_moving_one():
    sim = simulation(robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.disc(0.5), (5.0, 2.0, 0.0), name="pillar")
    drive(sim, 1.0)
    sim.run_for(5.0)
    assert sim.pose.x == pytest.approx(4.2, abs=1e-5)
    drive(sim, 0.0)
    sim.set_pose((10.0, 10.0, 0.0))
    sim.add_obstacle(mrs.Shape.rectangle(1.0, 1.0), [(5.0, 14.0, 10.0, 0.0), (9.0, 10.0, 10.0, 0.0)], name="cart")
    sim.run_until(lambda sim: len(sim.truth.contacts) == 2, 10.0)
    pillar, cart = sim.truth.contacts
    assert (pillar.what, cart.what) == ("obstacle pillar", "obstacle cart")
    assert cart.time == pytest.approx(8.2, abs=0.03)


def test_the_function_of_an_obstacle_may_read_the_robot():
    """The obstacle stays 1 m ahead of the robot's current pose."""
    sim = simulation((5.0, 10.0, 0.0), robot_radius=0.3)
    sim.add_obstacle(mrs.Shape.disc(0.2), lambda time: (sim.pose.x + 1.0, 10.0, 0.0))
    drive(sim, 0.5)
    sim.run_for(4.0)
    assert sim.pose.x == pytest.approx(7.0) and sim.truth.contacts == []
    assert ranges(sim).min() == pytest.approx(0.8, abs=0.01)
