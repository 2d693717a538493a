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


def test_a_moved_obstacle_is_seen_and_touched_where_it_is():
    sim = simulation(start=(10.0, 10.0, 0.0), robot_radius=0.3)
    box = sim.add_obstacle(mrs.Shape.rectangle(0.4, 2.0), (14.0, 10.0, 0.0), "box")
    sim.run_for(0.1)
    assert ranges(sim)[30:32].min() == pytest.approx(3.8, abs=0.02)
    sim.move_obstacle("box", (12.0, 10.0, 0.0))
    sim.run_for(0.1)
    assert ranges(sim)[30:32].min() == pytest.approx(1.8, abs=0.02)
    drive(sim, 0.5)
    sim.run_for(5.0)
    assert sim.pose.x == pytest.approx(11.5, abs=1e-5)
    assert [contact.what for contact in sim.truth.contacts] == ["obstacle box"]
    assert [box.pose(time_ns).x for time_ns in (0, 99_999_999, 100_000_000)] == [14.0, 14.0, 12.0]


def test_an_obstacle_drives_with_a_velocity_in_its_own_frame():
    sim = simulation(start=(10.0, 10.0, 0.0))
    cart = sim.add_obstacle(mrs.Shape.disc(0.3), (4.0, 4.0, math.pi / 2))
    sim.run_for(1.0)
    sim.move_obstacle(cart, velocity=(0.5, 0.0, 0.2))
    sim.run_for(2.0)
    sim.move_obstacle(cart, velocity=(0.0, 0.0, 0.0))
    sim.run_for(1.0)
    assert tuple(cart.pose(500_000_000)) == (4.0, 4.0, math.pi / 2)
    arc = mrs.Pose(4.0, 4.0, math.pi / 2).integrate((0.5, 0.0, 0.2), 2.0)
    assert tuple(cart.pose(4_000_000_000)) == pytest.approx(tuple(arc), abs=1e-12)
    half = mrs.Pose(4.0, 4.0, math.pi / 2).integrate((0.5, 0.0, 0.2), 1.0)
    assert tuple(cart.pose(2_000_000_000)) == pytest.approx(tuple(half), abs=1e-12)


@pytest.mark.parametrize("by_name", [False, True])
def test_a_removed_obstacle_is_neither_seen_nor_touched(by_name: bool):
    sim = simulation(start=(10.0, 10.0, 0.0), robot_radius=0.3)
    first = sim.add_obstacle(mrs.Shape.disc(0.3), (12.0, 10.0, 0.0))
    second = sim.add_obstacle(mrs.Shape.disc(0.3), (5.0, 5.0, 0.0))
    sim.remove_obstacle("1" if by_name else first)
    assert sim.obstacles == (second,)
    drive(sim, 0.5)
    sim.run_for(6.0)
    assert sim.pose.x == pytest.approx(13.0) and not sim.truth.contacts
    assert sim.add_obstacle(mrs.Shape.disc(0.1), (1.0, 1.0, 0.0)).name == "3"
    with pytest.raises(ValueError, match=r"unknown obstacle '1'; there are '2', '3'"):
        sim.remove_obstacle("1")
    with pytest.raises(ValueError, match="the obstacle must be in the world, got Obstacle"):
        sim.remove_obstacle(first)


def test_what_follows_a_trajectory_cannot_be_moved_and_numbers_are_checked():
    sim = simulation(start=(10.0, 10.0, 0.0))
    sim.add_obstacle(mrs.Shape.disc(0.3), [(0.0, 12.0, 10.0, 0.0), (1.0, 13.0, 10.0, 0.0)], "train")
    sim.add_obstacle(mrs.Shape.disc(0.3), (5.0, 5.0, 0.0), "box")
    with pytest.raises(ValueError, match="obstacle train must have one pose as its trajectory to be moved"):
        sim.move_obstacle("train", (0.0, 0.0, 0.0))
    for bad in ((math.nan, 0.0, 0.0), (1e300, 0.0, 0.0), (1.0, 2.0)):
        with pytest.raises(ValueError, match=r"the velocity must be three numbers \(vx, vy, wz\) of at most 1000, got"):
            sim.move_obstacle("box", velocity=bad)
    with pytest.raises(ValueError, match="finite"):
        sim.move_obstacle("box", (math.nan, 0.0, 0.0))
    assert tuple(sim.obstacles[1].pose(0)) == (5.0, 5.0, 0.0)


def test_moved_and_removed_obstacles_are_part_of_a_snapshot():
    sim = simulation(start=(10.0, 10.0, 0.0))
    box = sim.add_obstacle(mrs.Shape.disc(0.3), (12.0, 10.0, 0.0), "box")
    whole = sim.save()
    sim.move_obstacle(box, velocity=(0.5, 0.0, 0.0))
    sim.run_for(1.0)
    moving = sim.save()
    sim.run_for(1.0)
    scan = ranges(sim)
    sim.restore(moving)
    sim.move_obstacle(box, velocity=(0.0, 2.0, 0.0))
    sim.run_for(1.0)
    sim.remove_obstacle(box)
    sim.restore(moving)
    sim.run_for(1.0)
    assert box.pose(2_000_000_000).x == pytest.approx(13.0) and np.array_equal(ranges(sim), scan)
    sim.restore(whole)
    sim.run_for(1.0)
    assert box.pose(1_000_000_000).x == 12.0


def test_changed_cells_are_seen_touched_and_published():
    sim = simulation(start=(10.0, 10.0, 0.0), robot_radius=0.3)
    sim.run_for(0.1)
    before, state = sim.latest("/map"), sim.save()
    received = []
    sim.subscribe("/map", mrs.messages.OccupancyGrid, received.append)
    sim.set_cells(90, 120, np.full((20, 1), 100, np.int8))
    drive(sim, 0.5)
    sim.run_for(5.0)
    assert sim.pose.x == pytest.approx(11.7, abs=1e-5)
    wall = received[-1].data.reshape(sim.grid.shape)[90:110, 120]
    assert (wall == 100).all() and not (before.data == received[-1].data).all()
    with pytest.raises(ValueError, match="must fit on the grid"):
        sim.set_cells(0, 0, np.zeros((1000, 1), np.int8))
    sim.restore(state)
    assert sim.latest("/map") == before
    sim.run_for(0.1)
