"""The example of the guide: the planted fault is found, shrunk and repeated, as the guide prints it."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from mobile_robot_simulator.falsification import falsify
from mobile_robot_simulator.falsification.case import Case

ROOT = Path(__file__).parents[3]


@pytest.mark.slow
def test_the_guide_prints_what_is_found(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "path", [*sys.path])
    case = Case.load(ROOT / "examples" / "falsify" / "follower.py")
    found = falsify(case.controller, case.space, case.requirement, corpus=tmp_path)
    guide = (ROOT / "docs" / "guides" / "falsify.md").read_text(encoding="utf-8")
    for line in str(found).splitlines()[:-1]:
        assert f"{line}\n" in guide
    assert f"counterexamples/{found.shrunk.world.name}/counterexample.json" in guide
    assert (found.shrunk.world.start, found.shrunk.world.goal) == ((8.0, 6.0, 0.0), (2.0, 6.0))
    drive, is_same = found.counterexample.repeat(case.controller, case.requirement)
    assert is_same and drive == found.shrunk
