"""Script: sends the commands of a file at their times."""

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.commander import Commander
from mobile_robot_simulator.drivers.script import Script


def open_floor() -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(np.zeros((200, 200), np.int8), resolution=0.1)


def commands_of(script: Script, duration: float) -> list[tuple[float, float]]:
    simulation = mrs.Simulation(open_floor())
    sent: list[tuple[float, float]] = []
    simulation.subscribe("/cmd_vel", mrs.messages.Twist, lambda twist: sent.append((simulation.time, twist.linear.x)))
    node = simulation.create_node("driver")
    script.start(node, Commander(node, "/cmd_vel", stamped=False))
    simulation.run_for(duration)
    return sent


def test_a_script_sends_each_command_at_its_time_and_repeats_it():
    sent = commands_of(Script(((0.0, 0.5, 0.0, 0.0), (0.25, 1.0, 0.0, 0.0))), 0.45)
    assert sent == [(0.0, 0.5), (0.1, 0.5), (0.2, 0.5), (0.25, 1.0), (0.3, 1.0), (0.4, 1.0)]


def test_a_script_holds_a_command_past_the_velocity_timeout():
    simulation = mrs.Simulation(open_floor(), start=(5.0, 5.0, 0.0))
    node = simulation.create_node("driver")
    script = Script(((0.0, 1.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0)))
    script.start(node, Commander(node, "/cmd_vel", stamped=False))
    simulation.run_for(4.0)
    assert tuple(simulation.pose) == pytest.approx((7.0, 5.0, 0.0), abs=1e-12)


def test_a_script_is_read_from_csv(tmp_path):
    file = tmp_path / "commands.csv"
    file.write_text("time,vx,vy,wz\n0,0.5,0,0\n\n1.5,0,0,-1e-1\n")
    assert Script.read(file).rows == ((0.0, 0.5, 0.0, 0.0), (1.5, 0.0, 0.0, -0.1))


TABLE = "time,vx,vy,wz\n0,0.5,0,0\n1.5,0,0,-0.1\n"


@pytest.mark.parametrize(
    "data",
    [
        TABLE.encode("utf-8-sig"),
        TABLE.encode("utf-16"),
        TABLE.replace("\n", "\r\n").encode(),
        TABLE.replace(",", ";").encode(),
        TABLE.replace(",", ";").replace(".", ",").encode(),
        TABLE.replace(",", "\t").replace(".", ",").encode("utf-16"),
        b"wz,note,TIME,vy,vx\n0,go,0,0,0.5\n-0.1,turn,1.5,0,0\n",
    ],
    ids=["byte order mark", "UTF-16", "Windows", "semicolons", "decimal commas", "spreadsheet", "other columns"],
)
def test_tables_of_spreadsheets_are_read(tmp_path, data):
    file = tmp_path / "commands.csv"
    file.write_bytes(data)
    script = Script.read(file)
    assert script.rows == ((0.0, 0.5, 0.0, 0.0), (1.5, 0.0, 0.0, -0.1)) and script.origin == 0.0


def test_a_note_says_how_many_commands_come_after_the_drive(tmp_path):
    file = tmp_path / "commands.csv"
    file.write_text(TABLE)
    script = Script.read(file)
    assert script.notes(1.0) == ["1 of 2 commands come after the drive of 1 s"] and script.notes(2.0) == []


def test_stamps_of_a_clock_count_from_the_first_row(tmp_path):
    file = tmp_path / "commands.csv"
    file.write_text("time,vx,vy,wz\n1700000000.5,0.5,0,0\n1700000002.5,0,0,-0.1\n")
    script = Script.read(file)
    assert script.notes(3.0) == ["the times are stamps of a clock, so they count from the first row, 1700000000.5 s"]
    assert script.rows == ((0.0, 0.5, 0.0, 0.0), (2.0, 0.0, 0.0, -0.1)) and script.origin == 1700000000.5


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "at least one command, got none"),
        ("0,1,0,0\n", "line 1: the first line must name each of the columns time, vx, vy, wz once, got '0,1,0,0'"),
        ("time,vx,vx,vy,wz\n0,1,0,0,0\n", "name each of the columns"),
        ("time,vx,vy,wz\n", "at least one command"),
        ("time,vx,vy,wz\n0,1,0\n", "line 2: must have 4 values, as the first line, got 3: '0,1,0'"),
        ("time,vx,vy,wz\n0,0,5,0,0\n", "got 5: '0,0,5,0,0'; numbers with decimal commas need semicolons between them"),
        ("time,vx,vy,wz\n0,1,0,fast\n", "line 2, column wz: must be a finite number, got 'fast'"),
        ("time,vx,vy,wz\n0,nan,0,0\n", "line 2, column vx: must be a finite number, got 'nan'"),
        ("time,vx,vy,wz\n0,1e4,0,0\n", "line 2, column vx: must be from -1000 to 1000, got '1e4'"),
        ("time,vx,vy,wz\n-1,0,0,0\n", "line 2, column time: must be seconds, at least 0"),
        ("time,vx,vy,wz\n1,0,0,0\n1,0,0,0\n", "line 3, column time: must be above 1.0, the time before, got 1.0"),
    ],
)
def test_the_error_names_the_invalid_line(tmp_path, text, message):
    file = tmp_path / "commands.csv"
    file.write_text(text)
    with pytest.raises(ValueError) as error:
        Script.read(file)
    assert message in str(error.value) and str(file) in str(error.value)
