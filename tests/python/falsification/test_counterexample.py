"""Counterexample: what is saved repeats the drive byte by byte, with the command and with the test."""

from __future__ import annotations

import ast
import json
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from falsification.crossing import SPACE, Halting, controller, requirement
from mobile_robot_simulator.falsification import Counterexample, falsify
from mobile_robot_simulator.scenarios import WorldMap

HERE = Path(__file__).parent
CASE = """
from mobile_robot_simulator.requirements import always, clearance
from mobile_robot_simulator.scenarios import Moving, Space, WorldMap


def controller(sim):
    return lambda seen: (0.5, 0.0)


requirement = always(clearance > 0.0)
space = Space(
    [WorldMap("room", size=(6.0, 6.0), resolution=0.1)],
    start=(1.0, 3.0, 0.0),
    goal=None,
    obstacles=Moving(4),
    parameters={"robot_radius": 0.25, "laser_beam_count": 11},
    duration=3.0,
)
"""
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(mrs.__file__).parents[1])}


@pytest.fixture
def saved(tmp_path):
    return falsify(controller, SPACE, requirement, 200, corpus=tmp_path).counterexample


def run(folder, *command):
    return subprocess.run(
        [sys.executable, "-m", *command], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, timeout=300
    )


def test_the_folder_has_everything(saved):
    names = {path.name for path in saved.folder.iterdir()}
    assert names == {"counterexample.json", "drive.png", "recording", f"test_counterexample_{saved.world.name}.py"}
    assert (saved.folder / "drive.png").read_bytes().startswith(b"\x89PNG")
    assert (saved.folder / "recording" / "recording.mcap").stat().st_size > 1000
    assert Counterexample.load(saved.folder / "counterexample.json") == saved


def test_its_folder_stays_the_same_if_the_working_directory_changes(tmp_path, monkeypatch, saved):
    monkeypatch.chdir(saved.folder)
    loaded = Counterexample.load("counterexample.json")
    monkeypatch.chdir("recording")
    assert loaded == saved

    def wandering(sim):
        os.chdir(tmp_path / "elsewhere")
        return controller(sim)

    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    found = falsify(wandering, SPACE, requirement, 200, corpus="corpus").counterexample
    assert found.folder.parent == tmp_path / "corpus"
    assert list((tmp_path / "elsewhere").iterdir()) == []


def test_it_repeats_byte_by_byte(saved):
    drive, is_same = saved.repeat(controller, requirement)
    assert is_same and drive.failed and drive.robustness == saved.robustness
    drive, is_same = saved.repeat(Halting, requirement)
    assert not is_same and not drive.failed


def test_a_changed_world_that_cannot_be_simulated_is_an_error_with_the_file(saved):
    file = saved.folder / "counterexample.json"
    for changes in ({"seed": "x"}, {"parameters": {"laser_beam_count": "many"}}, {"faults": ["Fire()"]}):
        values = json.loads(file.read_text())
        values["world"].update(changes)
        changed = file.with_name("changed.json")
        changed.write_text(json.dumps(values))
        with pytest.raises(ValueError, match=r"counterexample\.json: not a world that can be simulated: "):
            Counterexample.load(changed).repeat(controller, requirement)


def test_the_recording_is_the_same_when_it_is_found_again(saved, tmp_path_factory):
    again = falsify(controller, SPACE, requirement, 200, corpus=tmp_path_factory.mktemp("again")).counterexample
    files = [path / "recording" / "recording.mcap" for path in (saved.folder, again.folder)]
    assert files[0].read_bytes() == files[1].read_bytes() and saved.digest == again.digest


@pytest.mark.slow
def test_the_command_and_the_test_repeat_the_drive(tmp_path):
    (tmp_path / "straight_case.py").write_text(CASE)
    found = run(tmp_path, "mobile_robot_simulator", "falsify", "straight_case.py", "--processes", "2")
    assert found.returncode == 2, found.stdout + found.stderr
    command = found.stdout.splitlines()[-1].removeprefix("repeat with: mobile-robot-simulator ")
    again = run(tmp_path, "mobile_robot_simulator", *shlex.split(command))
    assert again.returncode == 2 and "the same bytes as when it was found" in again.stdout, again.stdout + again.stderr
    known = run(tmp_path, "mobile_robot_simulator", "falsify", "straight_case.py")
    assert known.returncode == 2 and "1 known counterexamples still fail" in known.stdout
    test = ("pytest", "-q", "-p", "no:cacheprovider", "counterexamples")
    failed = run(tmp_path, *test)
    assert failed.returncode == 1 and "the same bytes as when it was found" in failed.stdout, failed.stdout
    (tmp_path / "straight_case.py").write_text(CASE.replace("0.5, 0.0)", "0.0, 0.0)"))
    repaired = run(tmp_path, *test)
    assert repaired.returncode == 0, repaired.stdout + repaired.stderr


