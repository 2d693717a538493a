"""Autopilots: the drivers of a live view."""

import math

import pytest
from sessions import robot, session_of, turns

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.script import Script
from mobile_robot_simulator.live.autopilot import GoalPilot, ScriptPilot, WanderPilot, radius_of
from mobile_robot_simulator.live.journal import Journal
from simulations import hall, pair


def test_a_script_sends_each_command_at_its_time():
    session = session_of(robot())
    rows = ((0.5, 0.4, 0.0, 0.0), (1.0125, 0.0, 0.0, 1.0), (2.0, 0.0, 0.0, 0.0))
    session.pilots.engage("", ScriptPilot(session.simulation, Script(rows)))
    turns(session, 3.0)
    # Rounded up to whole milliseconds.
    assert session.simulation.truth.distance == pytest.approx(0.4 * 0.513)
    assert session.simulation.pose.yaw == pytest.approx(2.0 - 1.013)


def test_wander_drives_and_touches_nothing():
    session = session_of(robot(laser_beam_count=181))
    session.pilots.engage("", WanderPilot(session.simulation, "", 1))
    turns(session, 30.0)
    assert session.simulation.truth.distance > 5.0 and not session.simulation.truth.contacts


def test_a_goal_is_reached_around_another_robot():
    sim = pair(velocity_timeout=0.5)
    pilot = GoalPilot(sim, "robot1", mrs.Pose(12.0, 10.0, 0.0))
    journal = Journal()
    session = session_of(sim)
    session.journal = journal
    session.pilots.engage("robot1", pilot)
    turns(session, 30.0)
    assert math.dist(tuple(sim.named("robot1").pose)[:2], (12.0, 10.0)) < 0.06
    assert not sim.named("robot1").truth.contacts and sim.named("robot2").truth.distance == 0.0


def test_the_radius_of_a_footprint_is_that_of_the_circle_around_it():
    simulations = [
        mrs.Simulation(hall(), parameters=parameters, start=(5.0, 5.0, 0.0))
        for parameters in ({"robot_radius": 0.3}, {"footprint": "[[-0.3, -0.2], [0.4, -0.2], [0.4, 0.3], [-0.3, 0.2]]"}, {})
    ]
    assert [radius_of(sim.named(None)) for sim in simulations] == [0.3, pytest.approx(0.5), 0.2]
