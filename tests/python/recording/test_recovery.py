"""Recovery: what a killed process, a full disk or a removed folder leaves, and the recording that is made of it."""

from __future__ import annotations

import errno
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from disks import read_only_folder, small_disk
from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.recording.recorder import Format, Recorder, recover
from recordings import FORMATS, contents, drive, read, record

MESSAGES = 3000
KILLED = """
import os, signal, sys
sys.path.insert(0, {tests!r})
import numpy as np
from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.recording.recorder import Recorder
{limit}
recorder = Recorder({folder!r}, format={format!r})
for number in range(1, {messages} + 1):
    recorder.write("/scan", ros.LaserScan(ranges=np.full(541, number, np.float32)), number)
{end}
"""
KILL = "os.kill(os.getpid(), signal.SIGKILL)"
LIMIT = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({bytes}, {bytes}))"

posix = pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither SIGKILL nor limits of files")


def start(folder: Path, format: Format, *, end: str = KILL, limit: str = "") -> subprocess.CompletedProcess[str]:
    tests = str(Path(__file__).parents[1])
    script = KILLED.format(tests=tests, folder=str(folder), format=format, messages=MESSAGES, end=end, limit=limit)
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)


def assert_beginning(path: Path, count: int, *, at_least: int) -> None:
    """Asserts that a recording has the first `count` messages."""
    got = read(path)
    assert at_least <= len(got) == count <= MESSAGES
    for number, (topic, message, time_ns) in enumerate(got, start=1):
        assert (topic, time_ns) == ("/scan", number)
        assert message.ranges.tolist() == [number] * 541


@posix
@pytest.mark.parametrize("format", FORMATS)
def test_what_a_killed_process_has_written_is_recovered(tmp_path: Path, format: Format) -> None:
    start(tmp_path, format)
    assert [item.name for item in tmp_path.iterdir()] == ["recording.unfinished"]
    path, count = recover(tmp_path)
    assert [item.name for item in tmp_path.iterdir()] == [path.name]
    # A message has 2.2 kB. The last batch and the last chunk of a megabyte may be lost.
    assert_beginning(path, count, at_least=MESSAGES - 1024 - 500)


@posix
@pytest.mark.parametrize("format", FORMATS)
def test_a_full_disk_keeps_what_was_written(tmp_path: Path, format: Format) -> None:
    done = start(tmp_path, format, end="recorder.close()", limit=LIMIT.format(bytes=5_000_000))
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("OSError: ") and f"mobile-robot-simulator recover {tmp_path}" in last
    assert str(tmp_path / "recording.unfinished") in last
    path, count = recover(tmp_path)
    assert_beginning(path, count, at_least=1024)


def fill(folder: Path, format: Format) -> None:
    """Records until the disk is full."""
    with Recorder(folder, format=format) as recorder:
        for number in range(1, MESSAGES + 1):
            recorder.write("/scan", ros.LaserScan(ranges=np.full(541, number, np.float32)), number)


@pytest.mark.parametrize("format", FORMATS)
def test_a_full_disk_keeps_what_was_written_also_if_recovery_has_no_space(tmp_path: Path, format: Format) -> None:
    with small_disk(kilobytes=6144) as folder:
        with pytest.raises(OSError, match="messages written before are kept") as raised:
            fill(folder, format)
        assert raised.value.filename == str(folder / "recording.unfinished")
        assert raised.value.errno == errno.ENOSPC
        with pytest.raises(OSError, match="Nothing was recovered; what was written is kept") as raised:
            recover(folder)
        assert raised.value.filename == str(folder / "recording.unfinished")
        assert raised.value.errno == errno.ENOSPC
        assert not (folder / "recording.unfinished" / "rebuilt").exists()
        shutil.copytree(folder, tmp_path / "copy")
    path, count = recover(tmp_path / "copy")
    assert_beginning(path, count, at_least=1024)


