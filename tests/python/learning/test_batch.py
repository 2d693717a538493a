"""learning: judging a step of many robots, at poses that are chosen."""

from __future__ import annotations

import numpy as np

import mobile_robot_simulator as mrs
from learning.rooms import task
from mobile_robot_simulator.learning.batch import Batch
from mobile_robot_simulator.learning.task import PARTS, NavigationTask


def test_contact_comes_before_the_goal_and_the_goal_before_the_end_of_the_time():
    """A wall from x = 3 m on; robots of 0.2 m drive at 1 m/s. Goals count within 0.45 m."""
    cells = np.zeros((40, 40), np.int8)
    cells[:, 30:] = 100
    world = mrs.OccupancyGrid(cells, resolution=0.1)
    arguments = task(worlds=world, noise=None, max_velocity=(1.0, 1.0), duration=0.1, time_limit=0.1)
    batch = Batch(NavigationTask(**arguments), 4)
    batch.seed([1, 2, 3, 4], np.ones(4, bool))
    batch.reset(np.ones(4, bool))
    batch.fleet.reset(poses=[(2.75, 2.0, 0.0), (1.0, 2.0, 0.0), (1.0, 2.0, 0.0), (2.0, 2.0, 0.0)])
    batch.goals[:] = [(2.7, 2.0), (1.5, 2.0), (3.0, 2.0), (2.1, 2.5)]
    outcome = batch.step(np.tile([1.0, 0.0], (4, 1)))
    assert outcome.contacts.tolist() == [True, False, False, False]
    assert outcome.reached.tolist() == [False, True, False, False]
    assert outcome.truncated.tolist() == [False, False, True, True]
    parts = dict(zip(PARTS, outcome.parts.tolist(), strict=True))
    assert parts["goal"] == [0.0, 10.0, 0.0, 0.0]
    assert parts["contact"] == [-10.0, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(batch.observations()["goal"][1:3, 0], [0.4, 1.9], rtol=1e-6)
