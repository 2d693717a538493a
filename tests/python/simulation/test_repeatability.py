"""A seeded run always gives the same recording, byte for byte: in one process, in others, and with any number of threads."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.recording.recorder import Recorder

SEED = 3


def simulation(seed: int = SEED, *, has_faults: bool = True) -> mrs.Simulation:
    """Returns a simulation with everything that is random: noise, drift and faults. Two robots and an obstacle move."""
    grid = mrs.floor_plan("office", seed=1, size=(12.0, 10.0))
    first, second = (grid.draw_free_pose(radius=0.5, seed=number) for number in (1, 2))
    sim = mrs.Simulation(
        grid,
        parameters={"z_rand": 0.05, "contact": "slide", "odometry_alphas": (0.1,) * 6, "velocity_timeout": 0.0},
        seed=seed,
        robots={"one": first, "two": second},
    )
    sim.add_obstacle(mrs.Shape.disc(0.3), [(0.0, *first), (10.0, *second)])
    if has_faults:
        sim.add_fault(faults.Drop("/one/scan", probability=0.2, seed=seed))
        sim.add_fault(faults.Delay("/two/odom", 0.01, jitter=0.2, seed=seed))
    for name in sim.robots:
        sim.publish(
            f"/{name}/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5), angular=mrs.messages.Vector3(z=0.2))
        )
    return sim


def test_a_message_that_is_read_late_is_the_same_as_one_that_is_recorded() -> None:
    """While nobody receives a message, it is built when it is read. By then the robot has moved on."""
    grid = mrs.floor_plan("office", seed=1, size=(12.0, 10.0))
    start = grid.draw_free_pose(radius=0.5, seed=1)
    read, recorded = (
        mrs.Simulation(
            grid,
            start=start,
            parameters={"odometry_alphas": (0.1,) * 6, "velocity_timeout": 0.0, "ground_truth_frame": "true_base"},
            seed=SEED,
        )
        for _ in range(2)
    )
    messages: dict[str, mrs.messages.Message] = {}
    recorded.record(lambda topic, message, time_ns: messages.update({topic: message}))
    for sim in (read, recorded):
        drive = mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5), angular=mrs.messages.Vector3(z=0.3))
        sim.publish("/cmd_vel", drive)
        sim.run_for(1.0)
        sim.robot.slip(0.5)
        sim.run_for(2.051)
        sim.set_pose(grid.draw_free_pose(radius=0.5, seed=2))
        sim.robot.stop()
        sim.laser.stop()
    assert len(messages) > 4
    for name in ("/odom", "/scan", "/tf", "/clock"):
        assert read.latest(name) == messages[name], name


def test_messages_that_are_built_after_the_drive_are_the_same_as_those_that_are_recorded() -> None:
    """All topics of two robots, with noise and slip, and with changes of parameters on the way."""
    recorded: list[tuple[str, mrs.messages.Message, int]] = []
    kept: list[tuple[str, Any, int]] = []
    for is_lazy in (False, True):
        sim = simulation(has_faults=False)
        if is_lazy:
            sim.record_lazily(lambda *sent: kept.append(sent))
        else:
            sim.record(lambda *sent: recorded.append(sent))
        sim.run_for(1.0)
        first = sim.named("one")
        first.robot.slip(0.5)
        first.robot.set_parameters(odom_frame_id="other", odometry_alphas=(0.1,) * 6)
        first.laser.set_parameters(laser_min_range=0.5, no_return="max")
        sim.run_for(1.0)
    assert sum(isinstance(message, partial) for _, message, _ in kept) > 0.3 * len(kept) > 30
    built = [(topic, message() if isinstance(message, partial) else message, time_ns) for topic, message, time_ns in kept]
    assert built == recorded


def recording(sim: mrs.Simulation, folder: Path, seconds: float = 6.0) -> str:
    """Records a simulation for a while. Returns the digest of the recording."""
    with Recorder(folder) as recorder:
        sim.record(recorder.write)
        sim.run_for(seconds)
        sim.stop_recording(recorder.write)
    data = (recorder.path / "recording.mcap").read_bytes()
    assert len(data) > 100_000
    return hashlib.sha256(data).hexdigest()


def test_two_runs_in_one_process_are_equal(tmp_path):
    first = recording(simulation(), tmp_path / "first")
    assert recording(simulation(), tmp_path / "second") == first
    assert recording(simulation(SEED + 1), tmp_path / "third") != first


@pytest.mark.parametrize("threads", [1, 8])
def test_runs_in_other_processes_with_other_numbers_of_threads_are_equal(tmp_path, threads):
    script = (
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); "
        "from pathlib import Path; import test_repeatability as t; "
        f"print(t.recording(t.simulation(), Path({str(tmp_path)!r}) / 'other'))"
    )
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads), "PYTHONHASHSEED": str(threads)}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == recording(simulation(), tmp_path / "here")


def test_runs_after_a_restore_are_equal(tmp_path):
    through = simulation()
    through.run_for(2.5)
    expected = recording(through, tmp_path / "through")
    sim = simulation()
    sim.run_for(2.5)
    state = sim.save()
    for number in range(2):
        assert recording(sim, tmp_path / f"again-{number}") == expected
        sim.restore(state)
