"""Fails on purpose, to show the report of a failure."""

import pytest
from followers.pure_pursuit import PurePursuit

from mobile_robot_simulator.testing.assertions import assert_reaches


@pytest.mark.simulator(
    map="office", size=(12.0, 9.0), seed=4, parameters={"publish_map_transform": False, "robot_radius": 0.2}
)
def test_a_straight_line_leads_through_walls(robot_world):
    x, y, _ = robot_world.pose
    goal = (2.1, 6.5)
    robot_world.spawn(PurePursuit, parameters={"path": [x, y, *goal]})
    assert_reaches(robot_world, goal, within=30.0)
