"""Deadly: controllers that end their process, and pieces of work for a pool of processes that do so."""

from __future__ import annotations

import os
import signal
import sys
import time

from falsification.crossing import SPACE, Crosser
from mobile_robot_simulator.requirements import always, clearance

requirement, space = always(clearance > -1.0), SPACE


class Exiting(Crosser):
    """Ends its process with exit code 7, in worlds with three obstacles."""

    def __init__(self, sim):
        self._obstacles = len(sim.obstacles)

    def __call__(self, seen):
        if self._obstacles == 3 and seen.time > 1.0:
            os._exit(7)
        return super().__call__(seen)


class Quitting(Exiting):
    """Calls sys.exit in the same worlds."""

    def __call__(self, seen):
        if self._obstacles == 3 and seen.time > 1.0:
            sys.exit(7)
        return 0.5, 0.0


class Killed(Exiting):
    """Is killed in the same worlds, as by the kernel when memory is used up."""

    def __call__(self, seen):
        if self._obstacles == 3 and seen.time > 1.0:
            os.kill(os.getpid(), signal.SIGKILL)
        return 0.5, 0.0


class DyingAlone(Crosser):
    """Ends its process in worlds without obstacles."""

    def __init__(self, sim):
        if not sim.obstacles:
            os._exit(7)


controller = Exiting


class OwnError(Exception):
    """An error that cannot be unpickled."""

    def __init__(self, one, two):
        super().__init__(f"{one} {two}")


def work(task):
    """Returns the square of a number; other tasks end the process or raise errors."""
    if task == "exit":
        os._exit(3)
    if task == "exit late":
        time.sleep(1.0)
        os._exit(4)
    if task == "close":
        os.closerange(3, 100)
        time.sleep(60.0)
    if task == "own":
        raise OwnError("an", "error")
    if task == "wait":
        time.sleep(60.0)
    if isinstance(task, str):
        raise KeyError(task)
    return os.getpid() if task == 0 else task * task
