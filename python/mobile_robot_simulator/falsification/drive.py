"""Drive: one controller in one world, and how far it was from violating a requirement."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..benchmarks.control_loop import STEP, Controller, ControlLoop
from ..quoting import quoted, shortened
from ..requirements.formula import Requirement
from ..requirements.trace import Trace
from ..scenarios.world import World
from ..simulation.simulation import Simulation

__all__ = ["Drive", "Setup", "run_drive"]

Setup = Callable[[Simulation], Controller | None]
"""Connects a controller to a simulation: returns a controller that is asked every `STEP`, or spawns nodes."""

CONTACT, ARRIVED, TIME, ERROR = "contact", "arrived", "time", "error"
"""Ways in which a drive ends."""


@dataclass(frozen=True)
class Drive:
    """The result of a drive.

    Attributes:
        world: The world.
        robustness: Robustness of the requirement; minus infinity if the controller raised an error.
        time: Simulated time at the end [s].
        ending: How it ended: contact, arrived, time or error.
        error: Name and message of the error, or "".
    """

    world: World
    robustness: float
    time: float
    ending: str
    error: str = ""

    @property
    def failed(self) -> bool:
        """True if the requirement is violated."""
        return self.robustness <= 0.0

    def __str__(self) -> str:
        what = self.error if self.ending == ERROR else f"robustness {self.robustness:.4g}"
        return f"{what} after {self.time:g} s ({self.ending}), {self.world.things} obstacles and faults"


def check_world(world: World, file: Path) -> None:
    """Checks that the world of a file can be simulated.

    Args:
        world: The world.
        file: The file, for the error.

    Raises:
        ValueError: It cannot.
        OSError: The map file cannot be read.
    """
    try:
        world.simulation().close()
    except (ValueError, TypeError) as error:
        raise ValueError(f"{file}: not a world that can be simulated: {error}") from None


def run_drive(
    world: World,
    controller: Setup,
    requirement: Requirement,
    *,
    prepare: Callable[[Simulation], object] | None = None,
    finish: Callable[[Simulation], object] | None = None,
) -> Drive:
    """Runs a controller in a world until contact, arrival or the end of the time.

    An error that the controller raises, a call of `sys.exit`, or a command that is not finite, is a violation.

    Args:
        world: The world.
        controller: The controller.
        requirement: The requirement.
        prepare: Called with the simulation before the drive, for example to record it.
        finish: Called with the simulation after the drive, for example to draw it.

    Raises:
        ValueError: The world cannot be simulated, or the requirement needs something that it does not have.
        OSError: The map file cannot be read.
        TypeError: The controller returned something else than a function or None.
    """
    with world.simulation() as sim:
        if prepare is not None:
            prepare(sim)
        error, control = "", None
        try:
            control = controller(sim)
            ending = _run(sim, world, control if callable(control) else None)
        except (Exception, SystemExit) as raised:
            ending, error = ERROR, shortened(f"{type(raised).__name__}: {raised}")
        if control is not None and not callable(control):
            # Not a violation: the robot has stood still, and nothing was tested.
            raise TypeError(f"a controller must return a function of what it observes, or None, got {quoted(control)}")
        robustness = -math.inf if error else requirement.robustness(Trace(sim))
        if finish is not None:
            finish(sim)
        return Drive(world, robustness, sim.time, ending, error)


def _run(sim: Simulation, world: World, control: Controller | None) -> str:
    loop = None if control is None else ControlLoop(sim, control, world.goal)
    touches = sim.robot.footprint is not None
    steps = 0
    while sim.time < world.duration - 1e-9:
        steps += 1
        sim.run_for(min(steps * STEP, world.duration) - sim.time)
        if touches and sim.truth.contacts:
            return CONTACT
        if world.goal is not None and math.dist(tuple(sim.pose)[:2], world.goal) <= world.tolerance:
            return ARRIVED
        if loop is not None:
            loop.command()
    return TIME
