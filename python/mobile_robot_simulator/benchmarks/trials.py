"""Trials: runs a controller on tasks, in parallel, and makes a table of the results."""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from .._core import Pose
from ..messages import LaserScan, Odometry, Twist, Vector3
from .task import Task

__all__ = ["Controller", "Observation", "Trial", "Trials", "run_tasks"]

STEP = 0.1
"""Time between two commands [s], after which contact and arrival are checked, as in the BARN challenge."""

STARTED = 0.1
"""Distance from the start at which the clock starts [m], as in the BARN challenge."""


class Observation(NamedTuple):
    """What a controller knows."""

    time: float
    """Time since the start [s]."""

    scan: LaserScan
    """The last scan."""

    odometry: Odometry
    """The last odometry. Its frame is the pose of the robot at the start."""

    goal: tuple[float, float]
    """Goal (x, y) in the frame of the robot, x forward, by odometry [m]."""


Controller = Callable[[Observation], tuple[float, float]]
"""Returns the command for the next `STEP`: forward velocity [m/s] and turn rate [rad/s]."""


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
        ValueError: There is no task, a task is invalid, `processes` is below 1, or a command is not finite.
    """
    tasks = list(tasks)
    if not tasks:
        raise ValueError("tasks must have at least one task, got none")
    if processes < 1:
        raise ValueError(f"processes must be at least 1, got {processes}")
    run = partial(_run, controller=controller, seed=seed)
    if processes == 1:
        return Trials(tuple(map(run, tasks)))
    with ProcessPoolExecutor(processes, mp_context=multiprocessing.get_context("spawn")) as pool:
        return Trials(tuple(pool.map(run, tasks, chunksize=max(1, len(tasks) // (8 * processes)))))


def _run(task: Task, *, controller: Callable[[], Controller], seed: int) -> Trial:
    simulation, control = task.simulation(seed), controller()
    robot = simulation.robot.parameters
    laser = simulation.laser.parameters
    # The odometry has a frame of its own, in which the start need not be 0.
    map_from_odom: Pose | None = None
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
        scan, odometry = simulation.latest(laser.laser_topic), simulation.latest(robot.odometry_topic)
        odom_from_base = _pose(odometry)
        if map_from_odom is None:
            map_from_odom = task.start * odom_from_base.inverse()
        goal = (map_from_odom * odom_from_base).inverse() * Pose(*task.goal)
        command = control(Observation(time, scan, odometry, (goal.x, goal.y)))
        simulation.publish(robot.velocity_topic, _twist(task.name, command))


def _pose(odometry: Odometry) -> Pose:
    position, rotation = odometry.pose.pose.position, odometry.pose.pose.orientation
    return Pose.from_quaternion(position.x, position.y, qx=rotation.x, qy=rotation.y, qz=rotation.z, qw=rotation.w)


def _twist(task: str, command: Sequence[float]) -> Twist:
    try:
        speed, turn_rate = map(float, command)
    except (TypeError, ValueError):
        raise ValueError(f"{task}: a command must be two numbers (speed, turn rate), got {command!r}") from None
    if not (math.isfinite(speed) and math.isfinite(turn_rate)):
        raise ValueError(f"{task}: a command must be finite, got {command!r}")
    return Twist(linear=Vector3(x=speed), angular=Vector3(z=turn_rate))
