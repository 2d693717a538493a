"""Intervals of confidence for a rate, and the exact test of paired results."""

from __future__ import annotations

import math
from collections.abc import Callable

__all__ = ["clopper_pearson", "confidence_sequence", "mcnemar"]

STEPS = 60
"""Halvings of an interval of length 1, until its width is below the spacing of floats near 1."""


def clopper_pearson(failures: int, drives: int, confidence: float) -> tuple[float, float]:
    """Returns the interval of Clopper and Pearson for a rate, after a number of drives that was fixed before.

    It contains the true rate with at least the given probability.

    Args:
        failures: Number of failures.
        drives: Number of drives, at least 1.
        confidence: Probability, between 0 and 1.

    Source:
        C. Clopper and E. Pearson, *The use of confidence or fiducial limits illustrated in the case of the binomial*,
        Biometrika 26, 1934.
    """
    tail = 0.5 * (1.0 - confidence)
    low = 0.0 if not failures else _root(lambda rate: at_least(failures, drives, rate) >= tail)
    high = 1.0 if failures == drives else _root(lambda rate: 1.0 - at_least(failures + 1, drives, rate) <= tail)
    return low, high


def confidence_sequence(failures: int, drives: int, confidence: float) -> tuple[float, float]:
    """Returns an interval for a rate that is valid whenever one stops, also if the results decide when.

    With at least the given probability, the true rate is in the intervals after all numbers of drives at once. A rate p is
    in the interval if the likelihood of the results, averaged over all rates with the same weight, is less than
    1/(1 - confidence) times their likelihood under p. Under the true rate this ratio is a martingale with mean 1, so it ever
    exceeds this bound with a probability of at most 1 - confidence (Ville's inequality).

    Args:
        failures: Number of failures.
        drives: Number of drives.
        confidence: Probability, between 0 and 1.

    Source:
        H. Robbins, *Statistical methods related to the law of the iterated logarithm*, Annals of Mathematical Statistics 41,
        1970, with the uniform weight.
    """
    mixed = math.lgamma(failures + 1) + math.lgamma(drives - failures + 1) - math.lgamma(drives + 2)
    bound = mixed + math.log(1.0 - confidence)

    def is_inside(rate: float) -> bool:
        return _log_likelihood(failures, drives, rate) >= bound

    best = failures / drives if drives else 0.5
    low = 0.0 if is_inside(0.0) else _root(lambda share: is_inside(share * best)) * best
    high = 1.0 if is_inside(1.0) else best + _root(lambda share: not is_inside(best + share * (1.0 - best))) * (1.0 - best)
    return low, high


def mcnemar(only_first: int, only_second: int) -> float:
    """Returns the p-value of McNemar's exact two-sided test of whether two rates of failure on the same worlds are equal.

    Args:
        only_first: Number of worlds in which only the first fails.
        only_second: Number of worlds in which only the second fails.

    Source:
        Q. McNemar, *Note on the sampling error of the difference between correlated proportions*, Psychometrika 12, 1947,
        with the binomial distribution instead of its approximation.

    Example:
        >>> from mobile_robot_simulator.falsification.intervals import mcnemar
        >>> mcnemar(6, 0), mcnemar(3, 3)
        (0.03125, 1.0)
    """
    different, fewer = only_first + only_second, min(only_first, only_second)
    ways = sum(math.comb(different, number) for number in range(fewer + 1))
    return min(1.0, float(2 * ways / 2**different))


def at_least(failures: int, drives: int, rate: float) -> float:
    """Returns the probability of at least so many failures.

    Args:
        failures: Number of failures, at least 1.
        drives: Number of drives.
        rate: Rate of failure of each, 0 to 1.
    """
    if rate in (0.0, 1.0):
        return rate if failures <= drives else 0.0
    terms = (
        math.lgamma(drives + 1)
        - math.lgamma(number + 1)
        - math.lgamma(drives - number + 1)
        + _log_likelihood(number, drives, rate)
        for number in range(failures, drives + 1)
    )
    return min(1.0, math.fsum(map(math.exp, terms)))


def _log_likelihood(failures: int, drives: int, rate: float) -> float:
    if (failures and rate <= 0.0) or (failures < drives and rate >= 1.0):
        return -math.inf
    failed = failures * math.log(rate) if failures else 0.0
    return failed + ((drives - failures) * math.log1p(-rate) if failures < drives else 0.0)


def _root(is_beyond: Callable[[float], bool]) -> float:
    """Returns where a condition begins to hold between 0, where it does not, and 1, where it does."""
    low, high = 0.0, 1.0
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        if is_beyond(middle):
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)
