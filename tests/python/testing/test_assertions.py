"""Assertions pass when they should, and say where, when and by how much when they do not."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.testing.assertions import (
    assert_clearance,
    assert_no_contact,
    assert_rate,
    assert_reaches,
    assert_scan_close,
)


def simulation(**parameters) -> mrs.Simulation:
    cells = np.zeros((100, 100), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    quiet = {"velocity_timeout": 0, "laser_beam_count": 11, "apply_noise": False, "robot_radius": 0.3}
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    return mrs.Simulation(grid, parameters={**quiet, **parameters}, start=(2, 2, 0))


def drive(sim: mrs.Simulation, vx: float, wz: float = 0.0) -> None:
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx), angular=mrs.messages.Vector3(z=wz)))


def message(call, *args, **kwargs) -> str:
    with pytest.raises(AssertionError) as raised:
        call(*args, **kwargs)
    return str(raised.value)


def test_a_goal_reached():
    sim = simulation()
    drive(sim, 0.5)
    assert assert_reaches(sim, (4.0, 2.0), 10.0, tolerance=0.1) == pytest.approx(3.85, abs=0.06)
    assert_reaches(sim, (5.0, 2.0, 2 * math.pi), 10.0)


def test_a_goal_missed_says_how_near_it_was_and_when():
    sim = simulation()
    drive(sim, 0.5)
    assert message(assert_reaches, sim, (4.0, 3.0), 6.0) == (
        "the robot did not come within 0.3 m of (4, 3) in 6 s: it came within 1.000 m, at (4.000, 2.000) at 4.000 s; "
        "at the end it is 1.414 m away, at (5.000, 2.000) at 6.000 s"
    )
    assert "yaw 1 was wanted to 0.2 rad" in message(assert_reaches, sim, (5.0, 2.0, 1.0), 1.0)


def test_only_the_way_from_now_on_counts_for_a_goal():
    sim = simulation()
    drive(sim, 0.5)
    sim.run_for(4.0)
    assert "came within 1.000 m, at (4.000, 2.000) at 4.000 s" in message(assert_reaches, sim, (3.0, 2.0), 1.0)


def test_contact():
    sim = simulation()
    drive(sim, 0.5)
    sim.run_for(1.0)
    assert_no_contact(sim)
    drive(sim, -1.0)
    sim.run_for(5.0)
    assert message(assert_no_contact, sim) == (
        "the robot touched a wall at (0.100, 2.000) at 3.100 s, going 1.000 m/s, with its centre at (0.400, 2.000)"
    )
    with pytest.raises(ValueError, match="give the parameter robot_radius or footprint"):
        assert_no_contact(simulation(robot_radius=0))


def test_clearance():
    sim = simulation()
    drive(sim, -0.5)
    sim.run_for(2.0)
    drive(sim, 0.5)
    sim.run_for(2.0)
    assert_clearance(sim, 0.59)
    text = message(assert_clearance, sim, 0.7)
    assert "came within 0.600 m of something, at (1.000, 2.000) at 2.000 s: 0.100 m less than the 0.7 m wanted" in text
    assert "too near at 3 of 42 points" in text


def test_clearance_counts_what_moved_where_it_was_then():
    sim = simulation()
    sim.add_obstacle(mrs.Shape.disc(0.2), [(0.0, 2.0, 5.0, 0.0), (2.0, 2.0, 2.6, 0.0), (4.0, 2.0, 5.0, 0.0)])
    sim.run_for(4.0)
    assert "came within 0.100 m of something, at (2.000, 2.000) at 2.000 s" in message(assert_clearance, sim, 0.3)


def test_rates():
    sim = simulation()
    assert_rate(sim, "/scan", 10.0)
    assert_rate(sim, "odom", 10.0, over=0.55)
    assert message(assert_rate, sim, "/odom", 20.0, over=1.0).startswith(
        "/odom had 10 messages in 1 s from 2.55 s on, 10 Hz"
    )
    sim = simulation()
    sim.add_fault(faults.Blackout(start=1.05, end=1.35))
    assert "the longest gap was 0.400 s, from 1.000 s on" in message(assert_rate, sim, "/scan", 10.0, tolerance=0.3)
    with pytest.raises(ValueError, match="unknown topic"):
        assert_rate(sim, "/scam", 1.0)
    with pytest.raises(ValueError, match="give over"):
        assert_rate(sim, "/scan", 0.5)


def test_scans():
    sim = simulation()
    sim.run_for(0.1)
    scan = sim.latest("/scan")
    assert_scan_close(scan, scan)
    other = scan.ranges.copy()
    other[3] += 0.25
    other[7] = math.inf
    text = message(assert_scan_close, scan, other, tolerance=0.1)
    assert text.startswith("2 of 11 beams differ by more than 0.1 m; the worst is beam 7 at 0.942 rad, 0.100 s: ")
    other[7] = scan.ranges[7]
    assert "beam 3 at -0.942 rad" in message(assert_scan_close, scan, other, tolerance=0.1)
    assert_scan_close(scan, other, tolerance=0.1, share=0.9)
    assert_scan_close(scan, other, tolerance=0.26)
    with pytest.raises(ValueError, match="as many as each other"):
        assert_scan_close(scan, other[:5])


def test_a_failure_points_at_its_picture(tmp_path):
    sim = simulation()
    sim.picture = tmp_path / "drive.png"
    drive(sim, 0.5)
    assert message(assert_reaches, sim, (4.0, 3.0), 1.0).endswith(f"\npicture: {tmp_path / 'drive.png'}")
    assert sim.picture.read_bytes().startswith(b"\x89PNG")


def test_bad_arguments_are_refused():
    sim = simulation()
    with pytest.raises(ValueError, match="goal must be two or three finite numbers"):
        assert_reaches(sim, (1.0,), 1.0)
    with pytest.raises(ValueError, match="clearance must be positive"):
        assert_clearance(sim, 0.0)
    with pytest.raises(ValueError, match="unknown robot 'x'"):
        assert_no_contact(sim, robot="x")


@pytest.mark.parametrize("tolerance", [math.nan, -0.1, math.inf])
def test_tolerances_that_would_pass_or_fail_anything_are_refused(tolerance):
    sim, ones = simulation(), np.ones(3, np.float32)
    for call in (
        lambda: assert_reaches(sim, (2.0, 2.0), 1.0, tolerance=tolerance),
        lambda: assert_reaches(sim, (2.0, 2.0, 0.0), 1.0, yaw_tolerance=tolerance),
        lambda: assert_rate(sim, "/odom", 10.0, tolerance=tolerance),
        lambda: assert_scan_close(ones, 2 * ones, tolerance=tolerance),
    ):
        with pytest.raises(ValueError, match="tolerance must be finite and at least 0"):
            call()


@pytest.mark.parametrize("share", [0.0, -1.0, 1.1, math.nan])
def test_shares_of_beams_that_are_none_are_refused(share):
    with pytest.raises(ValueError, match="share must be above 0 and at most 1"):
        assert_scan_close(np.ones(3, np.float32), np.zeros(3, np.float32), share=share)


def test_scans_without_beams_are_refused():
    with pytest.raises(ValueError, match="must have beams"):
        assert_scan_close(np.zeros(0, np.float32), np.zeros(0, np.float32))


def test_all_robots_are_looked_at_and_named():
    grid = simulation().grid
    sim = mrs.Simulation(grid, robots={"one": (2, 2, 0), "two": (2, 5, 0)}, parameters={"velocity_timeout": 0})
    sim.publish("/two/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=-1.0)))
    sim.run_for(3.0)
    assert message(assert_no_contact, sim).startswith("two touched a wall at (0.100, 5.000)")
    assert message(assert_clearance, sim, 0.5).startswith("two came within 0.000 m of something")
    assert_no_contact(sim, robot="one")
    assert_clearance(sim, 0.5, robot="one")
    assert message(assert_reaches, sim, (9.0, 9.0), 0.1, robot="two").startswith("two did not come within")


def test_contacts_before_the_run_are_not_on_its_way():
    sim = simulation()
    drive(sim, -1.0)
    sim.run_for(3.0)
    drive(sim, 0.2)
    assert "on its way" not in message(assert_reaches, sim, (9.0, 9.0), 1.0)
    drive(sim, -1.0)
    assert "on its way it touched a wall" in message(assert_reaches, sim, (9.0, 9.0), 3.0)


def test_a_rate_leaves_nothing_behind_and_counts_from_now_on():
    sim = simulation()
    sim.run_for(1.0)
    before = len(sim._bus.taps)
    assert_rate(sim, "/scan", 10.0, over=1.0, tolerance=0.0)
    assert message(assert_rate, sim, "/map", 1.0, over=3.0).startswith("/map had 0 messages")
    assert len(sim._bus.taps) == before


def test_a_range_that_is_none_is_far_from_one_that_is():
    ones = np.ones(3, np.float32)
    for none in (math.nan, math.inf):
        other = np.array([1.0, none, 1.0], np.float32)
        assert "the worst is beam 1" in message(assert_scan_close, ones, other)
        assert_scan_close(other, other)