@pytest.mark.parametrize("format", FORMATS)
def test_a_disk_that_is_full_from_the_beginning_is_an_os_error(format: Format) -> None:
    with small_disk(kilobytes=64) as folder:
        (folder / "more").write_bytes(bytes(1024 * 64))
        with pytest.raises(OSError, match=r"No recording was begun|was broken off") as raised:
            fill(folder, format)
        assert raised.value.filename == str(folder / "recording.unfinished")
        assert raised.value.errno == errno.ENOSPC


@pytest.mark.parametrize("format", FORMATS)
def test_a_read_only_folder_is_an_error_with_its_path(tmp_path: Path, format: Format) -> None:
    with read_only_folder(tmp_path), pytest.raises(OSError, match=r"(Read-only|Permission).*recording\.unfinished"):
        Recorder(tmp_path, format=format)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("format", FORMATS)
def test_a_removed_folder_ends_a_long_recording(tmp_path: Path, format: Format) -> None:
    recorder = Recorder(tmp_path / "out", format=format)
    shutil.rmtree(tmp_path / "out")
    with pytest.raises(OSError, match="the folder is gone, nothing is kept"):
        for number in range(1024):
            recorder.write("/clock", ros.Clock(), number)
    recorder.close()


@pytest.mark.parametrize("format", FORMATS)
def test_a_removed_folder_is_an_error_with_its_path(tmp_path: Path, format: Format) -> None:
    recorder = Recorder(tmp_path / "out", format=format)
    shutil.rmtree(tmp_path / "out")
    with pytest.raises(OSError, match=r"nothing is kept: '.*recording.unfinished'"):
        for topic, message, time_ns in drive():
            recorder.write(topic, message, time_ns)
        recorder.close()
    recorder.close()


@pytest.mark.parametrize("format", FORMATS)
def test_a_file_cut_anywhere_gives_the_messages_before_the_cut(tmp_path: Path, format: Format) -> None:
    if format == "sqlite3":
        pytest.skip("SQLite's journal restores the file")
    whole = record(tmp_path / "whole", format, drive())
    file = whole if whole.is_file() else whole / "recording.mcap"
    data, expected = file.read_bytes(), read(whole)
    for number, size in enumerate(range(0, len(data), max(1, len(data) // 40))):
        folder = tmp_path / f"{number}"
        place = folder / "recording.unfinished" / file.relative_to(whole.parent)
        place.parent.mkdir(parents=True)
        place.write_bytes(data[:size])
        try:
            path, count = recover(folder)
        except ValueError as error:
            assert "no complete message" in str(error)
            assert place.read_bytes() == data[:size]
        else:
            assert count == len(expected) == len(read(path))
            assert contents(path) == contents(whole)


def test_an_older_recording_is_kept(tmp_path: Path) -> None:
    path = record(tmp_path, "mcap", drive(1))
    before = contents(path)
    (tmp_path / "recording.unfinished").mkdir()
    (tmp_path / "recording.unfinished" / "recording.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(FileExistsError, match="--overwrite"):
        recover(tmp_path)
    assert contents(path) == before and (tmp_path / "recording.unfinished" / "recording.bag").exists()


def test_an_unfinished_folder_without_messages_is_removed(tmp_path: Path) -> None:
    path = record(tmp_path, "mcap", drive(1))
    (tmp_path / "recording.unfinished" / "replaced").mkdir(parents=True)
    with pytest.raises(FileNotFoundError, match="No recording was broken off"):
        recover(tmp_path)
    assert list(tmp_path.iterdir()) == [path]


def test_nothing_to_recover(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="No recording was broken off"):
        recover(tmp_path)
    assert list(tmp_path.iterdir()) == []
    with Recorder(tmp_path), pytest.raises(BlockingIOError, match="Another process is recording"):
        recover(tmp_path)


def test_a_new_recording_does_not_lose_one_that_was_broken_off(tmp_path: Path) -> None:
    (tmp_path / "recording.unfinished").mkdir()
    (tmp_path / "recording.unfinished" / "recording.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(FileExistsError, match=rf"mobile-robot-simulator recover {tmp_path}"):
        Recorder(tmp_path)
    assert (tmp_path / "recording.unfinished" / "recording.bag").exists()
    with Recorder(tmp_path, overwrite=True):
        pass
    assert [item.name for item in tmp_path.iterdir()] == ["recording"]
