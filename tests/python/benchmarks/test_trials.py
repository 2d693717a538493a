"""trials: outcomes and times of controllers that are easy to predict, in generated worlds."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from benchmarks.barn_worlds import Exiting, Gaps, still, straight, write_path, write_world
from mobile_robot_simulator.benchmarks import Observation, Task, Trial, Trials, barn_task, run_tasks
from mobile_robot_simulator.worker_pool import WorkerDied

SEED = 22


@pytest.fixture
def free(tmp_path: Path) -> Task:
    """A world without obstacles. Its path is one cell, on the straight line to the goal."""
    return barn_task(write_world(tmp_path, "free", []), write_path(tmp_path, "free", [(15.5, 0)]))


def test_a_straight_drive_takes_the_time_of_its_distance(free: Task) -> None:
    """9 m to the tolerance of 1 m. The clock starts when 0.1 m are driven, and stops at a multiple of 0.1 s."""
    trial = run_tasks([free], straight).trials[0]
    assert (trial.task, trial.outcome) == ("free", "succeeded")
    assert 8.8 <= trial.time <= 9.05
    assert trial.score == pytest.approx(5.0 / 10.0, rel=0.01)  # faster than twice the optimal time, 5 s


def test_contact_ends_a_task(tmp_path: Path, free: Task) -> None:
    """The front of the robot, 0.229 m ahead of its origin, meets a cylinder at y = 6.425 after 3.196 m."""
    world = write_world(tmp_path, "blocked", [(-2.25, 6.5)])
    trials = run_tasks([barn_task(world, write_path(tmp_path, "path", [(15, 0)])), free], straight)
    assert [trial.outcome for trial in trials.trials] == ["collided", "succeeded"]
    assert 3.0 <= trials.trials[0].time <= 3.3 and trials.trials[0].score == 0.0
    assert trials.share("collided") == 0.5 and trials.score == trials.trials[1].score / 2


def test_a_robot_that_does_not_move_runs_out_of_time(free: Task) -> None:
    assert run_tasks([free], still).trials == (Trial("free", "timeout", pytest.approx(100.0), 0.0),)


def test_the_goal_is_in_the_frame_of_the_robot(free: Task) -> None:
    seen: list[Observation] = []

    def controller() -> object:
        def control(observation: Observation) -> tuple[float, float]:
            seen.append(observation)
            return 1.0, 1.0

        return control

    run_tasks([free], controller)
    sim = free.simulation()
    for observation in seen[:20]:
        sim.run_for(observation.time - sim.time)
        place = sim.pose * mrs.Pose(*observation.goal, 0.0)
        assert (place.x, place.y) == pytest.approx(free.goal, abs=1e-9)
        sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=1.0), angular=mrs.messages.Vector3(z=1.0)))


def test_the_number_of_processes_does_not_change_the_results(free: Task) -> None:
    tasks = [free] * 4
    assert run_tasks(tasks, Gaps, processes=2) == run_tasks(tasks, Gaps)


def test_a_process_that_dies_is_told_with_its_task(free: Task) -> None:
    behind = (2 * free.start.x - free.goal[0], 2 * free.start.y - free.goal[1])
    tasks = [free, replace(free, name="deadly", goal=behind), free]
    with pytest.raises(WorkerDied, match="a process ended with exit code 7 before the task 'deadly' was done") as caught:
        run_tasks(tasks, Exiting, processes=2)
    assert caught.value.exit_code == 7


def test_the_table() -> None:
    trials = Trials((Trial("world_0", "succeeded", 10.0, 0.5), Trial("world_6", "collided", 3.25, 0.0)))
    assert str(trials).splitlines() == [
        "task     outcome    time [s]   score",
        "world_0  succeeded     10.00  0.5000",
        "world_6  collided       3.25  0.0000",
        "mean     50.0%         10.00  0.2500",
    ]
    assert math.isnan(Trials(trials.trials[1:]).time)


@pytest.mark.parametrize("command", [(1.0, math.nan), (1.0,), "fast", None])
def test_a_command_that_is_none_is_an_error(free: Task, command: object) -> None:
    with pytest.raises(ValueError, match="free: a command must be"):
        run_tasks([free], lambda: lambda _: command)


def test_no_tasks_and_no_processes_are_errors(free: Task) -> None:
    with pytest.raises(ValueError, match="tasks must have at least one task, got none"):
        run_tasks([], straight)
    with pytest.raises(ValueError, match="processes must be at least 1, got 0"):
        run_tasks([free], straight, processes=0)


def test_generated_worlds_are_driven_in_two_processes(tmp_path: Path) -> None:
    random = np.random.default_rng(SEED)
    path = write_path(tmp_path, "path", [(15, 0)])
    tasks = []
    for index in range(30):
        places = random.integers((0, 0), (29, 30), (15, 2))
        cylinders = [(-4.425 + 0.15 * col, 5.075 + 0.15 * row) for col, row in places.tolist()]
        tasks.append(barn_task(write_world(tmp_path, f"world_{index}", cylinders), path))
    trials = run_tasks(tasks, Gaps, processes=2)
    assert len(trials.trials) == 30 and trials.share("succeeded") > 0.3
