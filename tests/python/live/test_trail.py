"""Trail: the path of a robot without small steps, cut where it is moved, thinned if it is long."""

from __future__ import annotations

import math

import mobile_robot_simulator as mrs
from mobile_robot_simulator.live.trail import LONGEST_TRAIL, Trail


def test_a_trail_skips_small_steps_and_is_cut_where_the_robot_is_moved():
    trail = Trail()
    for x in (0.0, 0.001, 0.03):
        trail.add(mrs.Pose(x, 0.0), mrs.Pose(x, 0.0))
    trail.add(mrs.Pose(5.0, 5.0), mrs.Pose(5.0, 5.0), is_moved=True)
    assert trail.points == [(0.0, 0.0, 0.0, 0.0), (0.03, 0.0, 0.03, 0.0), None, (5.0, 5.0, 5.0, 5.0)]


def test_a_long_trail_is_thinned():
    trail = Trail()
    for step in range(LONGEST_TRAIL + 1):
        trail.add(mrs.Pose(0.1 * step, math.sin(step)), mrs.Pose())
    assert trail.epoch == 1 and len(trail.points) == LONGEST_TRAIL * 3 // 4 + 1
    assert trail.points[0][0] == 0.0 and trail.points[-1][0] == 0.1 * LONGEST_TRAIL
