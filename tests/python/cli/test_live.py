"""The command live: its options, and that the script it gives repeats the simulation."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import urllib.request

import pytest
from typer.testing import CliRunner

import mobile_robot_simulator as mrs
from foxglove_client import connected
from mobile_robot_simulator.cli import live as live_command
from mobile_robot_simulator.cli.app import app
from mobile_robot_simulator.recording.serialization import ros2_types


@pytest.fixture
def views(monkeypatch):
    """Views that the command opens. It does not run them in real time, but for the time that was asked for at once."""
    opened = []

    def run(view, duration):
        opened.append(view)
        view.session._run(round((duration or 1.0) * 1e9))
        view.close()

    monkeypatch.setattr(live_command, "_run", run)
    return opened


def live(*arguments: object) -> str:
    ran = CliRunner().invoke(app, ["live", "--port", "0", *map(str, arguments)])
    assert ran.exit_code == 0, ran.output + repr(ran.exception)
    return ran.output


def test_it_prints_the_address_and_ctrl_c_ends_it(room, tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-m", "mobile_robot_simulator", "live", room, "--port", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
    )
    try:
        line = process.stdout.readline()
        url = re.fullmatch(r"Live view: (http://127.0.0.1:\d+/)\n", line)
        assert url, line
        assert urllib.request.urlopen(url[1], timeout=20).status == 200
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
        assert process.returncode == 130 and "Traceback" not in errors
    finally:
        process.kill()
        process.wait()
    assert not list(tmp_path.glob("live*"))


def test_without_a_map_it_shows_an_office(views):
    live()
    (view,) = views
    assert view.session.simulation.grid.shape == mrs.floor_plan("office", seed=1).shape


def test_the_duration_ends_it(command, room):
    ran = command("live", room, "--port", 0, "--duration", 0.5)
    assert ran.returncode == 0 and "Live view: http://127.0.0.1:" in ran.stdout


def test_the_script_of_a_session_repeats_it(views, room, tmp_path):
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,wz\n0.5,0.3,0,0.2\n1.25,0,0,1\n")
    faults = ["--fault", "Drop('/scan', probability=0.5, seed=2)"]
    live(
        room, "--commands", commands, "--seed", 3, "--start", 2, 2, 0, "-p", "laser_frequency:=20", "--duration", 3, *faults
    )
    (view,) = views
    before = view.session.simulation
    script = {"__name__": "__main__"}
    exec(view.session.journal.to_python(view.session.now_ns), script)
    after = script["sim"]
    assert after.time == before.time == 3.0 and after.pose == before.pose != (2.0, 2.0, 0.0)
    assert (after.latest("/scan").ranges == before.latest("/scan").ranges).all()
    assert after.latest("/scan").header.stamp == before.latest("/scan").header.stamp


def test_the_built_in_driver_drives_at_once_if_asked(views, room):
    live(room, "--driver", "wander", "--duration", 5)
    live(room, "--duration", 5)
    assert views[0].session.simulation.truth.distance > 0.5 and views[1].session.simulation.truth.distance == 0.0


def test_the_robot_has_a_footprint_that_stops_at_walls_unless_the_parameters_say_otherwise(views, room):
    live(room)
    live(room, "-p", "robot_radius:=0.3", "-p", "contact:=report", "--format", "sqlite3")
    robots = [view.session.simulation.robot.parameters for view in views]
    assert [(each.robot_radius, each.contact) for each in robots] == [(0.2, "stop"), (0.3, "report")]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--duration", "-1"], "--duration must be positive and finite, got -1.0"),
        (["--radius", "nan"], "--radius must be positive and finite, got nan"),
        (["-p", "laser_frequenc:=3"], "did you mean 'laser_frequency'"),
        (["--host", "999.1.1.1"], "cannot listen on 999.1.1.1"),
        (["--fault", "Nothing()"], "unknown fault"),
    ],
)
def test_invalid_options_are_refused(command, room, arguments, message):
    ran = command("live", room, "--port", 0, *arguments)
    assert ran.returncode == 1 and message in ran.stderr and "Traceback" not in ran.stderr


def test_a_recording_is_played(room, tmp_path):
    commands = tmp_path / "commands.csv"
    commands.write_text("time,vx,vy,wz\n0,0.3,0,0\n")
    made = ["run", room, "--duration", "2", "--commands", commands, "--out", tmp_path / "drive", "--start", "2", "2", "0"]
    assert CliRunner().invoke(app, list(map(str, made))).exit_code == 0
    bag = tmp_path / "cut.mcap"
    bag.write_bytes((tmp_path / "drive" / "recording" / "recording.mcap").read_bytes()[:-100])
    process = subprocess.Popen(
        [sys.executable, "-m", "mobile_robot_simulator", "live", bag, "--port", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        line = process.stdout.readline()
        url = re.fullmatch(r"Live view: (http://127.0.0.1:\d+/)\n", line)
        assert url, line
        assert urllib.request.urlopen(url[1], timeout=20).status == 200
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
        assert process.returncode == 130 and "Traceback" not in errors
        assert f"{bag}: the bag has no end" in " ".join(errors.split())
    finally:
        process.kill()
        process.wait()


def test_a_recording_takes_no_options_of_a_simulation(tmp_path):
    bag = tmp_path / "some.mcap"
    bag.write_bytes(b"\x89MCAP0\r\n")
    ran = CliRunner().invoke(app, ["live", str(bag), "--seed", "0", "--foxglove"])
    assert ran.exit_code == 1
    assert f"{bag} is a recording, so there is no simulation for --seed, --foxglove" in str(ran.exception)


def test_foxglove_shows_and_moves_the_same_simulation(room):
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "mobile_robot_simulator", "live", room, "--port", "0", "--start", "2", "2", "0"),
            *("--foxglove", "--foxglove-port", "0"),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        lines = [process.stdout.readline() for _ in range(2)]
        url = re.fullmatch(r"Foxglove: (ws://127.0.0.1:\d+)\n", lines[1])
        assert lines[0].startswith("Live view: ") and url, lines
        with connected(url[1], lambda: None) as client:
            client.send(
                "advertise",
                channels=[
                    {"id": 1, "topic": "/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/msg/Twist"},
                ],
            )
            client.subscribe(5, "/odom")
            client.data(5)
            client.publish(1, b'{"linear": {"x": 0.5}}')

            def moves():
                client.publish(1, b'{"linear": {"x": 0.5}}')
                odometry = ros2_types().deserialize_cdr(client.messages[-1][2], "nav_msgs/msg/Odometry")
                return odometry.pose.pose.position.x > 0.1

            client.wait(moves)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
        assert process.returncode == 130 and "Traceback" not in errors
    finally:
        process.kill()
        process.wait()


def test_a_world_has_the_cell_size_that_is_asked_for_in_the_script_too(views, tmp_path):
    world = tmp_path / "room.map"
    world.write_text("type octile\nheight 6\nwidth 9\nmap\n" + "@" * 9 + ("@" + "." * 7 + "@") * 4 + "@" * 9 + "\n")
    live(world, "--resolution", "0.5", "--start", "2", "1.5", "0")
    session = views[0].session
    assert session.simulation.grid.resolution == 0.5
    assert ", resolution=0.5)" in session.journal.to_python(session.now_ns)


@pytest.mark.parametrize("option", ["--resolution", "--unit"])
def test_a_generated_office_has_no_cell_size_of_its_own(option):
    ran = CliRunner().invoke(app, ["live", "--port", "0", option, "0.5"])
    assert isinstance(ran.exception, ValueError) and f"it takes no {option}" in str(ran.exception)
