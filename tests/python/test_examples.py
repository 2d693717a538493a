"""The example project passes its tests, except the one that fails on purpose."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow


def test_the_tests_of_the_example_project_pass():
    check = Path(__file__).parents[1] / "check_examples.py"
    done = subprocess.run([sys.executable, check], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == "the example project works\n"


def test_the_documentation_shows_the_report_of_the_failure():
    documented = (Path(__file__).parents[2] / "docs/guides/testing.md").read_text(encoding="utf-8")
    for line in (
        "E       AssertionError: the robot did not come within 0.3 m of (2.1, 6.5) in 30 s: it was never nearer than",
        "E         first contact: a wall at (8.400, 0.786) at 3.075 s: robot at (8.600, 0.786), speed 0.533 m/s",
        "repeat with: pytest tests/test_on_purpose.py::test_a_straight_line_leads_through_walls --simulator-seed 4",
    ):
        assert line in documented
