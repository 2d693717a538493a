"""The pytest plugin, used as users use it: in a pytest process of its own, without a conftest."""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

pytest_plugins = "pytester"

ROOM = """
import numpy as np
import pytest
import mobile_robot_simulator as mrs
from mobile_robot_simulator.testing import assert_reaches

def room():
    cells = np.zeros((60, 60), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1)
"""

FAILING = """
def test_fails(simulation):
    sim = simulation(room(), start=(1.0, 1.0, 0.0), parameters={"velocity_timeout": 0, "laser_beam_count": 31})
    sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5)))
    assert_reaches(sim, (1.0, 5.0), within=3.0)
"""

PASSING = """
def test_passes(simulation):
    sim = simulation(room(), start=(1.0, 1.0, 0.0))
    sim.run_for(1.0)
"""


@pytest.fixture
def run(pytester: pytest.Pytester):
    def run(code: str, *options: str) -> pytest.RunResult:
        pytester.makepyfile(ROOM + code)
        return pytester.runpytest_subprocess("-p", "no:cacheprovider", "--basetemp=kept", *options, timeout=120)

    return run


def left(result: pytest.RunResult, what: str) -> list[Path]:
    """Returns the files of a kind, "recording" or "picture", that a report names."""
    return [Path(line.partition(": ")[2]) for line in result.outlines if line.startswith(f"{what}: ")]


def test_a_failure_reports_seed_command_recording_and_picture(run):
    result = run(FAILING, "--simulator-seed", "5")
    assert result.ret == 1
    out = result.stdout.str()
    assert "did not come within 0.3 m of (1, 5) in 3 s: it was never nearer than 4.000 m" in out
    assert "nearest: 4.000 m away, at (1.000, 1.000) at 0.000 s" in out
    assert "seed: 5" in result.outlines
    node = r"test_a_failure\S*py::test_fails"
    assert re.search(rf"^repeat with: pytest {node} --simulator-seed 5$", out, re.MULTILINE)
    (recording,), pictures = left(result, "recording"), left(result, "picture")
    assert (recording / "recording.mcap").stat().st_size > 1000
    assert {picture.read_bytes()[:4] for picture in pictures} == {b"\x89PNG"}
    assert recording.parent.parent.name == "test_fails0"


def test_a_passed_test_saves_nothing_unless_asked(run, pytester):
    assert run(PASSING).ret == 0
    assert not list(pytester.path.glob("kept/**/recording*"))
    assert run(PASSING, "--simulator-record", "always").ret == 0
    assert list(pytester.path.glob("kept/**/recording.mcap")) and list(pytester.path.glob("kept/**/drive.png"))


def test_never_saves_nothing_and_still_reports_the_seed(run, pytester):
    result = run(FAILING, "--simulator-record", "never")
    assert result.ret == 1 and "seed: 0" in result.outlines
    assert not list(pytester.path.glob("kept/**/recording*")) and not left(result, "picture")


def test_markers_replace_missing_arguments_and_the_command_line_takes_precedence(run):
    code = """
@pytest.mark.simulator(map=room(), seed=3, start=(2.0, 3.0, 0.5), parameters={"laser_beam_count": 7})
class TestMarked:
    def test_world(self, robot_world):
        assert tuple(robot_world.pose) == (2.0, 3.0, 0.5)
        assert robot_world.laser.parameters.seed == EXPECTED
        assert robot_world.laser.parameters.laser_beam_count == 7

    @pytest.mark.simulator(parameters={"laser_beam_count": 9})
    def test_nearer(self, simulation):
        sim = simulation(seed=4)
        assert sim.laser.parameters.laser_beam_count == 9 and sim.laser.parameters.seed == 4

    def test_robots(self, simulation):
        sim = simulation(robots=["one", "two"])
        assert list(sim.robots) == ["one", "two"] and tuple(sim.robots["one"].pose) != tuple(sim.robots["two"].pose)
"""
    run(code.replace("EXPECTED", "3")).assert_outcomes(passed=3)
    run(code.replace("EXPECTED", "8"), "--simulator-seed", "8").assert_outcomes(passed=3)


def test_floor_plans_are_generated(run):
    code = """
def test_plans(floor_plan, robot_world, simulation):
    plan = floor_plan("maze", seed=2)
    assert (plan.cells == floor_plan("maze", seed=2).cells).all()
    assert not np.array_equal(plan.cells, floor_plan("maze").cells)
    assert (robot_world.grid.cells == floor_plan("office").cells).all()
    assert simulation("cave", size=(20, 20)).grid.shape == floor_plan("cave", size=(20, 20)).shape
"""
    run(code).assert_outcomes(passed=1)


