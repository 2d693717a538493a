"""Falsifier: the same arguments give the same result, for any number of processes; the corpus is run first."""

from __future__ import annotations

import pytest

from falsification import crossing
from falsification.crossing import SPACE, Crosser, Halting, controller, requirement
from mobile_robot_simulator.falsification import Counterexample, falsify


@pytest.mark.slow
@pytest.mark.parametrize("method", ["random", "sobol", "cma"])
def test_the_number_of_processes_changes_nothing(method):
    one = falsify(controller, SPACE, requirement, 80, method=method, seed=4, keep_going=True, is_shrunk=False)
    two = falsify(controller, SPACE, requirement, 80, method=method, seed=4, processes=2, keep_going=True, is_shrunk=False)
    assert one == two and one.drives == 80 and one.failures > 0


@pytest.mark.parametrize("method", ["random", "sobol", "cma"])
def test_each_method_finds_the_fault_and_repeats_itself(method):
    found = [falsify(controller, SPACE, requirement, 200, method=method, seed=1) for _ in range(2)]
    assert found[0] == found[1] and found[0].first_failure <= 200
    assert found[0].shrunk.world.things == 1
    assert falsify(controller, SPACE, requirement, 200, method=method, seed=2) != found[0]


def test_progress_is_told():
    told = []
    found = falsify(Halting, SPACE, requirement, 40, progress=lambda *values: told.append(values))
    assert [drives for drives, _, _ in told] == list(range(1, 41)) and {budget for _, budget, _ in told} == {40}
    nearest = [value for _, _, value in told]
    assert nearest == sorted(nearest, reverse=True) and nearest[-1] == found.worst.robustness


def test_a_counterexample_is_saved_and_run_first_the_next_time(tmp_path):
    found = falsify(controller, SPACE, requirement, 200, corpus=tmp_path / "corpus")
    saved = found.counterexample
    assert saved.world == found.shrunk.world and not found.notes and found.known == ()
    assert str(found).splitlines()[-1].startswith("repeat with: mobile-robot-simulator falsify ")
    again = falsify(controller, SPACE, requirement, 200, corpus=tmp_path / "corpus")
    assert again.drives == 0 and again.known == (found.shrunk,) and again.worst == found.shrunk and again.failed
    assert str(again).startswith("1 known counterexamples still fail\nworst: ") and " of 0 drives" not in str(again)
    repaired = falsify(Halting, SPACE, requirement, 5, corpus=tmp_path / "corpus")
    assert repaired.drives == 5 and repaired.known == () and not repaired.failed
    assert str(repaired).startswith("0 of 5 drives failed\nworst: ")
    assert list(Counterexample.all_in(tmp_path / "corpus")) == [saved]


def test_the_module_of_these_tests_is_a_case():
    assert crossing.controller is Crosser
