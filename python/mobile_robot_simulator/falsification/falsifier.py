"""Falsifier: searches a space for the drive that is nearest to violating a requirement, and shrinks a violation."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from operator import index
from pathlib import Path

from ..requirements.formula import Requirement
from ..scenarios.space import Space
from ..simulation.arguments import check_integers
from .arguments import check_corpus, check_flags, check_progress, check_task
from .case import Case
from .counterexample import Counterexample
from .drive import Drive, Setup
from .lost_drive import LostDrive
from .runner import Runner
from .samplers import Method, sampler
from .shrinking import shrink

__all__ = ["Falsification", "falsify"]

Progress = Callable[[int, int, float], None]
"""Called after each drive: number of drives, budget, smallest robustness so far."""


@dataclass(frozen=True)
class Falsification:
    """The result of a search.

    Attributes:
        drives: Number of drives of the search, without those of the corpus and of the shrinking.
        failures: Number of them that violated the requirement.
        first_failure: Number of drives up to the first violation, that one included; None if there was none.
        worst: Drive with the smallest robustness; a known one only if the search did not run. The first of equal ones.
        shrunk: The worst drive in its smallest world, None if nothing failed or nothing was to be shrunk.
        known: Drives of the corpus that still fail.
        counterexample: The saved counterexample, None if nothing failed or there is no corpus.
        notes: What could not be saved, and why.
    """

    drives: int
    failures: int
    first_failure: int | None
    worst: Drive
    shrunk: Drive | None
    known: tuple[Drive, ...]
    counterexample: Counterexample | None
    notes: tuple[str, ...]

    @property
    def failed(self) -> bool:
        """True if a drive violated the requirement, known ones included."""
        return self.worst.failed or bool(self.known)

    def __str__(self) -> str:
        lines = [f"{len(self.known)} known counterexamples still fail"] if self.known else []
        if self.drives:
            first = f", the first was drive {self.first_failure}" if self.first_failure else ""
            lines.append(f"{self.failures} of {self.drives} drives failed{first}")
        lines.append(f"worst: {self.worst}")
        lines += [f"shrunk: {self.shrunk}"] if self.shrunk else []
        lines += (
            [f"repeat with: {self.counterexample.command}"] if self.counterexample and self.counterexample.command else []
        )
        return "\n".join([*lines, *self.notes])


def falsify(
    controller: Setup,
    space: Space,
    requirement: Requirement,
    budget: int = 500,
    *,
    method: Method = "random",
    seed: int = 0,
    processes: int = 1,
    keep_going: bool = False,
    is_shrunk: bool = True,
    corpus: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Falsification:
    """Searches worlds in which a controller violates a requirement.

    It first runs the counterexamples of the corpus. If one still fails, it stops there. Then it drives in worlds of the
    space until one fails, and shrinks the world of the worst failure. The same arguments give the same result for any number
    of processes; with the method "cma" on the same machine, because the linear algebra of NumPy differs between machines.

    Args:
        controller: The controller; see `mobile_robot_simulator.falsification`.
        space: The worlds.
        requirement: The requirement.
        budget: Largest number of drives of the search.
        method: "random", "sobol" (fills the space evenly) or "cma" (learns from the robustness).
        seed: Seed of the search.
        processes: Number of processes that share the drives. If there are several, the controller and the requirement are
            pickled, so they must be functions or classes of a module.
        keep_going: Use the whole budget, and do not stop at failures.
        is_shrunk: Shrink the world of the worst failure.
        corpus: Folder of counterexamples that are run first, and to which a new one is added.
        progress: Called after each drive with the number of drives, the budget and the smallest robustness so far.

    Returns:
        The result.

    Raises:
        ValueError: A world cannot be simulated, the requirement needs something that it does not have, or an argument is out
            of range.
        TypeError: An argument has a wrong type.
        ImportError: The method needs an extra.
        OSError: The corpus cannot be read or written.
        LostDrive: Something ended one of several processes during a drive. The corpus then has the world of the drive, and
            the worst failure if it was being shrunk.
    """
    check_task(space, requirement, controller=controller)
    check_integers(1, budget=budget, processes=processes)
    check_integers(0, seed=seed)
    check_flags(keep_going=keep_going, is_shrunk=is_shrunk)
    check_progress(progress)
    folder = check_corpus(corpus)
    source = sampler(method, len(space.dimensions), seed)
    failure: Path | None = None
    try:
        with Runner([controller], space, requirement, processes) as runner:
            old = [runner.drive(each.world) for each in Counterexample.all_in(folder)] if folder is not None else []
            known = tuple(drive for drive in old if drive.failed)
            if known and not keep_going:
                return Falsification(0, 0, None, min(known, key=_robustness), None, known, None, ())
            worst: Drive | None = None
            drives, failures, first = 0, 0, None
            while drives < budget and (keep_going or not failures):
                points = source.ask()[: budget - drives]
                values = []
                for (drive,) in runner.run(points):
                    drives += 1
                    values.append(drive.robustness)
                    failures += drive.failed
                    first = drives if drive.failed and first is None else first
                    worst = drive if worst is None or drive.robustness < worst.robustness else worst
                    if progress is not None:
                        progress(drives, index(budget), worst.robustness)
                source.tell(points, values)
            assert worst is not None
            try:
                shrunk = shrink(worst, runner.drive) if worst.failed and is_shrunk else None
            except ChildProcessError:
                if folder is not None:
                    failure = Counterexample.save(folder, worst, controller, requirement)[0].folder
                raise
    except LostDrive as lost:
        if folder is None:
            raise
        raise lost.saved(folder, Case.of(controller, requirement), failure) from None
    saved, notes = None, list[str]()
    if worst.failed and folder is not None:
        saved, notes = Counterexample.save(folder, shrunk or worst, controller, requirement)
    return Falsification(drives, failures, first, worst, shrunk, known, saved, tuple(notes))


def _robustness(drive: Drive) -> float:
    return drive.robustness
