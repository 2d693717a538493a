"""Script: sends the commands of a file at their times."""

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.cli.commander import Commander
from mobile_robot_simulator.cli.script import Script


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


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "first line must be time,vx,vy,wz, got ''"),
        ("0,1,0,0\n", "first line must be time,vx,vy,wz, got '0,1,0,0'"),
        ("time,vx,vy,wz\n", "at least one command"),
        ("time,vx,vy,wz\n0,1,0\n", "line 2: must be four numbers, got '0,1,0'"),
        ("time,vx,vy,wz\n0,1,0,fast\n", "line 2: must be four numbers, got '0,1,0,fast'"),
        ("time,vx,vy,wz\n0,nan,0,0\n", "line 2: must be finite"),
        ("time,vx,vy,wz\n-1,0,0,0\n", "line 2: times must be at least 0 and increase, got -1.0"),
        ("time,vx,vy,wz\n1,0,0,0\n1,0,0,0\n", "line 3: times must be at least 0 and increase, got 1.0"),
    ],
)
def test_the_error_names_the_invalid_line(tmp_path, text, message):
    file = tmp_path / "commands.csv"
    file.write_text(text)
    with pytest.raises(ValueError, match=message) as error:
        Script.read(file)
    assert str(file) in str(error.value)
