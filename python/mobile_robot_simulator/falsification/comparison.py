"""Comparison: two controllers in the same worlds."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from operator import index

from ..requirements.formula import Requirement
from ..scenarios.space import Space
from ..simulation.arguments import check_integers
from .arguments import check_task
from .drive import Setup
from .intervals import mcnemar
from .runner import Runner
from .samplers import sampler

__all__ = ["PairedResult", "compare_controllers"]


@dataclass(frozen=True)
class PairedResult:
    """How often two controllers violated a requirement in the same worlds.

    Attributes:
        neither: Number of worlds in which none failed.
        only_first: Number in which only the first failed.
        only_second: Number in which only the second failed.
        both: Number in which both failed.
    """

    neither: int
    only_first: int
    only_second: int
    both: int

    @property
    def p_value(self) -> float:
        """Probability of a difference at least as large if both were equally good: McNemar's exact two-sided test."""
        return mcnemar(self.only_first, self.only_second)

    def __str__(self) -> str:
        return (
            f"{self.neither} worlds neither, {self.only_first} only the first, {self.only_second} only the second, "
            f"{self.both} both failed: p = {self.p_value:.3g} (McNemar, exact)"
        )


def compare_controllers(
    first: Setup,
    second: Setup,
    space: Space,
    requirement: Requirement,
    budget: int = 200,
    *,
    seed: int = 0,
    processes: int = 1,
) -> PairedResult:
    """Drives two controllers in the same worlds.

    Args:
        first: The first controller, as for `falsify`.
        second: The second one.
        space: The worlds.
        requirement: The requirement.
        budget: Number of worlds.
        seed: Seed of the worlds.
        processes: Number of processes. The result does not depend on it.

    Raises:
        ValueError: An argument is out of range, or a world cannot be simulated.
        TypeError: An argument has a wrong type.
        LostDrive: Something ended one of several processes during a drive.
    """
    check_task(space, requirement, first=first, second=second)
    check_integers(1, budget=budget, processes=processes)
    check_integers(0, seed=seed)
    counts: Counter[tuple[bool, bool]] = Counter()
    with Runner([first, second], space, requirement, processes) as runner:
        source, left = sampler("random", len(space.dimensions), seed), index(budget)
        while left:
            points = source.ask()[:left]
            left -= len(points)
            counts.update((one.failed, other.failed) for one, other in runner.run(points))
    return PairedResult(counts[False, False], counts[True, False], counts[False, True], counts[True, True])
