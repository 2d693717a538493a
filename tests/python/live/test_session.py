"""Session: the inputs of viewers."""

from __future__ import annotations

import numpy as np
import pytest
from sessions import do, robot, session_of, turns

import mobile_robot_simulator as mrs
from mobile_robot_simulator.recording import Recorder
from simulations import SEED, hall


@pytest.fixture
def session(tmp_path):
    return session_of(robot(), tmp_path)


def test_time_runs_stops_and_steps(session):
    wall = turns(session, 1.0)
    assert session.simulation.time == pytest.approx(0.98, abs=2e-3)
    do(session, "pause", paused=True)
    wall = turns(session, 1.0, wall)
    assert session.simulation.time == pytest.approx(0.98, abs=2e-3)
    do(session, "step", seconds=0.1)
    assert session.simulation.time == pytest.approx(1.08, abs=2e-3) and session.pace.paused
    do(session, "pause", paused=False)
    do(session, "speed", factor=10.0)
    turns(session, 1.0, wall)
    assert session.simulation.time == pytest.approx(11.08, abs=0.3)


def test_a_simulation_has_no_time_line(session):
    with pytest.raises(ValueError, match="a simulation has no time line"):
        do(session, "seek", time=1.0)
    assert session.simulation.time == 0.0


def test_the_start_speed_is_the_parameter_speed_factor():
    assert session_of(robot(speed_factor=2.5)).pace.speed == 2.5


def test_a_pose_is_set_or_refused(session):
    do(session, "set_pose", robot="", x=5.0, y=6.0, yaw=1.0)
    assert tuple(session.simulation.pose) == (5.0, 6.0, 1.0)
    with pytest.raises(ValueError, match="wall"):
        do(session, "set_pose", robot="", x=0.05, y=6.0, yaw=1.0)
    with pytest.raises(ValueError, match=r"\(-5.00, 6.00\) is off the map"):
        do(session, "set_pose", robot="", x=-5.0, y=6.0, yaw=1.0)
    with pytest.raises(ValueError, match="unknown robot 'b'"):
        do(session, "set_pose", robot="b", x=5.0, y=6.0, yaw=1.0)
    assert tuple(session.simulation.pose) == (5.0, 6.0, 1.0)


def test_an_obstacle_is_seen_moved_and_removed(session):
    name = do(session, "add_obstacle", x=5.0, y=3.0, radius=0.5)
    wall = turns(session, 0.2)
    middle = 30
    assert session.simulation.latest("/scan").ranges[middle] == pytest.approx(1.5, abs=0.05)
    do(session, "move_obstacle", name=name, x=6.0, y=3.0, yaw=0.0)
    turns(session, 0.2, wall)
    assert session.simulation.latest("/scan").ranges[middle] == pytest.approx(2.5, abs=0.05)
    do(session, "remove_obstacle", name=name)
    assert not session.simulation.obstacles
    with pytest.raises(ValueError, match="either a radius, or a length and a width"):
        do(session, "add_obstacle", x=5.0, y=3.0)
    with pytest.raises(ValueError, match="obstacle"):
        do(session, "remove_obstacle", name="7")


def test_a_parameter_is_set_or_refused(session):
    do(session, "set_parameter", robot="", scanner="", name="laser_frequency", value="5")
    assert session.simulation.laser.parameters.laser_frequency == 5.0
    for values, message in [
        ({"scanner": "", "name": "laser_frequency", "value": "-3"}, "laser_frequency must be greater than 0, got -3"),
        ({"name": "laser_frequency", "value": "3"}, "unknown parameter 'laser_frequency'"),
        ({"scanner": "front", "name": "laser_frequency", "value": "3"}, "unknown scanner 'front'"),
        ({"name": "velocity_timeout", "value": "[1"}, "must be YAML"),
        ({"name": "velocity_timeout", "value": "true"}, "velocity_timeout must be a number, got True"),
    ]:
        with pytest.raises(ValueError, match=message):
            do(session, "set_parameter", robot="", **values)
    assert session.simulation.laser.parameters.laser_frequency == 5.0


