"""Trials: runs a controller on tasks, in parallel, and makes a table of the results."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from ..quoting import quoted
from ..worker_pool import WorkerDied, WorkerPool
from .control_loop import STEP, Controller, ControlLoop
from .task import Task

__all__ = ["Trial", "Trials", "run_tasks"]

STARTED = 0.1
"""Distance from the start at which the clock starts [m], as in the BARN challenge."""


class Trial(NamedTuple):
    """The result of a task."""

    task: str
    """Name of the task."""

    outcome: str
    """succeeded, collided or timeout."""

    time: float
    """Time from when the robot had moved by 0.1 m to the end [s]."""

    score: float
    """Score of the task, 0 to 1; see `Task`."""


@dataclass(frozen=True)
class Trials:
    """The results of tasks, as a sequence of trials. As text, it is a table."""

    trials: tuple[Trial, ...]
    """The results, in the order of the tasks."""

    @property
    def score(self) -> float:
        """Mean score of all tasks."""
        return math.fsum(trial.score for trial in self.trials) / len(self.trials)

    @property
    def time(self) -> float:
        """Mean time of those that succeeded [s], NaN if none did."""
        times = [trial.time for trial in self.trials if trial.outcome == "succeeded"]
        return math.fsum(times) / len(times) if times else math.nan

    def share(self, outcome: str) -> float:
        """Returns the share of tasks with an outcome: succeeded, collided or timeout."""
        return sum(trial.outcome == outcome for trial in self.trials) / len(self.trials)

    def __str__(self) -> str:
        width = max(len("task"), len("mean"), *(len(trial.task) for trial in self.trials))
        lines = [f"{'task':<{width}}  {'outcome':<9}  {'time [s]':>8}  {'score':>6}"]
        lines += [
            f"{name:<{width}}  {outcome:<9}  {time:>8.2f}  {score:>6.4f}" for name, outcome, time, score in self.trials
        ]
        lines += [f"{'mean':<{width}}  {self.share('succeeded'):<9.1%}  {self.time:>8.2f}  {self.score:>6.4f}"]
        return "\n".join(lines)


def run_tasks(tasks: Iterable[Task], controller: Callable[[], Controller], *, seed: int = 0, processes: int = 1) -> Trials:
    """Runs a controller on tasks.

    Contact with anything ends a task, also at the start. A robot that has not moved by 0.1 m within the time limit has
    failed too.

    Args:
        tasks: The tasks.
        controller: Makes a controller for each task. If there are several processes, it must be a function or class of a
            module, because it is pickled.
        seed: Seed of the noise of all tasks.
        processes: Number of processes that share the tasks. The results do not depend on it.

    Returns:
        The results.

    Raises:
        ValueError: There is no task, a task is invalid, `processes` is below 1, a command is not finite, or the controller
            cannot be pickled for several processes.
        WorkerDied: Something ended one of several processes during a task. The message names the task.
    """
    tasks = list(tasks)
    if not tasks:
        raise ValueError("tasks must have at least one task, got none")
    if processes < 1:
        raise ValueError(f"processes must be at least 1, got {processes}")
    run = partial(_run, controller=controller, seed=seed)
    if processes == 1:
        return Trials(tuple(map(run, tasks)))
    pool: WorkerPool[Task, Trial] = WorkerPool(run, min(processes, len(tasks)))
    is_done = False
    try:
        trials = Trials(tuple(pool.run(tasks)))
        is_done = True
        return trials
    except WorkerDied as died:
        if died.index is None:
            raise
        raise WorkerDied(died.exit_code, died.index, f"before the task {quoted(tasks[died.index].name)} was done") from None
    finally:
        pool.close(at_once=not is_done)


def _run(task: Task, *, controller: Callable[[], Controller], seed: int) -> Trial:
    simulation = task.simulation(seed)
    loop = ControlLoop(simulation, controller(), task.goal, name=task.name)
    began: float | None = None
    steps = 0
    while True:
        steps += 1
        simulation.run_for(steps * STEP - simulation.time)
        time, pose = simulation.time, simulation.pose
        if began is None and math.dist((pose.x, pose.y), (task.start.x, task.start.y)) >= STARTED:
            began = time
        taken = time - (began or 0.0)
        if simulation.truth.contacts:
            return Trial(task.name, "collided", taken, 0.0)
        if math.dist((pose.x, pose.y), task.goal) <= task.tolerance:
            return Trial(task.name, "succeeded", taken, task.score(taken))
        if taken >= task.time_limit - 1e-9:
            return Trial(task.name, "timeout", taken, 0.0)
        loop.command()
