"""requirement_assertions: they say where, when and by how much a drive violated a requirement."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.requirements import always, clearance, eventually, goal_distance, speed
from mobile_robot_simulator.testing import assert_always, assert_holds
from simulations import drive, simulation


def test_a_drive_that_keeps_the_requirement_passes():
    sim = simulation()
    drive(sim, 1.0)
    sim.run_for(2.0)
    assert_always(sim, (clearance > 1.4) & (speed < 1.5))
    assert_holds(sim, eventually(clearance > 1.4, within=(0.0, 1.0)))


def test_the_worst_and_the_first_violation_are_named():
    sim = simulation(start=(15.9, 10.0, 0.0))
    drive(sim, 1.0)
    sim.run_for(3.0)
    drive(sim, -1.0)
    sim.run_for(1.0)
    with pytest.raises(AssertionError) as caught:
        assert_always(sim, clearance > 1.45, period=0.5)
    assert str(caught.value) == (
        "the robot violated always(clearance > 1.45 m), at worst by 0.45\n"
        "  worst: at (18.900, 10.000) at 3.000 s\n"
        "  violated at 1 of 9 samples, first at 3.000 s"
    )


def test_a_drive_that_violates_the_requirement_from_its_start():
    sim = simulation()
    sim.goal = (5.0, 2.0)
    drive(sim, 1.0)
    sim.run_for(2.0)
    with pytest.raises(AssertionError) as caught:
        assert_holds(sim, eventually(goal_distance < 0.5))
    assert str(caught.value) == (
        "the robot violated eventually(goal_distance < 0.5 m) by 0.5\n  end: at (4.000, 2.000) at 2.000 s"
    )


def test_a_picture_is_saved(tmp_path):
    sim = simulation()
    sim.picture = tmp_path / "made" / "drive.png"
    for check in (assert_always, assert_holds):
        with pytest.raises(AssertionError, match=r"picture: .*drive\.png"):
            check(sim, always(speed > 1.0))
    assert sim.picture.read_bytes().startswith(b"\x89PNG")


def test_what_is_no_requirement_is_refused():
    for check in (assert_always, assert_holds):
        with pytest.raises(TypeError, match=r"a requirement such as clearance > 0\.2 is needed, got clearance"):
            check(simulation(), clearance)
