"""arguments: wrong ones of searches and estimates are named as the caller gave them, with what is needed."""

from __future__ import annotations

import math

import pytest

from falsification.crossing import SPACE, Crosser, requirement
from mobile_robot_simulator.falsification import compare_controllers, estimate, falsify

DRIVERS = {
    falsify: ("controller", (Crosser,)),
    estimate: ("controller", (Crosser,)),
    compare_controllers: ("second", (Crosser, Crosser)),
}


@pytest.mark.parametrize("call", DRIVERS, ids=lambda call: call.__name__)
def test_common_arguments(call):
    name, controllers = DRIVERS[call]

    def refused(*arguments, **options):
        with pytest.raises((TypeError, ValueError)) as caught:
            call(*arguments, **options)
        return f"{type(caught.value).__name__}: {caught.value}"

    most = controllers[:-1]
    assert refused(*most, 3, SPACE, requirement) == f"TypeError: {name} must be a function of the simulation, got 3"
    assert refused(*controllers, "office", requirement) == "TypeError: space must be a scenarios.Space, got 'office'"
    needed = "requirement must be a requirement such as always(clearance > 0.2)"
    assert refused(*controllers, SPACE, math.inf) == f"TypeError: {needed}, got inf"
    for option in ("budget", "processes"):
        for wrong in (1.5, "many", None, True, [3]):
            shown = refused(*controllers, SPACE, requirement, **{option: wrong})
            assert shown == f"TypeError: {option} must be an integer, got {wrong!r}"
        for wrong in (0, -1):
            shown = refused(*controllers, SPACE, requirement, **{option: wrong})
            assert shown == f"ValueError: {option} must be at least 1, got {wrong}"
    for wrong in (None, 1.5, "a", True):
        assert refused(*controllers, SPACE, requirement, seed=wrong) == f"TypeError: seed must be an integer, got {wrong!r}"
    assert refused(*controllers, SPACE, requirement, seed=-1) == "ValueError: seed must be at least 0, got -1"
    if call is compare_controllers:
        assert refused(3, Crosser, SPACE, requirement) == "TypeError: first must be a function of the simulation, got 3"
    else:
        shown = refused(*controllers, SPACE, requirement, progress=3)
        assert shown == "TypeError: progress must be a function or None, got 3"


def test_arguments_of_searches(tmp_path):
    for option in ("keep_going", "is_shrunk"):
        with pytest.raises(TypeError, match=rf"^{option} must be True or False, got 1$"):
            falsify(Crosser, SPACE, requirement, **{option: 1})
    for wrong in (3, b"folder"):
        with pytest.raises(TypeError, match=r"^corpus must be a text, a Path or None, got "):
            falsify(Crosser, SPACE, requirement, corpus=wrong)
    (tmp_path / "file").write_text("")
    with pytest.raises(NotADirectoryError, match=r"^corpus must be a folder, got the file "):
        falsify(Crosser, SPACE, requirement, corpus=tmp_path / "file")
    for wrong in ("best", 3, ["cma"]):
        with pytest.raises(ValueError, match=r"^method must be one of random, sobol, cma, got "):
            falsify(Crosser, SPACE, requirement, method=wrong)


def test_arguments_of_estimates():
    for option in ("confidence", "width"):
        with pytest.raises(TypeError, match=rf"^{option} must be a number, got 'a'$"):
            estimate(Crosser, SPACE, requirement, **{option: "a"})
        with pytest.raises(ValueError, match=rf"^{option} must be between 0 and 1, got 2$"):
            estimate(Crosser, SPACE, requirement, **{option: 2})
