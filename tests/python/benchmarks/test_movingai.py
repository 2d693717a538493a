"""movingai: the problems of a small map become tasks, and a controller that knows the path scores by its time."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.benchmarks import Observation, Task, movingai_task, run_tasks
from mobile_robot_simulator.maps import Scenario, load_scenarios

MAP = "type octile\nheight 5\nwidth 8\nmap\n........\n.@@@@@@.\n.@....@.\n.@@@@@@.\n........\n"
PROBLEMS = "version 1\n2\tmaps/ring.map\t8\t5\t0\t0\t7\t0\t7\n0\tmaps/ring.map\t8\t5\t0\t4\t0\t4\t0\n"


@pytest.fixture
def files(tmp_path: Path) -> tuple[mrs.OccupancyGrid, list[Scenario]]:
    """A ring of free cells around walls, of 0.5 m each: along the upper row, and from a cell to itself."""
    (tmp_path / "ring.map").write_text(MAP)
    (tmp_path / "ring.map.scen").write_text(PROBLEMS)
    return mrs.load_map(tmp_path / "ring.map", resolution=0.5), load_scenarios(tmp_path / "ring.map.scen")


def to_the_goal(speed: float) -> Callable[[], Callable[[Observation], tuple[float, float]]]:
    """A controller that turns to the goal and drives there at a speed."""

    def control(observation: Observation) -> tuple[float, float]:
        x, y = observation.goal
        return speed, 2.0 * math.atan2(y, x)

    return lambda: control


def test_a_task_has_the_numbers_of_its_problem(files: tuple[mrs.OccupancyGrid, list[Scenario]]) -> None:
    grid, problems = files
    task = movingai_task(grid, problems[0], speed=0.7)
    assert (task.name, tuple(task.start), task.goal) == ("ring (0, 0) to (7, 0)", (0.25, 2.25, 0.0), (3.75, 2.25))
    assert task.optimal_time == pytest.approx(7 * 0.5 / 0.7) and task.time_limit == pytest.approx(8 * 5.0)
    assert task.tolerance == 0.25 and task.simulation().robot.footprint.radius == 0.2
    # Success weighted by completion time, without an end before the time limit.
    assert [task.score(time) for time in (1.0, 5.0, 10.0, 40.0)] == pytest.approx([1.0, 1.0, 0.5, 0.125])


def test_the_score_is_that_of_the_time(files: tuple[mrs.OccupancyGrid, list[Scenario]]) -> None:
    """3.25 m to the tolerance of 0.25 m, of which the clock counts 3.15 m, at 0.5 m/s of 1 m/s."""
    grid, problems = files
    (trial,) = run_tasks([movingai_task(grid, problems[0])], to_the_goal(0.5)).trials
    assert trial.outcome == "succeeded" and 6.15 <= trial.time <= 6.45
    assert trial.score == pytest.approx(3.5 / trial.time)


def test_walls_end_a_task_and_the_time_is_limited(files: tuple[mrs.OccupancyGrid, list[Scenario]]) -> None:
    grid, problems = files
    down = Scenario(2, "ring.map", (8, 5), (0, 0), (3, 4), 7.0)
    results = run_tasks([movingai_task(grid, down), movingai_task(grid, problems[0], name="slow")], to_the_goal(0.1))
    assert [trial.outcome for trial in results.trials] == ["collided", "timeout"] and results.score == 0.0
    assert results.trials[1].task == "slow" and results.trials[1].time == pytest.approx(28.0, abs=1.1)


def test_a_car_can_drive_it_too(files: tuple[mrs.OccupancyGrid, list[Scenario]]) -> None:
    grid, problems = files
    car = {"drive": "ackermann", "wheelbase": 0.3, "track": 0.2, "wheel_radius": 0.05, "robot_radius": 0.1}
    task: Task = movingai_task(grid, problems[0], parameters=car)
    assert task.simulation().robot.footprint.radius == 0.1
    (trial,) = run_tasks([task], to_the_goal(1.0)).trials
    assert trial.outcome == "succeeded" and trial.score == 1.0


def test_problems_that_are_no_drive_are_refused(files: tuple[mrs.OccupancyGrid, list[Scenario]]) -> None:
    grid, problems = files
    with pytest.raises(ValueError, match=r"the start and the goal of a problem must differ, got \(0, 4\) for both"):
        movingai_task(grid, problems[1])
    with pytest.raises(ValueError, match="speed must be positive, got -1"):
        movingai_task(grid, problems[0], speed=-1.0)
    with pytest.raises(ValueError, match="the map of this problem must have 8 x 5 cells, got 4 x 2"):
        movingai_task(mrs.OccupancyGrid(np.zeros((2, 4), np.int8), resolution=0.5), problems[0])
