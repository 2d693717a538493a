"""The wall follower keeps its distance, in generated maps and beside moving obstacles."""

import pytest
from followers.wall_follower import WallFollower

from mobile_robot_simulator import Shape, faults
from mobile_robot_simulator.testing.assertions import assert_clearance, assert_no_contact

LASER = {"laser_fov": 4.71, "laser_beam_count": 271, "laser_max_range": 10.0, "robot_radius": 0.25, "velocity_timeout": 1.0}


@pytest.mark.simulator(map="corridor", seed=4, parameters=LASER)
def test_the_robot_drives_along_a_corridor(simulation):
    sim = simulation()
    sim.spawn(WallFollower, parameters={"distance": 0.7})
    sim.run_for(60.0)
    assert_no_contact(sim)
    assert sim.truth.distance > 10.0


@pytest.mark.simulator(map="office", seed=2, parameters=LASER)
def test_the_robot_does_not_hit_a_crossing_obstacle(simulation):
    sim = simulation()
    x, y, _ = sim.pose
    sim.add_obstacle(Shape.disc(0.2), [(5.0, x + 2.0, y + 0.5, 0.0), (15.0, x - 2.0, y + 0.5, 0.0)], name="walker")
    sim.spawn(WallFollower, parameters={"distance": 0.7})
    sim.run_for(4.0)
    assert_clearance(sim, 0.05)


@pytest.mark.simulator(map="corridor", seed=4, parameters=LASER)
def test_the_robot_stops_while_the_scanner_is_silent(simulation):
    sim = simulation()
    sim.spawn(WallFollower)
    sim.add_fault(faults.Blackout(start=5.0, end=10.0))
    sim.run_for(7.0)
    assert sim.truth.velocity == (0.0, 0.0, 0.0)
    sim.run_for(5.0)
    assert sim.truth.velocity != (0.0, 0.0, 0.0)
