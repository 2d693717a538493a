from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.script import Script
from mobile_robot_simulator.live.frames import FrameMaker
from mobile_robot_simulator.live.inputs import read_input
from mobile_robot_simulator.live.journal import Journal
from mobile_robot_simulator.live.session import Session
from mobile_robot_simulator.recording import Recorder
from simulations import SEED, hall

TURN = 0.0173
"""Wall time of a turn [s]. Sixty of them are not a whole number of milliseconds."""

INPUTS: dict[int, dict[str, Any]] = {
    5: {"kind": "drive", "robot": "", "vx": 0.4, "wz": 0.3},
    30: {"kind": "add_obstacle", "x": 6.0, "y": 3.5, "radius": 0.3},
    40: {"kind": "move_obstacle", "name": "1", "x": 5.0, "y": 3.5, "yaw": 0.0},
    50: {"kind": "set_parameter", "robot": "", "name": "velocity_timeout", "value": "0.2"},
    60: {"kind": "drive", "robot": "", "vx": 1.0},
    90: {"kind": "set_pose", "robot": "", "x": 9.0, "y": 9.0, "yaw": 1.0},
    100: {"kind": "step", "seconds": 0.1},
    101: {"kind": "pause", "paused": False},
    110: {"kind": "remove_obstacle", "name": "1"},
    120: {"kind": "reset"},
    130: {"kind": "drive", "robot": "", "vx": -0.2, "wz": -1.0},
    160: {"kind": "add_fault", "text": "Drop('/scan', probability=0.5, seed=3)"},
    165: {"kind": "set_goal", "robot": "", "x": 6.0, "y": 6.0, "yaw": 1.0},
    170: {"kind": "save_state", "name": "on the way"},
    190: {"kind": "seed", "seed": 9},
    200: {"kind": "stop_fault", "number": 0},
    230: {"kind": "restore_state", "name": "on the way"},
    240: {"kind": "autopilot", "robot": "", "driver": "wander"},
    290: {"kind": "autopilot", "robot": ""},
}
"""Inputs by the number of the turn before which they arrive."""


def robot(**parameters: Any) -> mrs.Simulation:
    values = {"robot_radius": 0.2, "odometry_alphas": [0.1] * 6, "laser_frequency": 20.0, "laser_beam_count": 61}
    return mrs.Simulation(hall(), parameters={**values, **parameters}, seed=SEED, start=(3.0, 3.0, 0.0))


def live(folder: Path, **parameters: Any) -> Session:
    """Runs a session with inputs, and records it."""
    simulation = robot(**parameters)
    session = Session(simulation, Journal(), folder)
    frames, wall = FrameMaker(session), 100.0
    with Recorder(folder / "live") as recorder:
        simulation.record(recorder.write)
        for turn in range(300):
            if turn in INPUTS:
                session.do(read_input(INPUTS[turn]))
            wall += TURN
            session.turn(wall)
            frames.make()
        simulation.stop_recording(recorder.write)
    return session


@pytest.mark.parametrize("stamped", [False, True])
def test_the_script_repeats_the_session_byte_by_byte(tmp_path: Path, stamped: bool) -> None:
    session = live(tmp_path, cmd_vel_stamped=stamped)
    script: dict[str, Any] = {}
    exec(session.journal.to_python(session.now_ns), script)
    again = robot(cmd_vel_stamped=stamped)
    with Recorder(tmp_path / "again") as recorder:
        again.record(recorder.write)
        script["repeat"](again)
    assert again.time == session.simulation.time and again.pose == session.simulation.pose
    recordings = [tmp_path / name / "recording" / "recording.mcap" for name in ("live", "again")]
    assert recordings[0].read_bytes() == recordings[1].read_bytes()


def test_the_commands_are_a_file_for_run(tmp_path: Path) -> None:
    session = live(tmp_path)
    file = tmp_path / "commands.csv"
    file.write_text(session.journal.to_csv(""))
    rows = Script.read(file).rows
    assert {row[1:] for row in rows} >= {(0.4, 0.0, 0.3), (1.0, 0.0, 0.0), (-0.2, 0.0, -1.0), (0.0, 0.0, 0.0)}
    assert rows[-1][0] <= session.simulation.time


def test_a_journal_without_calls_is_a_script_that_runs() -> None:
    script: dict[str, Any] = {}
    exec(Journal().to_python(1_500_000_000), script)
    simulation = robot()
    script["repeat"](simulation)
    assert simulation.time == 1.5
