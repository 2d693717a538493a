"""The command recover. test_run.py kills a run and recovers it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")


def test_a_folder_without_anything_to_recover(command: Callable[..., CompletedProcess[str]], tmp_path: Path) -> None:
    done = command("recover", tmp_path)
    assert done.returncode == 1
    assert f"{tmp_path}: no recording was broken off in this folder" in done.stderr
