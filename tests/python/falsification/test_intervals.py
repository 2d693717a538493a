"""intervals: known values, and coverage computed exactly over all outcomes."""

from __future__ import annotations

import math

import pytest

from mobile_robot_simulator.falsification.intervals import at_least, clopper_pearson, confidence_sequence, mcnemar


def test_clopper_pearson_gives_known_values():
    """1 - 0.025**(1/n) bounds the rate if nothing fails. 3 of 10: table of R's binom.test."""
    assert clopper_pearson(0, 20, 0.95) == (0.0, pytest.approx(1.0 - 0.025 ** (1 / 20), abs=1e-12))
    assert clopper_pearson(20, 20, 0.95) == (pytest.approx(0.025 ** (1 / 20), abs=1e-12), 1.0)
    assert clopper_pearson(3, 10, 0.95) == pytest.approx((0.06673951, 0.6524529), abs=1e-7)


def test_clopper_pearson_equals_that_of_scipy():
    from scipy.stats import beta

    for failures, drives, confidence in ((1, 7, 0.9), (5, 500, 0.99), (250, 500, 0.95), (499, 500, 0.95)):
        tail = (1 - confidence) / 2
        low = beta.ppf(tail, failures, drives - failures + 1)
        high = beta.ppf(1 - tail, failures + 1, drives - failures)
        assert clopper_pearson(failures, drives, confidence) == pytest.approx((low, high), rel=1e-8)


def test_at_least_is_the_sum_of_the_binomial_distribution():
    for rate in (0.0, 0.1, 0.5, 1.0):
        for failures in (1, 3, 6):
            terms = [math.comb(6, k) * rate**k * (1 - rate) ** (6 - k) for k in range(failures, 7)]
            assert at_least(failures, 6, rate) == pytest.approx(math.fsum(terms), abs=1e-12)


@pytest.mark.parametrize("rate", [0.02, 0.1, 0.5, 0.93])
def test_clopper_pearson_covers_the_rate(rate):
    drives = 40
    missed = math.fsum(
        math.comb(drives, failures) * rate**failures * (1 - rate) ** (drives - failures)
        for failures in range(drives + 1)
        if not clopper_pearson(failures, drives, 0.9)[0] <= rate <= clopper_pearson(failures, drives, 0.9)[1]
    )
    assert missed <= 0.1


@pytest.mark.parametrize("rate", [0.05, 0.3, 0.8])
def test_the_confidence_sequence_covers_the_rate_at_all_times_at_once(rate):
    """The chance that the interval ever leaves out the rate within 150 drives, by recursion over all results."""
    confidence = 0.8
    chances, missed = {0: 1.0}, 0.0
    for drives in range(1, 151):
        after: dict[int, float] = {}
        for failures, chance in chances.items():
            after[failures + 1] = after.get(failures + 1, 0.0) + chance * rate
            after[failures] = after.get(failures, 0.0) + chance * (1.0 - rate)
        chances = {}
        for failures, chance in after.items():
            low, high = confidence_sequence(failures, drives, confidence)
            if low <= rate <= high:
                chances[failures] = chance
            else:
                missed += chance
    assert 0.01 < missed <= 1.0 - confidence


def test_the_confidence_sequence_gets_narrow_and_contains_the_share():
    assert confidence_sequence(0, 0, 0.95) == (0.0, 1.0)
    widths = []
    for drives in (10, 100, 1000, 10_000):
        low, high = confidence_sequence(drives // 10, drives, 0.95)
        assert low < 0.1 < high
        exact = clopper_pearson(drives // 10, drives, 0.95)
        assert low < exact[0] and exact[1] < high
        widths.append(high - low)
    assert widths == sorted(widths, reverse=True) and widths[-1] < 0.03
    assert confidence_sequence(0, 100, 0.95)[0] == 0.0 and confidence_sequence(100, 100, 0.95)[1] == 1.0


def test_mcnemar_equals_the_sum_of_the_binomial_distribution():
    for first in range(12):
        for second in range(12):
            total = first + second
            likely = [math.comb(total, k) / 2**total for k in range(total + 1)]
            as_rare = math.fsum(chance for chance in likely if chance <= likely[first] * (1 + 1e-9))
            assert mcnemar(first, second) == pytest.approx(as_rare, abs=1e-12)
