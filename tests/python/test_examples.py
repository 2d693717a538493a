"""The example project passes its tests, except the one that fails on purpose."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]


def test_the_tests_of_the_example_project_pass():
    check = Path(__file__).parents[1] / "check_examples.py"
    done = subprocess.run([sys.executable, check], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == "the example project works\n"


@pytest.mark.parametrize("seed", [2, 3])
def test_the_particle_filter_finds_the_robot(tmp_path, seed):
    script, picture = ROOT / "examples/localization/particle_filter.py", tmp_path / "localization.png"
    command = [sys.executable, script, "--seed", str(seed), "--out", picture]
    lines = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout.splitlines()
    errors = [float(line.split()[1]) for line in lines[1:]]
    assert len(errors) == 12 and max(errors[-6:]) < 0.1
    assert picture.stat().st_size > 10_000


def test_a_policy_learns_and_the_same_seed_gives_the_same_one(tmp_path):
    script, picture = ROOT / "examples/learning/evolution.py", tmp_path / "learning.png"
    command = [sys.executable, script, "--generations", "5", "--out", picture]
    one, other = (subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout for _ in range(2))
    assert one == other
    shares = [float(line.split()[2].rstrip("%")) for line in one.splitlines()]
    assert len(shares) == 6 and max(shares[3:]) > 3.0 * shares[0] and max(shares[3:]) > 20.0
    assert picture.stat().st_size > 10_000


def test_the_room_shows_readings_behind_glass_and_beyond_a_mirror(tmp_path):
    script, picture = ROOT / "examples/surfaces/room.py", tmp_path / "surfaces.png"
    command = [sys.executable, script, "--out", picture]
    line = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True).stdout
    assert 150 < int(line.split()[0]) < 350 and "behind the first surface" in line
    assert picture.stat().st_size > 10_000


def test_the_documentation_shows_the_report_of_the_failure(tmp_path):
    example = shutil.copytree(ROOT / "examples/testing", tmp_path / "example")
    command = [sys.executable, "-m", "pytest", "tests/test_on_purpose.py", "--basetemp", str(tmp_path / "base")]
    report = subprocess.run(command, cwd=example, capture_output=True, text=True, timeout=120, check=False).stdout
    documented = (ROOT / "docs/guides/testing.md").read_text(encoding="utf-8").splitlines()
    lines = [line for line in report.splitlines() if line.startswith(("E  ", "repeat with:")) and "picture:" not in line]
    assert len(lines) == 5 and "first contact: a wall at" in lines[3]
    assert [line for line in lines if line not in documented] == []
