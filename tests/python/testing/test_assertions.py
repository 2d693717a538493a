"""Assertions pass when they should; otherwise their messages say what happened, where, when and by how much."""

from __future__ import annotations

import doctest
import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.testing import assertions
from mobile_robot_simulator.testing.assertions import (
    assert_clearance,
    assert_no_contact,
    assert_rate,
    assert_reaches,
    assert_scan_close,
)
from simulations import drive


def simulation(**parameters) -> mrs.Simulation:
    cells = np.zeros((100, 100), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    quiet = {"velocity_timeout": 0, "laser_beam_count": 11, "apply_noise": False, "robot_radius": 0.3}
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    return mrs.Simulation(grid, parameters={**quiet, **parameters}, start=(2, 2, 0))


def message(call, *args, **kwargs) -> str:
    with pytest.raises(AssertionError) as raised:
        call(*args, **kwargs)
    return str(raised.value)


def test_reaching_a_goal_returns_the_time():
    sim = simulation()
    drive(sim, 0.5)
    assert assert_reaches(sim, (4.0, 2.0), 10.0, tolerance=0.1) == pytest.approx(3.85, abs=0.06)
    assert_reaches(sim, (5.0, 2.0, 2 * math.pi), 10.0)


def test_a_missed_goal_gives_the_nearest_point_and_the_end_of_the_path():
    sim = simulation()
    drive(sim, 0.5)
    assert message(assert_reaches, sim, (4.0, 3.0), 6.0) == (
        "the robot did not come within 0.3 m of (4, 3) in 6 s: it was never nearer than 1.000 m\n"
        "  nearest: 1.000 m away, at (4.000, 2.000) at 4.000 s\n"
        "  end: 1.414 m away, at (5.000, 2.000) at 6.000 s"
    )


def test_a_goal_reached_with_a_wrong_yaw_says_by_how_much_it_was_off():
    sim = simulation()
    drive(sim, 0.5)
    assert message(assert_reaches, sim, (4.0, 2.0, 1.0), 4.0) == (
        "the robot did not come within 0.3 m of (4, 2) with a yaw within 0.2 rad of 1 rad in 4 s: "
        "it was near enough, but its yaw was then always off by 1.000 rad or more\n"
        "  nearest: 0.000 m away, at (4.000, 2.000) at 4.000 s\n"
        "  end: 0.000 m away, at (4.000, 2.000) at 4.000 s"
    )


def test_a_goal_passed_between_two_events_is_a_miss_that_says_so():
    sim = simulation(publish_rate=1.0, laser_frequency=1.0)
    drive(sim, 1.0)
    text = message(assert_reaches, sim, (2.5, 2.0), 2.0, tolerance=0.2)
    assert "it was there only between two events" in text and "nearest: 0.000 m away, at (2.500, 2.000) at 0.500 s" in text


def test_the_path_before_the_call_does_not_count_for_a_goal():
    sim = simulation()
    drive(sim, 0.5)
    sim.run_for(4.0)
    assert "nearest: 1.000 m away, at (4.000, 2.000) at 4.000 s" in message(assert_reaches, sim, (3.0, 2.0), 1.0)


def test_contacts_are_reported():
    sim = simulation()
    drive(sim, 0.5)
    sim.run_for(1.0)
    assert_no_contact(sim)
    drive(sim, -1.0)
    sim.run_for(5.0)
    assert message(assert_no_contact, sim) == (
        "the robot touched a wall at (0.100, 2.000) at 3.100 s: robot at (0.400, 2.000), speed 1.000 m/s"
    )
    with pytest.raises(ValueError, match="give the parameter robot_radius or footprint"):
        assert_no_contact(simulation(robot_radius=0))


def test_clearance_is_checked_along_the_path():
    sim = simulation()
    drive(sim, -0.5)
    sim.run_for(2.0)
    drive(sim, 0.5)
    sim.run_for(2.0)
    assert_clearance(sim, 0.59)
    assert message(assert_clearance, sim, 0.7) == (
        "the robot came within 0.600 m of a wall, obstacle or robot, 0.100 m less than the required 0.7 m\n"
        "  nearest: at (1.000, 2.000) at 2.000 s\n"
        "  too near at 3 of 41 points of its path"
    )


def test_clearance_uses_the_past_poses_of_obstacles():
    sim = simulation()
    sim.add_obstacle(mrs.Shape.disc(0.2), [(0.0, 2.0, 5.0, 0.0), (2.0, 2.0, 2.6, 0.0), (4.0, 2.0, 5.0, 0.0)])
    sim.run_for(4.0)
    text = message(assert_clearance, sim, 0.3)
    assert "came within 0.100 m of a wall, obstacle or robot" in text and "nearest: at (2.000, 2.000) at 2.000 s" in text


def test_rates_and_gaps_are_checked():
    sim = simulation()
    assert_rate(sim, "/scan", 10.0)
    assert_rate(sim, "odom", 10.0, over=0.55)
    assert message(assert_rate, sim, "/odom", 20.0, over=1.0) == (
        "/odom was published at 10 Hz instead of 20 Hz: 10 messages in 1 s, from 2.55 s to 3.55 s\n"
        "  allowed: 20 Hz ± 5 %, gaps of at most 0.1 s\n"
        "  longest gap: 0.100 s, from 2.600 s to 2.700 s"
    )
    sim = simulation()
    sim.add_fault(faults.Blackout(start=1.05, end=1.35))
    assert "longest gap: 0.400 s, from 1.000 s to 1.400 s" in message(assert_rate, sim, "/scan", 10.0, tolerance=0.3)
    with pytest.raises(ValueError, match="unknown topic"):
        assert_rate(sim, "/scam", 1.0)
    with pytest.raises(ValueError, match="give a larger over"):
        assert_rate(sim, "/scan", 0.5)


def test_scans_are_compared_beam_by_beam():
    sim = simulation()
    sim.run_for(0.1)
    scan = sim.latest("/scan")
    assert_scan_close(scan, scan)
    other = scan.ranges.copy()
    other[3] += 0.25
    other[7] = math.inf
    text = message(assert_scan_close, scan, other, tolerance=0.1)
    assert text == (
        "2 of 11 beams differ by more than 0.1 m\n"
        "  largest difference: inf m, at beam 7 (angle 0.942 rad, scan of 0.100 s): "
        f"{scan.ranges[7]:.4f} m in the first scan, inf m in the second"
    )
    other[7] = scan.ranges[7]
    assert "0.2500 m, at beam 3 (angle -0.942 rad" in message(assert_scan_close, scan, other, tolerance=0.1)
    assert_scan_close(scan, other, tolerance=0.1, share=0.9)
    assert_scan_close(scan, other, tolerance=0.26)
    with pytest.raises(ValueError, match="the same number of beams"):
        assert_scan_close(scan, other[:5])


def test_a_failure_names_its_picture(tmp_path):
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
def test_negative_and_infinite_tolerances_are_refused(tolerance):
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
def test_shares_of_beams_out_of_range_are_refused(share):
    with pytest.raises(ValueError, match="share must be above 0 and at most 1"):
        assert_scan_close(np.ones(3, np.float32), np.zeros(3, np.float32), share=share)


def test_scans_without_beams_are_refused():
    with pytest.raises(ValueError, match="the same number of beams, at least one"):
        assert_scan_close(np.zeros(0, np.float32), np.zeros(0, np.float32))


def test_all_robots_are_checked_and_named():
    grid = simulation().grid
    sim = mrs.Simulation(grid, robots={"one": (2, 2, 0), "two": (2, 5, 0)}, parameters={"velocity_timeout": 0})
    sim.publish("/two/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=-1.0)))
    sim.run_for(3.0)
    assert message(assert_no_contact, sim).startswith("robot two touched a wall at (0.100, 5.000)")
    assert message(assert_clearance, sim, 0.5).startswith("robot two came within 0.000 m of a wall")
    assert_no_contact(sim, robot="one")
    assert_clearance(sim, 0.5, robot="one")
    assert message(assert_reaches, sim, (9.0, 9.0), 0.1, robot="two").startswith("robot two did not come within")


def test_contacts_before_the_call_are_not_reported():
    sim = simulation()
    drive(sim, -1.0)
    sim.run_for(3.0)
    drive(sim, 0.2)
    assert "contact" not in message(assert_reaches, sim, (9.0, 9.0), 1.0)
    drive(sim, -1.0)
    assert "first contact: a wall at (0.100, 2.000)" in message(assert_reaches, sim, (9.0, 9.0), 3.0)


def test_measuring_a_rate_leaves_no_tap_and_counts_from_now_on():
    sim = simulation()
    sim.run_for(1.0)
    before = len(sim._bus.taps)
    assert_rate(sim, "/scan", 10.0, over=1.0, tolerance=0.0)
    assert message(assert_rate, sim, "/map", 1.0, over=3.0).startswith(
        "/map was published at 0 Hz instead of 1 Hz: 0 messages in 3 s"
    )
    assert len(sim._bus.taps) == before


def test_a_missing_return_differs_from_a_range():
    ones = np.ones(3, np.float32)
    for none in (math.nan, math.inf):
        other = np.array([1.0, none, 1.0], np.float32)
        assert "inf m, at beam 1: " in message(assert_scan_close, ones, other)
        assert_scan_close(other, other)


def test_the_example_of_the_documentation_runs():
    results = doctest.testmod(assertions)
    assert results.attempted and not results.failed
