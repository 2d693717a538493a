"""Runs the tests of the example project in a copy of it, with the package and the pytest of this Python."""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent / "examples/testing"

REPORTED = (
    "AssertionError: the robot did not come within 0.3 m of (2.1, 6.5) in 30 s",
    "repeat with: pytest tests/test_on_purpose.py::test_a_straight_line_leads_through_walls --simulator-seed 4",
    "recording: ",
    "picture: ",
)


def main() -> None:
    """Runs the project's tests. All must pass except the one that fails on purpose, whose report must be complete."""
    with tempfile.TemporaryDirectory() as folder:
        project = Path(folder, "testing")
        shutil.copytree(PROJECT, project, ignore=shutil.ignore_patterns("__pycache__"))
        command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", f"--basetemp={folder}/kept"]
        done = subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=600)
        failed = re.findall(r"^FAILED (\S+)", done.stdout, re.MULTILINE)
        assert failed == ["tests/test_on_purpose.py::test_a_straight_line_leads_through_walls"], done.stdout + done.stderr
        assert "1 failed, 11 passed" in done.stdout, done.stdout
        for text in REPORTED:
            assert text in done.stdout, f"{text!r} is not in\n{done.stdout}"
        assert len(list(Path(folder, "kept").glob("**/recording.mcap"))) == 1
    print("the example project works")


if __name__ == "__main__":
    main()
