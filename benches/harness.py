"""Benchmarks of simulations: a drive, a recorded drive, the start of a new simulation, and twenty robots.

Run: python benches/harness.py [--json FILE]. Each figure is the shortest time of a few runs in one process. The simulator
uses one thread. Processor time is printed beside wall time, because it is more reliable on a busy machine. Each benchmark
also checks its result: that the whole drive took place, and that robots see one another.
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

import mobile_robot_simulator as mrs

SEED = 1


class Figure(NamedTuple):
    """Duration of a benchmark: wall time and processor time [s]."""

    wall: float
    processor: float


class Stopwatch:
    """Measures the time since it was created."""

    def __init__(self) -> None:
        self._wall, self._processor = time.perf_counter(), time.process_time()

    def read(self) -> Figure:
        """Returns the time since the stopwatch was created."""
        return Figure(time.perf_counter() - self._wall, time.process_time() - self._processor)


TEN_MINUTES = 600.0
REPEATS = 3


def office() -> mrs.OccupancyGrid:
    """Returns a grid of 1000 x 1000 cells of 5 cm: rooms of 5 m with doors. The walls keep the beams short."""
    cells = np.zeros((1000, 1000), np.int8)
    cells[::100, :] = cells[:, ::100] = cells[-1, :] = cells[:, -1] = 100
    for wall in range(100, 1000, 100):
        for room in range(0, 1000, 100):
            cells[wall, room + 40 : room + 60] = cells[room + 40 : room + 60, wall] = 0
    return mrs.OccupancyGrid(cells, resolution=0.05)


def circling(grid: mrs.OccupancyGrid) -> mrs.Simulation:
    """Returns a simulation of a robot that drives in circles: odometry at 50 Hz, a noisy scanner with 541 beams at 10 Hz."""
    parameters = {"publish_rate": 50.0, "velocity_timeout": 0.0}
    simulation = mrs.Simulation(grid, parameters=parameters, seed=SEED, start=(22.5, 21.5, 0.0))
    simulation.publish(
        "/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5), angular=mrs.messages.Vector3(z=0.5))
    )
    return simulation


def drive(grid: mrs.OccupancyGrid) -> Figure:
    """Drives for ten minutes without a recording."""
    simulation = circling(grid)
    stopwatch = Stopwatch()
    simulation.run_for(TEN_MINUTES)
    took = stopwatch.read()
    assert simulation.latest("/scan").header.stamp.nanoseconds == TEN_MINUTES * 1e9
    assert math.isclose(simulation.truth.distance, 0.5 * TEN_MINUTES)
    return took


def recorded_drive(grid: mrs.OccupancyGrid) -> Figure:
    """Drives the same ten minutes and records them to MCAP."""
    from mobile_robot_simulator.recording.recorder import Recorder

    with tempfile.TemporaryDirectory() as folder:
        simulation = circling(grid)
        stopwatch = Stopwatch()
        with Recorder(folder) as recorder:
            simulation.record_lazily(recorder.write)
            simulation.run_for(TEN_MINUTES)
        took = stopwatch.read()
        assert sum(file.stat().st_size for file in recorder.path.iterdir()) > 6000 * 541 * 4
    return took


def first_scan(grid: mrs.OccupancyGrid) -> Figure:
    """Creates a simulation on a new map of 1000 x 1000 cells and runs it until the first scan."""
    cells = grid.cells.copy()
    stopwatch = Stopwatch()
    simulation = mrs.Simulation(mrs.OccupancyGrid(cells, resolution=0.05), start=(22.5, 21.5, 0.0))
    simulation.run_for(0.1)
    took = stopwatch.read()
    assert simulation.latest("/scan") is not None
    return took


def twenty_robots(grid: mrs.OccupancyGrid) -> Figure:
    """Simulates a minute of twenty robots that see and could touch one another, with default rates and 541 noisy beams."""
    robots = {f"robot{index}": (22.5 + 5.0 * (index % 5 - 2), 22.5 + 5.0 * (index // 5 - 2), index) for index in range(20)}
    simulation = mrs.Simulation(grid, parameters={"velocity_timeout": 0.0}, seed=SEED, robots=robots)
    for name in robots:
        simulation.publish(
            f"/{name}/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.4), angular=mrs.messages.Vector3(z=0.4))
        )
    stopwatch = Stopwatch()
    simulation.run_for(60.0)
    took = stopwatch.read()
    assert len(simulation.robot.surroundings) == 19 and not simulation.truth.contacts
    return took


def main() -> None:
    """Runs and prints all benchmarks, and writes the figures to a file with --json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    options = parser.parse_args()
    grid = office()
    grid.prepare()
    figures: dict[str, dict[str, float]] = {}

    def report(name: str, measure: Callable[[mrs.OccupancyGrid], Figure], simulated: float, goal: float) -> None:
        took = min(measure(grid) for _ in range(REPEATS))
        figures[name] = took._asdict()
        speed = f"{simulated / took.wall:7.0f} times real time" if simulated else ""
        print(f"{name:28s} {took.wall:8.3f} s   processor {took.processor:8.3f} s   goal {goal:5.2f} s   {speed}")

    print(f"Python {platform.python_version()}, {platform.machine()}, version {mrs.__version__}")
    report("drive/ten_minutes", drive, TEN_MINUTES, 0.6)
    report("drive/ten_minutes_mcap", recorded_drive, TEN_MINUTES, 2.5)
    report("fresh/1000x1000", first_scan, 0.0, 0.05)
    report("robots/twenty_for_a_minute", twenty_robots, 60.0, 1.2)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
