"""Picture: saving gives the same bytes every time and never leaves an incomplete file."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from mobile_robot_simulator import OccupancyGrid
from mobile_robot_simulator.plotting import DrivePicture, ScanPicture
from rendering import HITS, PATH, room

SUFFIXES = (".png", ".pdf", ".svg")


@pytest.mark.parametrize(
    "grid",
    [
        OccupancyGrid(np.full((4, 4), -1, np.int8), resolution=0.05),
        OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1e-3),
        room(origin=(1e4, -1e4, 3.0)),
    ],
)
def test_maps_without_known_cells_tiny_maps_and_maps_far_away_can_be_drawn(tmp_path: Path, grid: OccupancyGrid) -> None:
    x, y, _ = grid.origin
    DrivePicture(grid, np.array([[x, y]])).save(tmp_path / "drive.png")
    ScanPicture(grid, (x, y, 0.0), np.zeros((0, 2))).save(tmp_path / "scan.png")


@pytest.mark.slow
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_same_arguments_give_the_same_bytes(tmp_path: Path, suffix: str) -> None:
    files = [tmp_path / f"{name}{suffix}" for name in "abc"]
    for file in files[:2]:
        DrivePicture(room(), PATH, scan_points=HITS, laser_pose=(4.0, 2.0, 0.0), goal=(1, 3), title="Office").save(file)
    assert files[0].read_bytes() == files[1].read_bytes()
    DrivePicture(room(), PATH).save(files[2])
    assert files[2].read_bytes() != files[0].read_bytes()
    assert not any(word in files[0].read_bytes() for word in (b"atplotlib v", b"CreationDate", b"dc:date"))


def test_settings_of_the_user_have_no_effect_and_do_not_change(tmp_path: Path) -> None:
    ScanPicture(room(), (2.5, 2.5, 0.0), HITS).save(tmp_path / "a.png")
    with matplotlib.rc_context({"font.size": 20, "xtick.major.size": 20}):
        before = dict(matplotlib.rcParams)
        ScanPicture(room(), (2.5, 2.5, 0.0), HITS).save(tmp_path / "b.png")
        assert dict(matplotlib.rcParams) == before
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_an_older_picture_is_replaced(tmp_path: Path) -> None:
    file = tmp_path / "drive.png"
    file.write_text("older")
    DrivePicture(room(), PATH).save(file)
    assert list(tmp_path.iterdir()) == [file]
    assert file.read_bytes().startswith(b"\x89PNG")


def test_saving_needs_neither_pyplot_nor_a_display(tmp_path: Path) -> None:
    script = f"""
import sys, numpy as np, mobile_robot_simulator as mrs
from mobile_robot_simulator.plotting import DrivePicture
grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
DrivePicture(grid, np.zeros((1, 3))).save({str(tmp_path / "a.png")!r})
assert "matplotlib.pyplot" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60, env={"MPLBACKEND": "TkAgg"})


@pytest.mark.parametrize("name", ["drive", "drive.bmp", "drive.png.txt"])
def test_other_endings_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"must end in \.png, \.pdf, \.svg, got .*drive"):
        DrivePicture(room(), PATH).save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_missing_folders_and_folders_of_the_same_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"no such folder.*nowhere"):
        DrivePicture(room(), PATH).save(tmp_path / "nowhere" / "drive.png")
    (tmp_path / "drive.png").mkdir()
    with pytest.raises(IsADirectoryError, match=r"drive\.png"):
        DrivePicture(room(), PATH).save(tmp_path / "drive.png")


def test_without_matplotlib_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    monkeypatch.delitem(sys.modules, "mobile_robot_simulator.plotting")
    with pytest.raises(ImportError, match=r"pip install 'mobile-robot-simulator\[plotting\]'"):
        importlib.import_module("mobile_robot_simulator.plotting")