def test_simulations_are_closed_at_the_end(run):
    code = """
@pytest.fixture
def made():
    simulations = []
    yield simulations
    with pytest.raises(RuntimeError, match="closed"):  # torn down after the fixture simulation
        simulations[0].run_for(1.0)

def test_it(made, simulation):
    made.append(simulation(room(), start=(1, 1, 0)))
    made[0].run_for(1.0)
"""
    run(code).assert_outcomes(passed=1)


@pytest.mark.parametrize(
    ("marker", "message"),
    [("mop='x'", "takes the keywords map, parameters"), ("'office'", "got 'office'"), ("map='lost.yaml'", "lost.yaml")]
    + [
        (f"seed={seed}", f"must be an integer from 0 to 2**63 - 1, got {seed}")
        for seed in ("'x'", "-1", "True", "2.0", 2**63)
    ],
)
def test_bad_markers_are_refused(run, marker, message):
    result = run(f"@pytest.mark.simulator({marker})\ndef test_it(robot_world):\n    pass\n")
    out = result.stdout.str()
    assert result.ret == 1 and message in out
    assert "Traceback" not in out and "pytest_plugin.py" not in out and "simulation_factory.py" not in out


def test_bad_options_are_refused(run):
    assert "invalid" in run(PASSING, "--simulator-seed", "-3").stderr.str()
    assert "invalid choice" in run(PASSING, "--simulator-record", "sometimes").stderr.str()


def test_an_expected_failure_saves_nothing(run, pytester):
    run("@pytest.mark.xfail\n" + FAILING.lstrip()).assert_outcomes(xfailed=1)
    assert not list(pytester.path.glob("kept/**/recording*"))


def test_workers_of_xdist_save_the_same_recording(run):
    pytest.importorskip("xdist")
    (recording,) = left(run(FAILING + PASSING), "recording")
    alone = (recording / "recording.mcap").read_bytes()
    spread = run(FAILING + PASSING, "-n", "2")
    (recording,) = left(spread, "recording")
    spread.assert_outcomes(passed=1, failed=1)
    assert "popen-gw" in str(recording) and (recording / "recording.mcap").read_bytes() == alone


def test_a_failure_without_the_extras_says_what_is_missing(run):
    code = (
        """
import sys
for name in ("rosbags", "matplotlib"):
    sys.modules[name] = None
"""
        + FAILING
    )
    result = run(code)
    result.assert_outcomes(failed=1)
    assert any(line.startswith("no recording: recordings need rosbags") for line in result.outlines)
    assert any(line.startswith("no picture: ") for line in result.outlines)


def test_the_plugin_imports_no_dependencies_before_they_are_needed(run):
    code = """
import subprocess, sys

def test_lazy():
    code = "import sys, pytest; before = set(sys.modules); import mobile_robot_simulator.testing.pytest_plugin; "
    code += "print(sorted({name.partition('.')[0] for name in set(sys.modules) - before}))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert "pydantic" not in loaded and "PIL" not in loaded and "yaml" not in loaded and "matplotlib" not in loaded
"""
    run(code).assert_outcomes(passed=1)


def test_the_command_repeats_the_failure_from_where_pytest_was_called(pytester):
    code = ROOM + FAILING + "    assert sim.seed == 1\n"
    code = code.replace("def test_fails", '@pytest.mark.parametrize("name", ["it\'s [a] b"])\ndef test_fails').replace(
        "(simulation):", "(simulation, name):"
    )
    folder = pytester.mkdir("deep")
    (folder / "test_deep.py").write_text(code, encoding="utf-8")
    pytester.makeini("[pytest]\n")
    for where, path, options in ((pytester.path, "deep/test_deep.py", []), (folder, "test_deep.py", ["-n", "1"])):
        os.chdir(where)
        result = pytester.runpytest_subprocess("-p", "no:cacheprovider", "--simulator-seed", "3", *options, timeout=120)
        (command,) = (line for line in result.outlines if line.startswith("repeat with: pytest "))
        words = shlex.split(command.removeprefix("repeat with: pytest "))
        assert words[0].startswith(f"{path}::test_fails[")
        again = pytester.runpytest_subprocess(*words, timeout=120)
        again.assert_outcomes(failed=1)
        assert command in again.outlines


