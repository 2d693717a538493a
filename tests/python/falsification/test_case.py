"""Case: a file with a controller, a space and a requirement."""

from __future__ import annotations

import sys

import pytest

from falsification import crossing
from mobile_robot_simulator.falsification.case import Case
from mobile_robot_simulator.requirements import always, speed

GOOD = """
from mobile_robot_simulator.requirements import always, speed
def controller(sim): pass
requirement = always(speed < 1.0)
"""


@pytest.fixture
def file(tmp_path, monkeypatch):
    def file(text, name="case_under_test.py"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    monkeypatch.setattr(sys, "path", [*sys.path])
    yield file
    sys.modules.pop("case_under_test", None)


def test_a_file_is_loaded(file):
    case = Case.load(file(GOOD))
    assert case.requirement == always(speed < 1.0) and case.controller.__name__ == "controller" and case.space is None
    assert Case.of(case.controller, case.requirement) == case


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must define controller"),
        ("controller = 3", "must define controller"),
        ("def controller(sim): pass", "must define requirement"),
        (GOOD + "space = 3", r"must define space as a scenarios\.Space, got int"),
    ],
)
def test_a_file_without_what_is_needed_is_refused(file, text, message):
    with pytest.raises(ValueError, match=message):
        Case.load(file(text))


def test_names_of_files_are_checked(file, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"No such file or directory: .*missing\.py"):
        Case.load(tmp_path / "missing.py")
    with pytest.raises(IsADirectoryError, match="Must be a regular file, got a folder"):
        Case.load(tmp_path)
    with pytest.raises(ValueError, match="whose name is that of a module"):
        Case.load(file(GOOD, "not-a-module.py"))
    with pytest.raises(ValueError, match="another module is named json"):
        Case.load(file(GOOD, "json.py"))


def test_a_controller_is_recognised_by_its_file():
    case = Case.of(crossing.controller, crossing.requirement)
    assert case is not None and case.file.name == "crossing.py" and case.space is crossing.SPACE
    assert Case.of(crossing.Halting, crossing.requirement) is None
    assert Case.of(crossing.controller, always(speed < 1.0)) is None
