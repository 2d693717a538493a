"""The command line: errors, usage and version."""

import numpy as np
import pytest

import mobile_robot_simulator as mrs

pytestmark = pytest.mark.slow

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")
pytest.importorskip("matplotlib", reason="the extra `plotting` is not installed")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nowhere.yaml"], "error: nowhere.yaml: no such file or directory\n"),
        (["info", "."], "error: .: must be a regular file, got a folder\n"),
        (["falsify", "nowhere.py"], "error: nowhere.py: no such file or directory\n"),
        (["falsify", "."], "error: .: must be a regular file, got a folder\n"),
        (["run", "{room}", "--duration", "nan"], "--duration must be positive and finite, got nan"),
        (["run", "{room}", "--duration", "0"], "--duration must be positive and finite, got 0"),
        (["run", "{room}", "--radius", "-1"], "--radius must be positive"),
        (["run", "{room}", "--radius", "9"], "no known free place for a disc of radius 9 m"),
        (["run", "{room}", "--start", "0.01", "0.01", "0"], "start must not be inside a wall, got (0.01, 0.01, 0.0)"),
        (["run", "{room}", "--start", "nan", "1", "0"], "error: --start: x must be finite, got NaN"),
        (["run", "{room}", "--seed", "-1"], "seed must be in 0..2**64 - 1, got -1"),
        (["run", "{room}", "--commands", "nowhere.csv"], "nowhere.csv"),
        (["run", "{room}", "-p", "laser_beam:=3"], "did you mean 'laser_beam_count'"),
        (["run", "{room}", "-p", "laser_beam_count=3"], "name:=value"),
        (["run", "{room}", "-p", "laser_beam_count:=0"], "laser_beam_count must be greater than or equal to 1, got 0"),
        (["run", "{room}", "-p", "publish_rate:=fast"], "publish_rate must be a valid number"),
        (["run", "{room}", "-p", "laser_max_range:=0.01"], "laser_min_range must be less than laser_max_range 0.01"),
        (["scan", "{room}", "--pose", "inf", "0", "0"], "error: --pose: x must be finite, got inf"),
        (["parameters", "--params-file", "nowhere.yaml"], "nowhere.yaml"),
        (["floor-plan", "plan.yaml", "--kind", "ofice"], "office"),
    ],
)
def test_bad_input_prints_an_error_and_writes_nothing(command, room, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    done = command(*(argument.format(room=room) for argument in arguments))
    assert done.returncode == 1, done.stdout
    assert message in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "drive").exists() and not (tmp_path / "plan.yaml").exists()


def test_wrong_usage_exits_with_status_2(command, room):
    assert command("run").returncode == 2
    assert command("fly", room).returncode == 2
    assert command("--version").stdout.strip() == mrs.__version__


def test_a_warning_is_one_line_without_code(command, tmp_path):
    cells = np.full((40, 40), -1, np.int8)
    mrs.save_map(mrs.OccupancyGrid(cells, resolution=0.1), tmp_path / "unknown.yaml")
    arguments = ("run", tmp_path / "unknown.yaml", "--duration", 1, "--out", tmp_path / "drive")
    done = command(*arguments, "--start", 1, -5, 0)
    assert done.returncode == 0
    lines = [line for line in done.stderr.splitlines() if line]  # the progress bar leaves an empty one
    assert lines == ["warning: start (1, -5) is off the map, where there is nothing to touch and nothing to see"]
    assert "unknown:=occupied" not in done.stdout  # the robot is in no unknown cell
    assert "unknown:=occupied" in command(*arguments, "--overwrite", "--start", 1, 1, 0).stdout