@pytest.mark.slow
def test_the_command_repeats_a_drive_that_fails_because_of_a_push(tmp_path):
    shutil.copy(HERE / "windy.py", tmp_path)
    found = run(tmp_path, "mobile_robot_simulator", "falsify", "windy.py")
    assert found.returncode == 2, found.stdout + found.stderr
    (file,) = tmp_path.glob("counterexamples/*/counterexample.json")
    assert any(fault.startswith("Push(") for fault in Counterexample.load(file).world.faults)
    command = found.stdout.splitlines()[-1].removeprefix("repeat with: mobile-robot-simulator ")
    again = run(tmp_path, "mobile_robot_simulator", *shlex.split(command))
    assert again.returncode == 2 and "the same bytes as when it was found" in again.stdout, again.stdout + again.stderr


@pytest.mark.slow
def test_a_map_file_with_a_relative_path_is_found_from_any_folder(tmp_path):
    project, elsewhere = tmp_path / "project", tmp_path / "else" / "where"
    for folder in (project / "maps", project / "cases", elsewhere):
        folder.mkdir(parents=True)
    mrs.save_map(WorldMap("room", size=(6.0, 6.0), resolution=0.1).grid(), project / "maps" / "room.yaml")
    text = CASE.replace('WorldMap("room", size=(6.0, 6.0), resolution=0.1)', 'WorldMap("maps/room.yaml")')
    (project / "cases" / "mapped_case.py").write_text(text)
    found = run(project, "mobile_robot_simulator", "falsify", "cases/mapped_case.py", "--corpus", "cases/found")
    assert found.returncode == 2, found.stdout + found.stderr
    (file,) = project.glob("cases/found/*/counterexample.json")
    assert json.loads(file.read_text())["world"]["map"]["kind"] == "../../../maps/room.yaml"
    command = found.stdout.splitlines()[-1].removeprefix("repeat with: mobile-robot-simulator ")
    again = run(project, "mobile_robot_simulator", *shlex.split(command))
    assert again.returncode == 2 and "the same bytes as when it was found" in again.stdout, again.stdout + again.stderr
    project = project.rename(tmp_path / "moved")
    (file,) = project.glob("cases/found/*/counterexample.json")
    case = os.path.relpath(project / "cases" / "mapped_case.py", elsewhere)
    again = run(elsewhere, "mobile_robot_simulator", "falsify", case, "--repeat", os.path.relpath(file, elsewhere))
    assert again.returncode == 2 and "the same bytes as when it was found" in again.stdout, again.stdout + again.stderr
    failed = run(elsewhere, "pytest", "-q", "-p", "no:cacheprovider", str(file.parent))
    assert failed.returncode == 1 and "the same bytes as when it was found" in failed.stdout, failed.stdout + failed.stderr
    recordings = [file.parent / "recording" / "recording.mcap"]
    known = run(project, "mobile_robot_simulator", "falsify", "cases/mapped_case.py", "--corpus", "cases/new")
    assert known.returncode == 2
    recordings += project.glob("cases/new/*/recording/recording.mcap")
    first, second = recordings
    assert first.read_bytes() == second.read_bytes() and first.parents[1].name == second.parents[1].name


def test_a_test_can_be_read_whatever_the_error_says(tmp_path):
    error = r'''cannot open C:\Users\x """ end"'''
    fails = f"def controller(sim):\n    raise OSError({error!r})\n"
    (tmp_path / "failing_case.py").write_text(
        CASE.replace("def controller(sim):\n    return lambda seen: (0.5, 0.0)\n", fails)
    )
    found = run(tmp_path, "mobile_robot_simulator", "falsify", "failing_case.py", "--budget", "1")
    assert found.returncode == 2 and "Users" in found.stdout, found.stdout + found.stderr
    (test,) = tmp_path.glob("counterexamples/*/test_*.py")
    assert error in ast.get_docstring(ast.parse(test.read_text()))


def test_a_controller_without_a_file_gets_no_test(tmp_path):
    def unnamed(sim):
        return lambda seen: (0.5, 0.0)

    found = falsify(unnamed, SPACE, requirement, 200, corpus=tmp_path)
    assert found.counterexample.case is None and found.counterexample.command == ""
    assert [note.partition(":")[0] for note in found.notes] == ["no test"]
    with pytest.raises(ValueError, match="names no file with a controller"):
        found.counterexample.check()


def test_a_controller_that_does_not_repeat_is_noticed(tmp_path):
    calls = []

    def forgetful(sim):
        calls.append(sim)
        return lambda seen: (0.5 if len(calls) < 3 else 0.4, 0.0)

    found = falsify(forgetful, SPACE, ~requirement, 1, corpus=tmp_path, is_shrunk=False)
    assert found.failed
    found = falsify(forgetful, SPACE, ~requirement, 1, corpus=tmp_path / "new", is_shrunk=False)
    assert not any("does not repeat" in note for note in found.notes)


@pytest.mark.parametrize("text", ["", "[]", "{}", "null"])
def test_what_is_no_counterexample_is_refused(tmp_path, text, saved):
    file = tmp_path / "counterexample.json"
    file.write_text(text)
    with pytest.raises(ValueError, match=r"counterexample\.json: not a counterexample: "):
        Counterexample.load(file)
    values = json.loads((saved.folder / "counterexample.json").read_text())
    file.write_text(json.dumps({**values, "world": {}}))
    with pytest.raises(ValueError, match="not a world"):
        Counterexample.load(file)
    with pytest.raises(FileNotFoundError):
        Counterexample.load(tmp_path / "missing.json")
