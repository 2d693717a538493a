"""Drive: how it ends, and what counts as a violation."""

from __future__ import annotations

import dataclasses
import math

import pytest

from mobile_robot_simulator.bus import Node
from mobile_robot_simulator.falsification import run_drive
from mobile_robot_simulator.messages import Twist, Vector3
from mobile_robot_simulator.requirements import always, clearance, eventually, goal_distance, speed
from mobile_robot_simulator.scenarios import World, WorldMap

QUIET = {"apply_noise": False, "laser_beam_count": 11, "robot_radius": 0.25}
WORLD = World(WorldMap("room", size=(6.0, 4.0)), (1.0, 2.0, 0.0), parameters=QUIET, duration=3.0)
TO_GOAL = dataclasses.replace(WORLD, goal=(2.0, 2.0), tolerance=0.2)


def ahead(sim):
    return lambda seen: (0.5, 0.0)


def fast(sim):
    return lambda seen: (5.0, 0.0)


def test_a_drive_ends_when_its_time_is_over():
    drive = run_drive(WORLD, ahead, always(clearance > 1.0))
    assert (drive.time, drive.ending, drive.failed) == (3.0, "time", True)
    # At its start, the left side of the robot is 0.7 m from the wall behind it; at its end, 2.45 m along, it is farther.
    assert drive.robustness == pytest.approx(min(0.7, 5.95 - 2.45 - 0.25) - 1.0)


def test_a_drive_ends_at_a_contact():
    drive = run_drive(WORLD, fast, always(clearance > 0.0))
    assert (drive.robustness, drive.ending) == (0.0, "contact") and drive.failed
    assert drive.time == pytest.approx(1.1)


def test_a_drive_ends_on_arrival():
    drive = run_drive(TO_GOAL, ahead, eventually(goal_distance < 0.25))
    assert drive.ending == "arrived" and drive.time == pytest.approx(1.7)
    assert drive.robustness == pytest.approx(0.05)


@pytest.mark.parametrize("command", [(math.nan, 0.0), (0.1, math.inf), (1.0,), None, "ab"])
def test_a_wrong_command_is_a_violation(command):
    drive = run_drive(WORLD, lambda sim: lambda seen: command, always(speed < 9.0))
    assert (drive.robustness, drive.ending, drive.time) == (-math.inf, "error", pytest.approx(0.1))
    assert drive.error.startswith("ValueError: the drive: a command must be")


def test_an_error_of_the_controller_is_a_violation():
    def fails(sim):
        raise KeyError("late")

    assert run_drive(WORLD, fails, always(speed < 9.0)).error == "KeyError: 'late'"
    assert run_drive(WORLD, lambda sim: lambda seen: 1 / 0, always(speed < 9.0)).error.startswith("ZeroDivisionError")


@pytest.mark.parametrize("control", [(0.5, 0.0), "ab", 0])
def test_a_controller_that_is_no_function_is_refused(control):
    with pytest.raises(TypeError, match="a controller must return a function of what it observes, or None, got"):
        run_drive(WORLD, lambda sim: control, always(speed < 9.0))


def test_a_controller_can_be_a_node():
    class Driver(Node):
        def __init__(self):
            super().__init__("driver")
            self.commands = self.create_publisher(Twist, "cmd_vel", 10)
            self.create_timer(0.1, lambda: self.commands.publish(Twist(linear=Vector3(x=0.5))))

    def node(sim):
        sim.spawn(Driver)

    drive = run_drive(TO_GOAL, node, eventually(goal_distance < 0.25))
    assert drive.ending == "arrived" and drive.time == pytest.approx(1.7)


def test_the_controller_waits_for_the_first_scan_and_knows_the_goal():
    seen = []

    def watch(sim):
        return lambda observation: seen.append(observation) or (0.0, 0.0)

    world = dataclasses.replace(TO_GOAL, faults=("Blackout('/scan', end=1.0)",))
    run_drive(world, watch, always(speed < 1.0))
    assert seen[0].time == pytest.approx(1.0, abs=0.11) and seen[0].goal == pytest.approx((1.0, 0.0))
    seen.clear()
    run_drive(WORLD, watch, always(speed < 1.0))
    assert all(math.isnan(number) for number in seen[0].goal)


def test_a_world_that_cannot_be_simulated_is_no_violation():
    with pytest.raises(ValueError, match="must not be inside a wall"):
        run_drive(dataclasses.replace(WORLD, start=(0.0, 0.0, 0.0)), ahead, always(speed < 1.0))
    with pytest.raises(ValueError, match="needs a goal"):
        run_drive(WORLD, ahead, always(goal_distance < 1.0))
