"""Estimation: how often a controller violates a requirement in a space of worlds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from operator import index

from ..quoting import quoted
from ..requirements.formula import Requirement
from ..scenarios.space import Space
from ..simulation.arguments import check_integers, check_numbers
from .arguments import check_progress, check_task
from .drive import Setup
from .intervals import clopper_pearson, confidence_sequence
from .runner import Runner
from .samplers import BATCH, sampler

__all__ = ["Estimate", "estimate"]


@dataclass(frozen=True)
class Estimate:
    """A rate of failure with its interval of confidence.

    Attributes:
        failures: Number of drives that violated the requirement.
        drives: Number of drives.
        low: Lower end of the interval.
        high: Upper end.
        confidence: Probability with which such an interval contains the true rate, at least.
    """

    failures: int
    drives: int
    low: float
    high: float
    confidence: float

    @property
    def rate(self) -> float:
        """Share of the drives that failed."""
        return self.failures / self.drives

    def __str__(self) -> str:
        return (
            f"{self.failures} of {self.drives} drives failed: {self.rate:.2%}, "
            f"{self.confidence:.4g} confidence interval {self.low:.2%} to {self.high:.2%}"
        )


def estimate(
    controller: Setup,
    space: Space,
    requirement: Requirement,
    budget: int = 1000,
    *,
    width: float | None = None,
    confidence: float = 0.95,
    seed: int = 0,
    processes: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Estimate:
    """Estimates how often a controller violates a requirement in worlds that are drawn from a space.

    Without `width`, it makes all drives of the budget, and the interval is that of Clopper and Pearson. With it, it stops as
    soon as the interval is narrow enough. Stopping at a moment that the results choose would spoil that interval, so it is
    then a confidence sequence, which is valid at all moments and somewhat wider; see `confidence_sequence`.

    Args:
        controller: The controller, as for `falsify`.
        space: The worlds. All points of its unit cube have the same chance.
        requirement: The requirement.
        budget: Largest number of drives.
        width: Width of the interval at which it stops, above 0 and below 1; None: never.
        confidence: Probability with which the interval contains the true rate, between 0 and 1.
        seed: Seed of the worlds.
        processes: Number of processes. The result does not depend on it.
        progress: Called after each drive with the number of drives and of failures.

    Raises:
        ValueError: An argument is out of range, or a world cannot be simulated.
        TypeError: An argument has a wrong type.
        LostDrive: Something ended one of several processes during a drive.
    """
    check_task(space, requirement, controller=controller)
    check_integers(1, budget=budget, processes=processes)
    check_integers(0, seed=seed)
    check_progress(progress)
    check_numbers(confidence=confidence)
    if not 0.0 < confidence < 1.0:
        raise ValueError(f"confidence must be between 0 and 1, got {quoted(confidence)}")
    if width is not None:
        check_numbers(width=width)
        if not 0.0 < width < 1.0:
            raise ValueError(f"width must be between 0 and 1, got {quoted(width)}")
    drives = failures = 0
    with Runner([controller], space, requirement, processes) as runner:
        source = sampler("random", len(space.dimensions), seed)
        while drives < budget:
            for (drive,) in runner.run(source.ask()[: min(BATCH, index(budget) - drives)]):
                drives += 1
                failures += drive.failed
                if progress is not None:
                    progress(drives, failures)
            if width is not None:
                low, high = confidence_sequence(failures, drives, confidence)
                if high - low <= width:
                    break
    interval = clopper_pearson if width is None else confidence_sequence
    return Estimate(failures, drives, *interval(failures, drives, confidence), confidence)
