"""formula: robustness equals that of the definition, evaluated by loops; bad formulas are refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given as examples
from hypothesis import settings
from hypothesis import strategies as st

from mobile_robot_simulator.requirements import always, clearance, eventually, until
from mobile_robot_simulator.requirements.formula import Always, Both, Comparison, Either, Eventually, Not, Until
from requirements.traces import GivenTrace, given

a, b = given("a"), given("b")


def oracle(formula, trace, index):
    """Robustness at a sample by the definition of Donzé and Maler (2010), with the samples of a window picked one by one."""

    def window():
        now = trace.times[index]
        return [
            later
            for later in range(len(trace.times))
            if formula.window.start - 1e-9 <= trace.times[later] - now <= formula.window.end + 1e-9
        ]

    match formula:
        case Comparison():
            value = trace.values[formula.name][index]
            return value - formula.limit if formula.is_above else formula.limit - value
        case Both():
            return min(oracle(formula.first, trace, index), oracle(formula.second, trace, index))
        case Either():
            return max(oracle(formula.first, trace, index), oracle(formula.second, trace, index))
        case Not():
            return -oracle(formula.inner, trace, index)
        case Always():
            return min((oracle(formula.inner, trace, later) for later in window()), default=math.inf)
        case Eventually():
            return max((oracle(formula.inner, trace, later) for later in window()), default=-math.inf)
        case Until():
            return max(
                (
                    min(
                        oracle(formula.then, trace, later),
                        *(oracle(formula.first, trace, before) for before in range(index, later + 1)),
                    )
                    for later in window()
                ),
                default=-math.inf,
            )


windows = st.tuples(st.integers(0, 6), st.one_of(st.integers(0, 8), st.just(math.inf))).map(
    lambda pair: (pair[0] / 2, pair[0] / 2 + pair[1] / 2)
)
atoms = st.sampled_from([a > 0.0, b < 1.0, a < 2.0, b > -1.0])
formulas = st.recursive(
    atoms,
    lambda inner: st.one_of(
        st.builds(lambda one, other: one & other, inner, inner),
        st.builds(lambda one, other: one | other, inner, inner),
        st.builds(lambda one: ~one, inner),
        st.builds(always, inner, windows),
        st.builds(eventually, inner, windows),
        st.builds(until, inner, inner, windows),
    ),
    max_leaves=4,
)
numbers = st.integers(-4, 4).map(float)
traces = st.integers(1, 9).flatmap(
    lambda count: st.builds(
        lambda steps, first, second: GivenTrace(np.cumsum(steps) / 4.0, a=first, b=second),
        *(st.lists(values, min_size=count, max_size=count) for values in (st.integers(1, 4), numbers, numbers)),
    )
)


@settings(max_examples=400, deadline=None)
@examples(formulas, traces)
def test_robustness_is_that_of_the_definition(formula, trace):
    expected = [oracle(formula, trace, index) for index in range(len(trace.times))]
    assert formula.over_time(trace).tolist() == expected
    assert formula.robustness(trace) == expected[0]


def test_a_formula_by_hand():
    trace = GivenTrace([0.0, 1.0, 2.0, 3.0], a=[1.0, 2.0, 0.5, 3.0])
    assert always(a > 0.75).over_time(trace).tolist() == [-0.25, -0.25, -0.25, 2.25]
    assert eventually(a > 2.5, within=(0.0, 1.0)).over_time(trace).tolist() == [-0.5, -0.5, 0.5, 0.5]
    assert until(a < 2.5, a > 2.75).over_time(trace).tolist() == [-0.5, -0.5, -0.5, -0.5]
    assert until(a > 0.25, a > 2.75).over_time(trace).tolist() == [0.25, 0.25, 0.25, 0.25]


def test_a_window_has_the_samples_at_its_ends_in_spite_of_rounding():
    trace = GivenTrace(np.arange(31) * 0.1, a=np.arange(31))
    assert eventually(a > 0.0, within=(0.0, 0.3)).over_time(trace)[:5].tolist() == [3.0, 4.0, 5.0, 6.0, 7.0]
    assert always(a > 0.0, within=(0.7, 0.9)).over_time(trace)[:3].tolist() == [7.0, 8.0, 9.0]


def test_a_limit_that_is_met_exactly_counts_as_violated():
    trace = GivenTrace([0.0], a=[1.0])
    assert (a > 1.0).robustness(trace) == (a < 1.0).robustness(trace) == (~(a > 1.0)).robustness(trace) == 0.0


def test_formulas_are_shown_as_they_are_written():
    assert repr(always((a > 0.2) & (b < 1) | ~(a < 3))) == "always((a > 0.2 m & b < 1 m) | ~(a < 3 m))"
    assert repr(until(a > 1, b > 2, within=(1, 2.5))) == "until(a > 1 m, b > 2 m, within=(1 s, 2.5 s))"
    assert repr((a > 0) & (b > 0) & (a > 1)) == "a > 0 m & b > 0 m & a > 1 m"


@pytest.mark.parametrize(
    "window", [(-1, 2), (2, 1), (math.nan, 1), (math.inf, math.inf), (0, math.nan), (1,), "ab", None, 3]
)
def test_windows_are_checked(window):
    for make in (always, eventually, lambda inner, within: until(inner, inner, within)):
        with pytest.raises(ValueError, match="window must"):
            make(a > 1, within=window)


def test_what_is_no_requirement_is_refused():
    for wrong in (clearance, 0.3, None):
        for make in (always, eventually, lambda one: until(one, a > 0), lambda one: until(a > 0, one), (a > 0).__and__):
            with pytest.raises(TypeError, match=r"a requirement such as clearance > 0\.2 is needed, got"):
                make(wrong)
    with pytest.raises(TypeError, match="has no truth value; combine requirements with &"):
        bool(a > 0)
    with pytest.raises(TypeError, match="has no truth value"):
        0.1 < a < 0.2  # noqa: B015


def test_values_of_signals_are_checked():
    with pytest.raises(ValueError, match=r"signal a must not be NaN, but is at 2 s"):
        (a > 0).robustness(GivenTrace([1.0, 2.0], a=[1.0, math.nan]))
    with pytest.raises(ValueError, match=r"signal a must have a value per sample, \(2,\), got \(1,\)"):
        (a > 0).robustness(GivenTrace([1.0, 2.0], a=[1.0]))
