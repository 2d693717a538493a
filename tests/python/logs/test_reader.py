"""reader: which format a file has."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from mobile_robot_simulator.logs import read_log

MCAP = b"\x89MCAP0\r\n"
FLASER = "FLASER 2 1.0 2.5 1 2 0.5 1.1 2.1 0.6 1230.8 host 1230.9\n"


def test_the_content_decides(tmp_path: Path) -> None:
    (tmp_path / "a").write_text(FLASER)
    (tmp_path / "b").write_text("time,x,y,yaw,0.5\n1,2,3,0,4\n")
    np.savez(tmp_path / "c.npz", poses=np.zeros((1, 3)), ranges=[[4.0]], angles=[0.5])
    (tmp_path / "c.npz").rename(tmp_path / "c")
    for name, beams in (("a", 2), ("b", 1), ("c", 1)):
        assert read_log(tmp_path / name, max_range=9.0).ranges.shape == (1, beams)


def test_arguments_of_other_formats_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text(FLASER)
    (tmp_path / "b.csv").write_text("time,x,y,yaw,0.5\n1,2,3,0,4\n")
    with pytest.raises(ValueError, match="only a bag has topics"):
        read_log(tmp_path / "a.log", pose_topic="/odom")
    with pytest.raises(ValueError, match="scanner must be None, got '/scan'"):
        read_log(tmp_path / "b.csv", scanner="/scan")
    with pytest.raises(ValueError, match="max_range must be None, got 3"):
        read_log(tmp_path, max_range=3)
    with pytest.raises(ValueError, match="must have lines that begin with RLASER, got FLASER"):
        read_log(tmp_path / "a.log", scanner="RLASER")


def test_wrong_arguments(tmp_path: Path) -> None:
    (tmp_path / "b.csv").write_text("time,x,y,yaw,0.5\n1,2,3,0,4\n")
    with pytest.raises(TypeError, match="the path of a log must be a text or a Path, got None"):
        read_log(None)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="max_range must be a number, got 'a'"):
        read_log(tmp_path / "b.csv", max_range="a")  # type: ignore[arg-type]
    for wrong in (0, -1.5):
        with pytest.raises(ValueError, match=f"max_range must be greater than 0 m, got {wrong}"):
            read_log(tmp_path / "b.csv", max_range=wrong)


def test_what_is_no_log(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_log(tmp_path / "missing")
    (tmp_path / "bytes").write_bytes(bytes(range(256)) * 40)
    with pytest.raises(ValueError, match="must have a scan"):
        read_log(tmp_path / "bytes")


@pytest.mark.parametrize(
    ("name", "data", "got"),
    [("a.bag", b"", "an empty one"), ("b.bag", b"12345", "one that begins with b'12345'"), ("c.log", MCAP, "one that beg")],
)
def test_what_is_no_bag(tmp_path: Path, name: str, data: bytes, got: str) -> None:
    (tmp_path / name).write_bytes(data)
    needed = r"must be a ROS 1 bag, which begins with b'#ROSBAG V2\.0\\n', or a file named \.mcap or \.db3"
    with pytest.raises(ValueError, match=f"{name}: {needed}, got {got}"):
        read_log(tmp_path / name)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no FIFOs")
@pytest.mark.parametrize("name", ["pipe", "pipe.bag", "pipe.mcap", "pipe.csv", "pipe.npz"])
def test_a_fifo_does_not_hang(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    with pytest.raises(OSError, match="Must be a regular file, got a FIFO"):
        read_log(tmp_path / name)
