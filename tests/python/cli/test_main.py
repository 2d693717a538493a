"""The command line, as its users call it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import yaml

import mobile_robot_simulator as mrs

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")
pytest.importorskip("matplotlib", reason="the extra `plotting` is not installed")
from rosbags.highlevel import AnyReader


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "mobile_robot_simulator", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "COLUMNS": "200", "NO_COLOR": "1"},
    )


@pytest.fixture
def room(tmp_path: Path) -> Path:
    cells = np.zeros((80, 120), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    file = tmp_path / "room.yaml"
    mrs.save_map(mrs.OccupancyGrid(cells, resolution=0.05), file)
    return file


@pytest.mark.parametrize("form", ["mcap", "bag", "sqlite3"])
def test_run_leaves_a_bag_a_picture_and_a_summary(room, tmp_path, form):
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


def test_run_repeats_itself_to_the_byte(room, tmp_path):
    for out in ("a", "b"):
        assert command("run", room, "--duration", 3, "--seed", 9, "--out", tmp_path / out).returncode == 0
    first, second = ((tmp_path / out / "recording" / "recording.mcap").read_bytes() for out in ("a", "b"))
    assert first == second


def test_run_follows_commands_from_a_file(room, tmp_path):
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,wz\n0,0.5,0,0\n2,0,0,0\n")
    out = tmp_path / "out"
    done = command("run", room, "--duration", 4, "--start", 1, 2, 0, "--commands", commands, "--out", out)
    assert done.returncode == 0, done.stderr
    summary = json.loads((out / "summary.json").read_text())
    assert summary["end"] == pytest.approx([2.0, 2.0, 0.0], abs=1e-12)
    assert summary["distance"] == pytest.approx(1.0, abs=1e-12)


def test_run_counts_collisions(room, tmp_path):
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,wz\n0,1,0,0\n")
    out = tmp_path / "out"
    assert command("run", room, "--duration", 3, "--start", 5, 2, 0, "--commands", commands, "--out", out).returncode == 0
    assert json.loads((out / "summary.json").read_text())["collisions"] == 1


def test_run_keeps_a_recording_unless_told_to_overwrite_it(room, tmp_path):
    out = tmp_path / "out"
    assert command("run", room, "--duration", 1, "--out", out).returncode == 0
    before = (out / "recording" / "recording.mcap").read_bytes()
    again = command("run", room, "--duration", 2, "--out", out)
    assert again.returncode == 1 and "--overwrite" in again.stderr and "Traceback" not in again.stderr
    assert (out / "recording" / "recording.mcap").read_bytes() == before
    assert command("run", room, "--duration", 2, "--out", out, "--overwrite").returncode == 0
    assert (out / "recording" / "recording.mcap").read_bytes() != before


def test_ctrl_c_leaves_a_bag_that_opens(room, tmp_path):
    out = tmp_path / "out"
    words = [sys.executable, "-m", "mobile_robot_simulator", "run", room, "--duration", 1e6, "--real-time", "--out", out]
    process = subprocess.Popen([*map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        deadline = time.monotonic() + 30.0
        while not (out / "recording").exists():
            assert time.monotonic() < deadline and process.poll() is None
            time.sleep(0.05)
        time.sleep(2.0)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=30.0)
    finally:
        process.kill()
    assert process.returncode == 130, stderr
    assert "Traceback" not in stderr
    with AnyReader([out / "recording"]) as reader:
        counts = {connection.topic: connection.msgcount for connection in reader.connections}
    summary = json.loads((out / "summary.json").read_text())
    assert summary["interrupted"] is True
    assert counts["/odom"] == counts["/scan"] == summary["scans"] > 0


def test_real_time_is_paced(room, tmp_path):
    out = tmp_path / "out"
    done = command("run", room, "--duration", 2, "--real-time", "-p", "speed_factor:=2.0", "--out", out)
    assert done.returncode == 0, done.stderr
    assert json.loads((out / "summary.json").read_text())["wall_seconds"] >= 0.9


def test_scan_prints_json(room):
    done = command("scan", room, "--pose", 3.0, 2.0, 0.0, "--json", "-p", "apply_noise:=false", "-p", "laser_beam_count:=3")
    content = json.loads(done.stdout)
    assert content["ranges"][1] == pytest.approx(2.95, abs=1e-6)
    assert len(content["ranges"]) == 3 and content["range_max"] == 30.0


def test_scan_draws(room, tmp_path):
    picture = tmp_path / "scan.png"
    done = command("scan", room, "--pose", 3, 2, 0, "--plot", picture)
    assert done.returncode == 0 and picture.read_bytes().startswith(b"\x89PNG")


def test_info_describes_a_map(room):
    words = command("info", room).stdout
    assert "120 x 80" in words and "0.05 m" in words and "6 m x 4 m" in words


def test_parameters_come_back_from_what_was_printed(room, tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text(
        command(
            "parameters", "-p", "laser_beam_count:=17", "-p", "laser_mount:=[0.1, 0.0, 1.5]", "-p", "laser_frame_id:=laser"
        ).stdout
    )
    again = command("parameters", "--ros-args", "--params-file", file)
    assert again.stdout == file.read_text()
    content = yaml.safe_load(again.stdout)
    assert content["laser_scanner_simulator_node"]["ros__parameters"]["laser_beam_count"] == 17


def test_floor_plan_is_a_map(tmp_path):
    file = tmp_path / "deep" / "office.yaml"
    assert command("floor-plan", file, "--seed", 2).returncode == 0
    assert np.array_equal(mrs.load_map(file).cells, mrs.floor_plan("office", seed=2).cells)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nowhere.yaml"], "nowhere.yaml"),
        (["info", "nowhere.yaml"], "nowhere.yaml"),
        (["run", "{room}", "--duration", "nan"], "--duration must be positive and finite, got nan"),
        (["run", "{room}", "--duration", "0"], "--duration must be positive and finite, got 0"),
        (["run", "{room}", "--radius", "-1"], "--radius must be positive"),
        (["run", "{room}", "--radius", "9"], "no known free place for a disc of radius 9 m"),
        (["run", "{room}", "--start", "0.01", "0.01", "0"], "start must not be inside a wall, got (0.01, 0.01, 0.0)"),
        (["run", "{room}", "--start", "nan", "1", "0"], "x must be finite, got NaN"),
        (["run", "{room}", "--seed", "-1"], "seed must be in 0..2**64 - 1, got -1"),
        (["run", "{room}", "--commands", "nowhere.csv"], "nowhere.csv"),
        (["run", "{room}", "-p", "laser_beams:=3"], "did you mean 'laser_beam_count'"),
        (["run", "{room}", "-p", "laser_beam_count=3"], "name:=value"),
        (["run", "{room}", "-p", "laser_beam_count:=0"], "laser_beam_count must be greater than or equal to 1, got 0"),
        (["run", "{room}", "-p", "publish_rate:=fast"], "publish_rate must be a valid number"),
        (["run", "{room}", "-p", "laser_max_range:=0.01"], "laser_min_range must be less than laser_max_range 0.01"),
        (["scan", "{room}", "--pose", "inf", "0", "0"], "finite"),
        (["parameters", "--params-file", "nowhere.yaml"], "nowhere.yaml"),
        (["floor-plan", "plan.yaml", "--kind", "ofice"], "office"),
    ],
)
def test_bad_input_is_an_error_and_leaves_nothing(room, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    done = command(*(argument.format(room=room) for argument in arguments))
    assert done.returncode == 1, done.stdout
    assert message in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "drive").exists() and not (tmp_path / "plan.yaml").exists()


def test_usage_errors_are_the_shells(room):
    assert command("run").returncode == 2
    assert command("fly", room).returncode == 2
    assert command("--version").stdout.strip() == mrs.__version__