def test_a_failure_with_a_floor_plan_only_reports_its_seed(run):
    result = run("def test_plan(floor_plan):\n    assert floor_plan('maze') is None\n", "--simulator-seed", "5")
    assert "seed: 5" in result.outlines and any(line.endswith("::test_plan --simulator-seed 5") for line in result.outlines)


def test_seeds_that_a_test_passes_itself_are_reported(run):
    code = """
def test_fails(simulation):
    for seed in (0, 7, 8):
        simulation(room(), seed=seed)
    assert False
"""
    assert "seed: 0; the test also uses seeds of its own: 7, 8" in run(code, "--simulator-record", "never").outlines


def test_floor_plans_have_the_kind_of_the_marker(run):
    code = """
@pytest.mark.simulator(map="maze", size=(10.0, 9.0), seed=4)
def test_maze(floor_plan):
    maze = mrs.floor_plan("maze", size=(10.0, 9.0), seed=4)
    assert np.array_equal(floor_plan().cells, maze.cells)
    assert not np.array_equal(floor_plan("cave").cells, maze.cells)
"""
    run(code).assert_outcomes(passed=1)


def test_start_poses_have_room_for_footprints(run):
    # If poses were drawn for a radius of 0.3 m and separately, several of these would be inside walls or other robots.
    code = """
@pytest.mark.parametrize("seed", range(20))
def test_big(simulation, seed):
    sim = simulation("office", seed=seed, parameters={"footprint": [[-0.6, -0.2], [0.6, -0.2], [0.6, 0.2], [-0.6, 0.2]]})
    assert sim.truth.clearance > 0.0

@pytest.mark.parametrize("seed", range(40))
def test_many(simulation, seed):
    sim = simulation("maze", seed=seed, size=(8.0, 8.0), robots=["one", "two", "three", "four", "five"])
    assert all(robot.truth.clearance > 0.0 for robot in sim.robots.values())

def test_too_many(simulation):
    with pytest.raises(ValueError, match="no start pose was found for robot .* beside r0, r1, r2"):
        simulation("maze", size=(8.0, 8.0), robots=[f"r{number}" for number in range(200)])
"""
    run(code).assert_outcomes(passed=61)


def test_bad_arguments_of_the_factory_are_refused(run):
    code = """
import os
import re
import shlex

@pytest.mark.parametrize(("map", "options", "error", "message"), [
    (None, {"sise": 3}, TypeError, "simulation takes map, parameters, seed, start, robots, size, resolution, got sise"),
    (room(), {"size": (9, 9)}, ValueError, "size can be given for a generated floor plan only"),
    ("ofice", {}, FileNotFoundError, "no such kind of floor plan (office, corridor, maze"),
    ("ofice", {}, FileNotFoundError, "did you mean 'office'?"),
    ("lost.yaml", {}, FileNotFoundError, "there is no such map file"),
    (None, {"robots": ["one", "one"]}, ValueError, "robots must be a list of different names"),
    (None, {"robots": "one"}, ValueError, "robots must be a list of different names, got 'one'"),
    (room(), {"robots": {"one": (1, 1, 0)}, "start": (1, 1, 0)}, ValueError, "start and robots must not both be given"),
])
def test_refused(simulation, map, options, error, message):
    with pytest.raises(error, match=re.escape(message)):
        simulation(map, **options)

@pytest.mark.simulator(map=room(), start=(1, 1, 0))
def test_robots_take_precedence_over_a_marked_start(simulation):
    assert list(simulation(robots={"one": (2, 2, 0)}).robots) == ["one"]

@pytest.mark.simulator(map=room(), robots=["one"])
def test_a_start_takes_precedence_over_marked_robots(simulation):
    assert list(simulation(start=(2, 2, 0)).robots) == [""]
"""
    run(code).assert_outcomes(passed=10)


def test_the_junit_report_has_the_seed_and_the_saved_files(run, pytester):
    run(FAILING + PASSING, "--simulator-seed", "5", "--junit-xml=report.xml")
    report = (pytester.path / "report.xml").read_text()
    assert report.count('<property name="simulator_seed" value="5"') == 2
    assert re.search(r'<property name="simulator_recording" value="\S*recording"', report)
    assert re.search(r'<property name="simulator_picture" value="\S*\.png"', report)
