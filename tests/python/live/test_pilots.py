"""Pilots: who drives each robot."""

import time

import pytest
from sessions import TURN, do, robot, session_of, turns

from mobile_robot_simulator.live.autopilot import WanderPilot
from mobile_robot_simulator.live.pilots import HOLD


def test_a_velocity_that_is_not_repeated_ends_after_the_hold():
    session = session_of(robot())
    session.pilots.hold("", (0.5, 0.0, 0.0), 100.0)
    turns(session, 3.0)
    # The first turn only starts the clock; the one in which the hold ends is cut.
    assert 0.5 * (HOLD - 2 * TURN) <= session.simulation.truth.distance <= 0.5 * (HOLD + 2 * TURN)
    assert session.simulation.truth.velocity == (0.0, 0.0, 0.0)


def test_a_velocity_that_is_repeated_goes_on_however_short_the_timeout_of_commands_is():
    session, wall = session_of(robot(velocity_timeout=0.05)), 100.0
    for _ in range(30):
        session.pilots.hold("", (0.5, 0.0, 0.0), wall)
        wall = turns(session, 0.1, wall)
    # The first turn only starts the clock.
    assert session.simulation.truth.distance == pytest.approx(0.5 * (3.0 - TURN), abs=1e-3)


def test_a_velocity_of_zero_stops_at_once():
    session = session_of(robot())
    session.pilots.hold("", (0.5, 0.0, 0.0), 100.0)
    wall = turns(session, 0.2)
    session.pilots.hold("", (0.0, 0.0, 0.0), wall)
    turns(session, 0.2, wall)
    assert session.simulation.truth.distance == pytest.approx(0.5 * (0.2 - TURN), abs=1e-3)


def test_keys_take_a_robot_from_an_autopilot_and_letting_go_does_not():
    session = session_of(robot())
    session.pilots.engage("", WanderPilot(session.simulation, "", 1))
    session.pilots.hold("", (0.0, 0.0, 0.0), 100.0)
    assert list(session.pilots.autopilots) == [""]
    session.pilots.hold("", (0.5, 0.0, 0.0), 100.0)
    assert not session.pilots.autopilots


def test_release_stops_what_viewers_drive_but_no_autopilot():
    session = session_of(robot())
    session.pilots.engage("", WanderPilot(session.simulation, "", 1))
    session.pilots.release()
    wall = turns(session, 3.0)
    assert session.simulation.truth.distance > 0.5
    session.pilots.hold("", (0.5, 0.0, 0.0), wall)
    session.pilots.release()
    turns(session, 0.2, wall)
    assert session.simulation.truth.velocity == (0.0, 0.0, 0.0)


def test_a_robot_that_arrives_stops_and_the_viewers_are_told():
    session = session_of(robot())
    do(session, "set_goal", robot="", x=5.0, y=4.0, yaw=1.0)
    turns(session, 12.0)
    x, y, yaw = session.simulation.pose
    assert (x, y, yaw) == (pytest.approx(5.0, abs=0.06), pytest.approx(4.0, abs=0.06), pytest.approx(1.0, abs=0.06))
    assert session.notes == ["the robot has arrived"] and not session.pilots.autopilots


def test_an_autopilot_that_cannot_go_on_stops_and_says_why():
    session = session_of(robot())
    do(session, "set_goal", robot="", x=15.0, y=3.0, yaw=0.0)
    wall = turns(session, 2.0)
    for x in range(20):  # a wall of boxes from side to side
        do(session, "add_obstacle", x=9.0, y=x + 0.5, length=0.5, width=1.0)
    turns(session, 6.0, wall)
    assert session.notes and "there is no way to the goal (15.00, 3.00)" in session.notes[0]
    assert session.simulation.truth.velocity == (0.0, 0.0, 0.0) and not session.simulation.truth.contacts


def test_the_clock_of_holds_is_the_wall_clock():
    session = session_of(robot())
    do(session, "drive", robot="", vx=0.5)
    session.turn(time.monotonic() + HOLD + 0.1)
    session.turn(time.monotonic() + HOLD + 0.2)
    assert session.simulation.truth.velocity == (0.0, 0.0, 0.0)
