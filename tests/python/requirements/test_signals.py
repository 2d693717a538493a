"""signals: values of drives that can be checked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.requirements import (
    Trace,
    acceleration,
    clearance,
    distance_to,
    goal_distance,
    inside,
    jerk,
    speed,
    time_to_contact,
    turn_rate,
)
from simulations import drive, simulation


def test_positions():
    sim = simulation()
    drive(sim, 1.0)
    sim.run_for(2.0)
    trace = Trace(sim, period=1.0)
    sim.goal = (4.0, 5.0)
    assert distance_to(2.0, 1.0).measure(trace) == pytest.approx([1.0, math.sqrt(2.0), math.sqrt(5.0)])
    assert goal_distance.measure(Trace(sim, period=1.0)) == pytest.approx([math.sqrt(13.0), math.sqrt(10.0), 3.0])
    assert inside(0.0, 0.0, 3.5, 3.0).measure(trace) == pytest.approx([1.0, 0.5, -0.5])
    with pytest.raises(ValueError, match="needs a goal"):
        goal_distance.measure(trace)


def test_velocities_and_their_changes():
    sim = simulation(acceleration_limits=(1.0, 1.0, 2.0))
    drive(sim, 2.0, 1.0)
    sim.run_for(1.0)
    trace = Trace(sim)
    assert speed.measure(trace) == pytest.approx(np.arange(11) * 0.1)
    assert turn_rate.measure(trace) == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, *[1.0] * 6])
    assert acceleration.measure(trace) == pytest.approx([0.0, *[1.0] * 10])
    assert jerk.measure(trace) == pytest.approx([0.0, 10.0, *[0.0] * 9], abs=1e-6)


def test_the_velocity_after_a_jump_counts():
    sim = simulation()
    drive(sim, 0.5)
    sim.run_for(0.5)
    drive(sim, -0.25)
    sim.run_for(0.3)
    assert speed.measure(Trace(sim)).tolist() == [*[0.5] * 5, *[0.25] * 4]
    sim.add_fault(mrs.faults.Slip(0.5, start=0.8))
    sim.run_for(0.2)
    assert speed.measure(Trace(sim))[-2:].tolist() == [0.125, 0.125]


def test_clearance_and_time_to_contact():
    """The wall is at 19.9 m, and the robot has a radius of 0.4 m."""
    sim = simulation(start=(17.7, 10.0, 0.0), robot_radius=0.4)
    drive(sim, 0.5)
    sim.run_for(2.0)
    drive(sim, 0.0)
    sim.run_for(1.0)
    trace = Trace(sim, period=1.0)
    assert clearance.measure(trace) == pytest.approx([1.5, 1.3, 0.8, 0.8])
    assert time_to_contact.measure(trace) == pytest.approx([3.6, 2.6, 10.0, 10.0], abs=1e-5)
    assert sim.truth.times_to_contact([0.0], horizon=3.5) == [3.5]
    with pytest.raises(ValueError, match="horizon must be positive and finite, got 0"):
        sim.truth.times_to_contact([0.0], horizon=0)


def test_time_to_contact_with_a_moving_obstacle_takes_it_where_it_is():
    sim = simulation(start=(5.0, 10.0, 0.0), robot_radius=0.5)
    sim.add_obstacle(mrs.Shape.disc(0.5), [(0.0, 12.0, 10.0, 0.0), (1.0, 8.0, 10.0, 0.0)])
    drive(sim, 1.0)
    sim.run_for(1.0)
    assert time_to_contact.measure(Trace(sim, period=1.0)) == pytest.approx([6.0, 1.0], abs=1e-5)


def test_limits_are_checked():
    for condition in (lambda: clearance > 1.5, lambda: clearance < 4.0):
        with pytest.raises(ValueError, match=r"clearance is measured up to 1\.5 m, so its limit must be less, got"):
            condition()
    with pytest.raises(ValueError, match="time_to_contact is measured up to 10 s"):
        time_to_contact > 10.0  # noqa: B015
    with pytest.raises(ValueError, match="limit of speed must be finite, got inf"):
        speed < math.inf  # noqa: B015
    with pytest.raises(TypeError, match="limit must be a number"):
        speed < "1"  # noqa: B015
    with pytest.raises(TypeError, match=r"signal speed has no truth value; compare it with a limit: speed > 0\.2"):
        bool(speed)
    with pytest.raises(ValueError, match="rectangle must not be empty"):
        inside(1.0, 0.0, 1.0, 2.0)
    with pytest.raises(ValueError, match="x must be finite, got nan"):
        distance_to(math.nan, 0.0)
