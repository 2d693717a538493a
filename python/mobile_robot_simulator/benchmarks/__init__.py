"""Benchmarks: tasks of published benchmarks as simulations, with their score."""

from .barn import barn_task
from .task import Task
from .trials import Observation, Trial, Trials, run_tasks

__all__ = ["Observation", "Task", "Trial", "Trials", "barn_task", "run_tasks"]
