"""Runner: the drives of points in order; test_falsifier.py and test_estimation.py compare numbers of processes."""

from __future__ import annotations

import pytest

from falsification.crossing import SPACE, Crosser, Halting, requirement
from mobile_robot_simulator.falsification import run_drive
from mobile_robot_simulator.falsification.runner import Runner
from mobile_robot_simulator.falsification.samplers import sampler


@pytest.mark.parametrize("processes", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_drives_come_in_the_order_of_points_and_controllers(processes):
    points = sampler("random", len(SPACE.dimensions), 1).ask()[:6]
    with Runner([Crosser, Halting], SPACE, requirement, processes) as runner:
        found = list(runner.run(points))
        assert runner.drive(SPACE.world(points[0])) == found[0][0]
    expected = [
        tuple(run_drive(SPACE.world(point), controller, requirement) for controller in (Crosser, Halting))
        for point in points
    ]
    assert found == expected
