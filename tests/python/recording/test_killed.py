"""Recordings of a process that is killed at any step: older and new files are never mixed, and none are lost."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader

from mobile_robot_simulator.new_files import write_files
from mobile_robot_simulator.recording.recorder import Format, Recorder, recover
from recordings import FORMATS

pytestmark = pytest.mark.slow

COMPANIONS = ("summary.json", "drive.png")
OLDER, NEW = 1, 3

KILLED = """
import os, shutil, sys
sys.path[:0] = {paths!r}
from test_killed import {act}, NEW

def count_changes(event, arguments):
    global left
    if event in ("os.rename", "os.remove", "os.mkdir", "os.rmdir") or (event == "open" and arguments[2] & os.O_CREAT):
        left -= 1
        if left == 0:
            os._exit(9)

steps, status = 0, 9
while status == 9:
    steps += 1
    folder = shutil.copytree({source!r}, os.path.join({target!r}, str(steps)))
    if not (child := os.fork()):
        left = steps
        sys.addaudithook(count_changes)
        {act}(folder)
        os._exit(0)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
assert status == 0, status
"""


def save(folder: str | Path, count: int, format: Format = "mcap") -> None:
    """Saves a set of files that belong together: they have the same number of messages."""
    from mobile_robot_simulator import messages as ros

    with Recorder(folder, format=format, overwrite=True, companions=COMPANIONS) as recorder:
        for number in range(count):
            recorder.write("/clock", ros.Clock(), number)
        for name in COMPANIONS:
            write_files({recorder.companion(name): f"{count}".encode()})


def save_mcap(folder: str) -> None:
    save(folder, NEW)


def save_sqlite3(folder: str) -> None:
    save(folder, NEW, "sqlite3")


def save_bag(folder: str) -> None:
    save(folder, NEW, "bag")


def finish(folder: str) -> None:
    recover(folder, overwrite=True, companions=COMPANIONS)


def killed(act: str, source: Path, target: Path) -> list[Path]:
    """Returns copies of a folder. In each one, a process that changes it was killed a step later; in the last one, never."""
    paths = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
    script = KILLED.format(paths=paths, act=act, source=str(source), target=str(target))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return sorted(target.iterdir(), key=lambda folder: int(folder.name))


def counts(folder: Path) -> list[int]:
    """Returns the numbers of messages that the files in their places have, of the recording first."""
    recorded = []
    for path in folder.glob("recording*"):
        if path.name != "recording.unfinished":
            with AnyReader([path]) as reader:
                recorded.append(reader.message_count)
    return recorded + [int((folder / name).read_text()) for name in COMPANIONS if (folder / name).exists()]


def assert_recoverable(folder: Path, scratch: Path) -> str:
    """Asserts that nothing is lost, and returns a word for the state of the folder."""
    assert {item.name for item in folder.iterdir()} <= {"recording", "recording.bag", *COMPANIONS, "recording.unfinished"}
    present = counts(folder)
    assert len(set(present)) <= 1
    if not (folder / "recording.unfinished").exists():
        assert present in ([OLDER] * 3, [NEW] * 3)
        return "older" if present == [OLDER] * 3 else "new"

    # A later recording keeps the newest complete set until it is complete itself.
    later = shutil.copytree(folder, scratch / "later" / folder.name)
    Recorder(later, overwrite=True, companions=COMPANIONS).discard()
    assert counts(later) in ([OLDER] * 3, [NEW] * 3)
    assert {item.name for item in later.iterdir()} <= {"recording", "recording.bag", *COMPANIONS}

    recovered = shutil.copytree(folder, scratch / "recovered" / folder.name)
    try:
        finish(str(recovered))
    except FileNotFoundError:
        assert present in ([OLDER] * 3, [NEW] * 3) and counts(recovered) == present
    except ValueError as error:
        assert "no complete message" in str(error) and present == counts(recovered) == [OLDER] * 3
        return "begun"
    else:
        assert counts(recovered) in ([NEW], [NEW] * 3)
    assert {item.name for item in recovered.iterdir()} <= {"recording", "recording.bag", *COMPANIONS}
    return "unfinished"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork")
@pytest.mark.parametrize("format", FORMATS)
def test_a_killed_process_loses_and_mixes_nothing(tmp_path: Path, format: Format) -> None:
    save(tmp_path / "older", OLDER)
    folders = killed(f"save_{format}", tmp_path / "older", tmp_path / "killed")
    states = [assert_recoverable(folder, tmp_path) for folder in folders]
    assert states[0] == "older" and states[-1] == "new"
    assert states.count("unfinished") > 10


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork")
def test_a_killed_recovery_loses_and_mixes_nothing(tmp_path: Path) -> None:
    save(tmp_path / "older", OLDER)
    folders = killed("save_mcap", tmp_path / "older", tmp_path / "killed")
    complete = [folder for folder in folders if (folder / "recording.unfinished" / "complete" / "recording").exists()]
    # Nothing is moved yet, the older files are half moved, and the new ones are.
    for folder in (complete[0], complete[3], complete[-1]):
        for again in killed("finish", folder, tmp_path / "again" / folder.name):
            assert_recoverable(again, tmp_path / "scratch" / folder.name)