def test_a_seed_is_that_of_a_simulation_with_it():
    starts = {"robot1": (5.0, 10.0, 0.0), "robot2": (9.0, 10.0, 0.0)}
    sims = [mrs.Simulation(hall(), seed=seed, robots=starts, parameters={"scanners": ["a", "b"]}) for seed in (SEED, 5)]
    do(session_of(sims[0]), "seed", seed=5)
    seeds = [
        [(each.robot.parameters.odometry_seed, *(laser.parameters.seed for laser in each.scanners.values()))]
        for sim in sims
        for each in sim.robots.values()
    ]
    assert seeds[:2] == seeds[2:] and seeds[0] != seeds[1]


def test_a_fault_acts_until_it_is_stopped(session):
    do(session, "add_fault", text="Blackout('/scan')")
    wall = turns(session, 1.0)
    assert session.simulation.latest("/scan") is None
    do(session, "stop_fault", number=0)
    turns(session, 1.0, wall)
    assert session.simulation.latest("/scan") is not None
    with pytest.raises(ValueError, match="no fault 4, only 1"):
        do(session, "stop_fault", number=4)
    with pytest.raises(ValueError, match="did you mean 'Drop'"):
        do(session, "add_fault", text="Dropp('/scan')")


def test_a_state_comes_back_and_commands_after_it_are_forgotten(session):
    do(session, "drive", robot="", vx=0.5)
    wall = turns(session, 0.4)
    do(session, "save_state", name="here")
    before, commands = tuple(session.simulation.pose), do(session, "copy_commands", robot="")
    do(session, "drive", robot="", vx=0.7)
    wall = turns(session, 0.4, wall)
    assert do(session, "copy_commands", robot="") != commands
    do(session, "restore_state", name="here")
    assert tuple(session.simulation.pose) == before and do(session, "copy_commands", robot="") == commands
    assert session.states == {"here": session.simulation.time}
    with pytest.raises(ValueError, match="there is no state 'there'"):
        do(session, "restore_state", name="there")


def test_at_most_twenty_states_are_kept(session):
    for number in range(20):
        do(session, "save_state", name=f"state {number}")
    do(session, "save_state", name="state 3")
    with pytest.raises(ValueError, match="at most 20 states"):
        do(session, "save_state", name="one more")


def test_a_recording_begins_and_ends_where_viewers_say(session, tmp_path):
    from rosbags.rosbag2 import Reader

    wall = turns(session, 1.0)
    assert session.free_name == "drive-1"
    do(session, "record", name="drive-1")
    with pytest.raises(ValueError, match="a recording is being made"):
        do(session, "record", name="other")
    wall = turns(session, 1.0, wall)
    path = do(session, "record", name=None)
    turns(session, 1.0, wall)
    with Reader(path) as reader:
        scans = [time for each, time, _ in reader.messages() if each.topic == "/scan"]
        assert len(scans) == 20 and 0.97e9 < min(scans) <= max(scans) < 2e9
        assert {"/scan", "/odom", "/tf", "/map"} <= {each.topic for each in reader.connections}
    assert session.free_name == "drive-2" and do(session, "record", name=None) is None
    with pytest.raises(FileExistsError):
        do(session, "record", name="drive-1")


def test_a_disk_error_ends_the_recording_and_the_viewers_are_told(session, monkeypatch):
    do(session, "record", name="drive-1")

    def fail(self, topic, message, time_ns):
        raise OSError("the disk is full")

    monkeypatch.setattr(Recorder, "write", fail)
    turns(session, 1.0)
    assert session.recording is None and session.notes == ["the recording has ended: the disk is full"]
    assert session.simulation.time > 0.9


def test_reset_brings_robots_back_and_starts_paths_anew(session):
    do(session, "drive", robot="", vx=0.5)
    turns(session, 0.4)
    do(session, "reset")
    assert tuple(session.simulation.pose) == (3.0, 3.0, 0.0) and session.epoch == 1
    assert np.allclose(session.simulation.truth.velocity, 0.0)


def test_the_wandering_driver_is_switched_on_and_off(session):
    do(session, "autopilot", robot="", driver="wander")
    wall = turns(session, 3.0)
    distance = session.simulation.truth.distance
    do(session, "autopilot", robot="")
    turns(session, 1.0, wall)
    assert distance > 0.5 and session.simulation.truth.distance == pytest.approx(distance)


def test_a_goal_that_cannot_be_reached_is_refused(session):
    do(session, "add_obstacle", x=15.0, y=15.0, length=2.0, width=2.0)
    with pytest.raises(ValueError, match="no way to the goal"):
        do(session, "set_goal", robot="", x=15.0, y=15.0, yaw=0.0)
    assert not session.pilots.autopilots
