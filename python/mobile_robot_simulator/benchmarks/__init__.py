"""Benchmarks: tasks of published benchmarks as simulations, with their score."""

from .barn import barn_task
from .control_loop import Controller, ControlLoop, Observation
from .movingai import movingai_task
from .task import Task
from .trials import Trial, Trials, run_tasks

__all__ = [
    "ControlLoop",
    "Controller",
    "Observation",
    "Task",
    "Trial",
    "Trials",
    "barn_task",
    "movingai_task",
    "run_tasks",
]
