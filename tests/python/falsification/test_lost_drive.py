"""LostDrive: a search whose process is killed says which drive it was and how to repeat it, and the repetition dies too."""

from __future__ import annotations

import ast
import json
import os
import shlex
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from falsification import deadly
from falsification.crossing import SPACE
from mobile_robot_simulator.falsification import (
    Counterexample,
    LostDrive,
    compare_controllers,
    estimate,
    falsify,
    load_world,
    run_drive,
)
from mobile_robot_simulator.falsification.samplers import sampler
from mobile_robot_simulator.requirements import always, clearance
from mobile_robot_simulator.scenarios import Moving, World, WorldMap

HERE = Path(__file__).parent


def first_deadly_drive():
    points = sampler("random", len(SPACE.dimensions), 0).ask()
    worlds = [SPACE.world(point) for point in points]
    number = next(number for number, world in enumerate(worlds, 1) if len(world.obstacles) == 3)
    return number, worlds[number - 1]


@pytest.mark.slow
@pytest.mark.parametrize(("controller", "code"), [(deadly.Killed, -signal.SIGKILL), (deadly.Exiting, 7)])
def test_the_drive_is_named(controller, code, tmp_path):
    number, world = first_deadly_drive()
    ended = "was killed by SIGKILL, as when memory is used up" if code < 0 else "ended with exit code 7"
    start = f"the process of drive {number} {ended} before the drive was over; repeat the drive with: "
    for search in (falsify, estimate):
        with pytest.raises(LostDrive) as caught:
            # With one drive at a time, it is the first one that dies.
            search(controller, SPACE, deadly.requirement, number, processes=2)
        assert str(caught.value).startswith(start) and caught.value.exit_code == code and caught.value.world == world
        text = str(caught.value).partition("where text = ")[2]
        assert World.from_json(ast.literal_eval(text)) == world
    with pytest.raises(LostDrive) as caught:
        compare_controllers(controller, controller, SPACE, deadly.requirement, number, processes=2)
    assert caught.value.world == world
    with pytest.raises(LostDrive) as caught:
        falsify(controller, SPACE, deadly.requirement, number, processes=2, corpus=tmp_path)
    (file,) = tmp_path.glob("*/world.json")
    case = os.path.relpath(deadly.__file__)
    shown = f"run_drive(load_world({str(file)!r}), controller, requirement)"
    if controller is deadly.controller:
        shown = f"mobile-robot-simulator falsify {case} --repeat {os.path.relpath(file)}"
    assert load_world(file) == world and str(caught.value) == start + shown


@pytest.mark.slow
def test_a_failure_that_was_being_shrunk_is_saved(tmp_path):
    space = replace(SPACE, obstacles=Moving(6, at_least=6, from_start=0.1))
    arguments = deadly.DyingAlone, space, always(clearance > 0.0), 60
    with pytest.raises(LostDrive, match="the failure that was being shrunk is in") as caught:
        falsify(*arguments, processes=2, corpus=tmp_path)
    lost = caught.value
    assert lost.number is None and lost.world.obstacles == () and lost.exit_code == 7
    assert (lost.failure / "drive.png").exists() and str(lost.failure) in str(lost)
    saved = Counterexample.load(lost.failure / "counterexample.json")
    assert len(saved.world.obstacles) > 1 and list(Counterexample.all_in(tmp_path)) == [saved]
    drive, is_same = saved.repeat(*(arguments[0], arguments[2]))
    assert drive.failed and is_same
    with pytest.raises(LostDrive) as caught:
        falsify(*arguments, processes=2)
    assert caught.value.failure is None


@pytest.mark.slow
def test_the_command_repeats_the_drive(tmp_path):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(mrs.__file__).parents[1]), str(HERE.parent)])}

    def run(*command):
        command = [sys.executable, "-m", "mobile_robot_simulator", *command]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300)

    case = tmp_path / "deadly_case.py"
    text = (HERE / "deadly.py").read_text()
    case.write_text(text)
    found = run("falsify", "deadly_case.py", "--processes", "2")
    number, world = first_deadly_drive()
    assert found.returncode == 1, found.stdout + found.stderr
    start = f"error: the process of drive {number} ended with exit code 7 before the drive was over; repeat the drive with: "
    shown = found.stderr.lstrip()
    assert shown.startswith(f"{start}mobile-robot-simulator falsify deadly_case.py --repeat counterexamples/")
    command = shlex.split(shown.removeprefix(start))[1:]
    assert load_world(tmp_path / command[-1]) == world
    assert run(*command).returncode == 7
    case.write_text(text.replace("os._exit(7)", "pass"))
    repaired = run(*command)
    assert repaired.returncode == 0 and repaired.stdout.startswith("holds: "), repaired.stdout + repaired.stderr


def test_sys_exit_is_a_violation():
    _, world = first_deadly_drive()
    drive = run_drive(world, deadly.Quitting, deadly.requirement)
    assert drive.failed and (drive.ending, drive.error) == ("error", "SystemExit: 7")


def test_the_world_has_a_map_file_relative_to_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mrs.save_map(WorldMap(size=(4.0, 4.0)).grid(), "map.yaml")
    lost = LostDrive(World(WorldMap("map.yaml"), (1.0, 1.0, 0.0)), None, 1).saved(Path("corpus"), None)
    assert str(lost).startswith("the process of a drive ended with exit code 1 before the drive was over; ")
    (file,) = tmp_path.glob("corpus/*/world.json")
    assert json.loads(file.read_text())["map"]["kind"] == "../../map.yaml" and f"{file.name}" in str(lost)
    monkeypatch.chdir("/")
    assert load_world(file).map.kind == str((tmp_path / "map.yaml").resolve())
    assert load_world(file).map.grid().shape == (80, 80)
