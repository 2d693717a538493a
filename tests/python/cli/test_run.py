"""The command run: a recording, a picture and a summary of a drive."""

import json
import os
import signal
import subprocess
import sys

import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")
pytest.importorskip("matplotlib", reason="the extra `plotting` is not installed")
from rosbags.highlevel import AnyReader

from disks import small_disk

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("form", ["mcap", "bag", "sqlite3"])
def test_run_saves_a_bag_a_picture_and_a_summary(command, room, tmp_path, form):
    out = tmp_path / "out"
    done = command("run", room, "--duration", 5, "--start", 2, 2, 0.5, "--out", out, "--format", form, "--seed", 3)
    assert done.returncode == 0, done.stderr
    assert "real-time factor" in done.stdout and "collisions" in done.stdout
    summary = json.loads((out / "summary.json").read_text())
    assert summary["simulated_seconds"] == 5.0 and summary["scans"] == 50 and summary["beams"] == 50 * 541
    assert summary["collisions"] == 0 and summary["seed"] == 3 and summary["start"] == [2.0, 2.0, 0.5]
    assert (out / "drive.png").read_bytes().startswith(b"\x89PNG")
    bag = out / "recording.bag" if form == "bag" else out / "recording"
    with AnyReader([bag]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
        types = {connection.topic: connection.msgtype for connection in reader.connections}
    assert counts.pop("/cmd_vel") == 50
    assert counts == {"/odom": 50, "/tf": 50, "/scan": 50, "/clock": 50, "/map": 1}
    assert types["/tf"] == "tf2_msgs/msg/TFMessage" and types["/map"] == "nav_msgs/msg/OccupancyGrid"


def test_two_runs_with_one_seed_give_the_same_bytes(command, room, tmp_path):
    for out in ("a", "b"):
        assert command("run", room, "--duration", 3, "--seed", 9, "--out", tmp_path / out).returncode == 0
    first, second = ((tmp_path / out / "recording" / "recording.mcap").read_bytes() for out in ("a", "b"))
    assert first == second


def test_run_follows_the_commands_of_a_file(command, room, tmp_path):
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,wz\n0,0.5,0,0\n2,0,0,0\n9,1,0,0\n")
    out = tmp_path / "out"
    done = command("run", room, "--duration", 4, "--start", 1, 2, 0, "--commands", commands, "--out", out)
    assert done.returncode == 0, done.stderr
    assert f"{commands}: 1 of 3 commands come after the drive of 4 s" in done.stderr
    summary = json.loads((out / "summary.json").read_text())
    assert summary["end"] == pytest.approx([2.0, 2.0, 0.0], abs=1e-12)
    assert summary["distance"] == pytest.approx(1.0, abs=1e-12)


def test_run_counts_collisions(command, room, tmp_path):
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,wz\n0,1,0,0\n")
    out = tmp_path / "out"
    assert command("run", room, "--duration", 3, "--start", 5, 2, 0, "--commands", commands, "--out", out).returncode == 0
    assert json.loads((out / "summary.json").read_text())["collisions"] == 1


def test_run_keeps_an_older_recording_without_overwrite(command, room, tmp_path):
    out = tmp_path / "out"
    assert command("run", room, "--duration", 1, "--out", out).returncode == 0
    before = (out / "recording" / "recording.mcap").read_bytes()
    again = command("run", room, "--duration", 2, "--out", out)
    assert again.returncode == 1 and "--overwrite" in again.stderr and "Traceback" not in again.stderr
    assert (out / "recording" / "recording.mcap").read_bytes() == before
    assert command("run", room, "--duration", 2, "--out", out, "--overwrite").returncode == 0
    assert (out / "recording" / "recording.mcap").read_bytes() != before


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has other signals")
@pytest.mark.parametrize("form", ["mcap", "bag", "sqlite3"])
@pytest.mark.parametrize(("name", "status"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_a_signal_leaves_a_bag_that_can_be_opened(drive_for_ever, tmp_path, form, name, status):
    process = drive_for_ever("--format", form)
    process.send_signal(getattr(signal, name))
    _, stderr = process.communicate(timeout=60.0)
    assert process.returncode == status, stderr
    assert "Traceback" not in stderr
    out = tmp_path / "out"
    with AnyReader([out / ("recording.bag" if form == "bag" else "recording")]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
    summary = json.loads((out / "summary.json").read_text())
    assert summary["interrupted"] is True
    # The signal can come between two of them.
    three = counts["/odom"], counts["/scan"], summary["scans"]
    assert min(three) > 0 and max(three) - min(three) <= 1
    assert (out / "drive.png").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has other signals")
def test_an_ignored_hangup_stays_ignored(drive_for_ever, tmp_path):
    process = drive_for_ever(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    process.send_signal(signal.SIGHUP)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60.0)
    assert process.returncode == 143


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has other signals")
@pytest.mark.parametrize("form", ["mcap", "bag", "sqlite3"])
def test_a_killed_run_is_recovered(command, drive_for_ever, tmp_path, form):
    process = drive_for_ever("--format", form)
    out = tmp_path / "out"
    busy = command("recover", out)
    assert busy.returncode == 1 and f"{out}: another process is recording into this folder" in busy.stderr
    process.kill()
    process.communicate(timeout=60.0)
    assert [item.name for item in out.iterdir()] == ["recording.unfinished"]
    done = command("recover", out)
    assert done.returncode == 0, done.stderr
    path = out / ("recording.bag" if form == "bag" else "recording")
    with AnyReader([path]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
        times = [time_ns for connection, time_ns, _ in reader.messages() if connection.topic == "/odom"]
    assert done.stdout == f"{path}: {sum(counts.values())} messages\n"
    assert times == [100_000_000 * step for step in range(1, len(times) + 1)] and len(times) > 100


KILLED_WHILE_SAVING = """
import os
from mobile_robot_simulator.cli import summary
from mobile_robot_simulator.cli.main import main
def end(*_):
    {end}
summary.Summary.save = end
main()
"""


@pytest.mark.parametrize(
    ("end", "status", "form"), [("os._exit(9)", 9, "bag"), ("raise OSError(28, 'No space left on device')", 1, "mcap")]
)
def test_without_a_new_summary_the_older_files_stay_together(command, room, tmp_path, form, end, status):
    out = tmp_path / "out"
    assert command("run", room, "--duration", 1, "--out", out).returncode == 0
    before = {path: path.read_bytes() for path in out.rglob("*.*")}
    assert {item.name for item in out.iterdir()} == {"recording", "summary.json", "drive.png"}
    words = ["run", room, "--duration", 2, "--out", out, "--overwrite", "--format", form]
    script = KILLED_WHILE_SAVING.format(end=end)
    done = subprocess.run([sys.executable, "-c", script, *map(str, words)], capture_output=True, text=True, timeout=60)
    assert done.returncode == status and "Traceback" not in done.stderr
    assert status == 9 or f"`mobile-robot-simulator recover {out}` recovers them" in done.stderr
    assert {item.name for item in out.iterdir()} == {"recording", "summary.json", "drive.png", "recording.unfinished"}
    assert {path: path.read_bytes() for path in before} == before
    recovered = command("recover", out, "--overwrite")
    path = "recording.bag" if form == "bag" else "recording"
    assert recovered.stdout == f"{out / path}: {5 * 20 + 1} messages\n"
    assert [item.name for item in out.iterdir()] == [path]


@pytest.mark.parametrize("form", ["mcap", "bag", "sqlite3"])
def test_a_full_disk_ends_a_run_with_one_sentence(command, room, form):
    with small_disk(kilobytes=4096) as disk:
        done = command("run", room, "--duration", 1000, "--out", disk / "out", "--format", form)
        assert done.returncode == 1
        (line,) = done.stderr.strip().splitlines()
        assert line.startswith("error: ") and f"`mobile-robot-simulator recover {disk / 'out'}` recovers them" in line
        assert [item.name for item in (disk / "out").iterdir()] == ["recording.unfinished"]


def test_run_keeps_other_files_of_its_names(command, room, tmp_path):
    (tmp_path / "summary.json").write_text("mine")
    done = command("run", room, "--duration", 1, "--out", tmp_path)
    assert done.returncode == 1 and "--overwrite" in done.stderr and "summary.json" in done.stderr
    assert {item.name for item in tmp_path.iterdir()} == {"summary.json", "room.yaml", "room.pgm"}
    assert (tmp_path / "summary.json").read_text() == "mine"


def test_without_matplotlib_there_is_no_picture(command, room, tmp_path, monkeypatch):
    out, blocked = tmp_path / "out", tmp_path / "blocked"
    assert command("run", room, "--duration", 1, "--out", out).returncode == 0
    (blocked / "matplotlib").mkdir(parents=True)
    (blocked / "matplotlib" / "__init__.py").write_text("raise ImportError")
    monkeypatch.setenv("PYTHONPATH", str(blocked), prepend=os.pathsep)
    done = command("run", room, "--duration", 2, "--out", out, "--overwrite")
    assert done.returncode == 0, done.stderr
    assert "mobile-robot-simulator[plotting]" in done.stdout
    # The picture of the drive that was replaced is gone too.
    assert {item.name for item in out.iterdir()} == {"recording", "summary.json"}
    assert json.loads((out / "summary.json").read_text())["simulated_seconds"] == 2.0


def test_real_time_takes_real_time(command, room, tmp_path):
    out = tmp_path / "out"
    done = command("run", room, "--duration", 2, "--real-time", "-p", "speed_factor:=2.0", "--out", out)
    assert done.returncode == 0, done.stderr
    assert json.loads((out / "summary.json").read_text())["wall_seconds"] >= 0.9


def test_faults_come_from_the_command_line_and_from_the_file_of_parameters(command, room, tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text("/**:\n  ros__parameters:\n    faults: [\"Blackout('scan', start=1)\"]\n")
    options = ("--duration", 3, "--start", 2, 2, 0.5, "--out", tmp_path / "out", "--params-file", file)
    done = command("run", room, *options, "--fault", "Drop('/odom', probability=0.5, seed=1)", "--fault", "Delay('/tf', 9)")
    assert done.returncode == 0, done.stderr
    with AnyReader([tmp_path / "out" / "recording"]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
    assert counts["/scan"] == 9 and 0 < counts["/odom"] < 30 and counts.get("/tf", 0) == 0 and counts["/faults"] > 20


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ("Drop('/scna')", "unknown topic '/scna'; did you mean /scan?"),
        ("Drop('/scan'", "must be a call such as Drop('/scan', probability=0.1)"),
        ("StuckRanges('/odom')", "StuckRanges needs a topic of LaserScan, /odom carries Odometry"),
    ],
)
def test_a_wrong_fault_is_an_error_and_nothing_is_written(command, room, tmp_path, fault, message):
    done = command("run", room, "--out", tmp_path / "out", "--fault", fault)
    assert done.returncode == 1 and message in " ".join(done.stderr.split())
    assert not (tmp_path / "out").exists()
