"""The command compare. tests/python/compare has the results."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import log_of, save

Command = Callable[..., CompletedProcess[str]]

POSES = np.array([[2.0, 2.0, 0.0], [3.0, 1.5, 0.5]])


@pytest.fixture
def log(room: Path, tmp_path: Path) -> Path:
    """The file of a log from the room."""
    return save(log_of(mrs.load_map(room), POSES), tmp_path / "log.npz")


def test_a_report(command: Command, room: Path, log: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "out"
    done = command("compare", room, log, "--out", out)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{room}, {log}\n") and "2 of 101 beams" in done.stdout and "+0.000 m" in done.stdout
    report = json.loads((out / "report.json").read_text())
    assert report["map"] == str(room) and report["beams"]["both"] == 202 and report["residuals"]["mad"] == 0.0
    assert sorted(file.name for file in out.iterdir()) == ["noise.yaml", "report.html", "report.json"]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such signals")
@pytest.mark.parametrize(("name", "status"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_a_signal_leaves_nothing(room: Path, tmp_path: Path, name: str, status: int) -> None:
    grid = mrs.load_map(room)
    log = save(log_of(grid, grid.draw_free_poses(50, radius=0.3, seed=1)), tmp_path / "log.npz", without="max_range")
    words = ["compare", room, log, "--reach", 60, 3.1, "--out", tmp_path / "out"]
    process = subprocess.Popen(
        [sys.executable, "-m", "mobile_robot_simulator", *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None and "max_range is not given" in process.stderr.readline()
    process.send_signal(getattr(signal, name))  # the search takes half a minute
    output, _ = process.communicate(timeout=60)
    assert process.returncode == status and output == "" and not (tmp_path / "out").exists()


def test_an_older_report_stays_if_the_new_one_fails(command: Command, room: Path, log: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    (out / "report.html").mkdir(parents=True)
    (out / "report.json").write_text("older")
    done = command("compare", room, log, "--out", out)
    assert done.returncode == 1 and "report.html: cannot write a file over a folder" in done.stderr
    assert (out / "report.json").read_text() == "older" and len(list(out.iterdir())) == 2


def test_json_without_a_folder(command: Command, room: Path, log: Path, tmp_path: Path) -> None:
    before = set(tmp_path.iterdir())
    done = command("compare", room, log, "--json")
    assert done.returncode == 0 and json.loads(done.stdout)["scans"] == 2
    assert set(tmp_path.iterdir()) == before


def test_what_cannot_be_compared_leaves_no_folder(command: Command, room: Path, tmp_path: Path) -> None:
    away = save(log_of(mrs.load_map(room), POSES, said=POSES + 100.0), tmp_path / "away.npz")
    done = command("compare", room, away, "--out", tmp_path / "out")
    assert done.returncode == 1 and "the poses must be in the frame of the map" in done.stderr
    done = command("compare", room, tmp_path / "missing", "--out", tmp_path / "out")
    assert done.returncode == 1 and done.stderr == f"error: {tmp_path / 'missing'}: no such file or directory\n"
    assert not (tmp_path / "out").exists()


def test_a_file_in_place_of_the_folder_is_found_first(command: Command, room: Path, log: Path) -> None:
    done = command("compare", room, "missing", "--out", log / "out")
    assert done.returncode == 1 and done.stderr == f"error: {log}: must be a folder\n"


def test_a_shifted_log_is_aligned_and_refined(command: Command, room: Path, tmp_path: Path) -> None:
    shifted = save(log_of(mrs.load_map(room), POSES, said=POSES + np.array([0.2, -0.1, 0.0])), tmp_path / "shifted.npz")
    done = command("compare", room, shifted, "--refine", "--json")
    report = json.loads(done.stdout)
    assert report["alignment"]["shift"] == pytest.approx([-0.2, 0.1], abs=0.003)
    assert report["refinement"]["distance"]["median"] < 0.005 and done.stderr == ""
    done = command("compare", room, shifted, "--align", "none", "--offset", 0.01, "--json")
    report = json.loads(done.stdout)
    assert report["alignment"] is None and report["refinement"] is None and report["offset"] == 0.01
    done = command("compare", room, shifted, "--reach", 0.05, 0.01)
    assert "│ alignment " in done.stdout and done.stderr.startswith("the alignment is at the limit of its reach; ")


def test_run_reads_the_fitted_noise(command: Command, room: Path, tmp_path: Path) -> None:
    """The noise of a log, then the noise of a drive with it, are the same."""
    grid = mrs.load_map(room)
    noise = mrs.BeamModel(sigma_hit=0.04, z_hit=0.9, z_short=0.0, z_max=0.0, z_rand=0.1)
    log = save(log_of(grid, grid.draw_free_poses(100, radius=0.3, seed=1), noise=noise), tmp_path / "noisy.npz")
    for number in (1, 2):
        done = command("compare", room, log, "--out", tmp_path / f"out{number}", "--json", "--align", "none")
        assert done.returncode == 0, done.stderr
        fit = json.loads(done.stdout)["noise"]["fit"]
        assert fit["sigma_hit"] == pytest.approx(0.04, rel=0.06) and fit["z_rand"] == pytest.approx(0.1, abs=0.015)
        if number == 1:
            pytest.importorskip("rosbags", reason="the extra `recording` is not installed")
            log = tmp_path / "drive"
            file = tmp_path / "out1" / "noise.yaml"
            done = command("run", room, "--duration", 10, "--seed", 1, "--out", log, "--params-file", file)
            assert done.returncode == 0, done.stderr
