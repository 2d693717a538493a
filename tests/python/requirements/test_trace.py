"""Trace: samples of a drive at equal times, up to the present."""

from __future__ import annotations

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.requirements import Trace
from simulations import drive, hall, simulation


def test_samples_are_at_equal_times_and_at_the_present():
    sim = simulation()
    drive(sim, 0.5)
    assert Trace(sim).times.tolist() == [0.0]
    sim.run_for(1.0)
    assert Trace(sim).times == pytest.approx(np.arange(11) * 0.1)
    assert Trace(sim, period=0.3).times == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.0])
    trace = Trace(sim, period=0.25)
    assert trace.poses == pytest.approx(np.array([[2.0 + 0.5 * time, 2.0, 0.0] for time in (0, 0.25, 0.5, 0.75, 1.0)]))
    assert trace.velocities.tolist() == [[0.5, 0.0, 0.0]] * 5


def test_a_robot_that_joins_later_has_a_later_start():
    sim = mrs.Simulation(hall(), robots={"a": (2.0, 2.0, 0.0)})
    sim.run_for(1.0)
    sim.add_robot("b", start=(5.0, 5.0, 0.0))
    sim.run_for(0.5)
    assert Trace(sim, robot="b", period=0.25).times.tolist() == [1.0, 1.25, 1.5]


def test_a_contact_has_clearance_0_though_the_robot_stops_before_the_wall():
    sim = simulation(robot_radius=0.25)
    drive(sim, -1.0)
    sim.run_for(2.0)
    trace = Trace(sim)
    touched = sim.truth.contacts[0].time
    assert touched == pytest.approx(1.65, abs=1e-5)
    assert trace.clearances[trace.times < touched].min() > 0.04
    assert trace.clearances[trace.times >= touched].tolist() == [0.0] * 4


def test_a_contact_between_two_samples_is_seen():
    sim = simulation(robot_radius=0.25)
    drive(sim, -1.0)
    sim.run_for(1.66)
    drive(sim, 1.0)
    sim.run_for(1.0)
    trace = Trace(sim, period=1.0)
    assert trace.truth.clearances(np.column_stack((trace.times, trace.poses))).min() > 0.3
    assert trace.clearances[trace.times == 2.0] == 0.0


@pytest.mark.parametrize("period", [0.0, -1.0, np.inf, np.nan])
def test_the_period_is_checked(period):
    with pytest.raises(ValueError, match="period must be positive and finite, got"):
        Trace(simulation(), period=period)


def test_too_many_samples_are_refused():
    sim = simulation()
    sim.run_for(1.0)
    with pytest.raises(ValueError, match="at most 1000000 samples, got 1 s in steps of 1e-07 s"):
        Trace(sim, period=1e-7)
