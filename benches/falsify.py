"""Benchmark of searches: drives of 100 simulated seconds in a minute.

Run: python benches/falsify.py [--processes N] [--drives N]. Each drive has a robot with a footprint, ten obstacles, a
scanner with 541 or 181 beams at 10 Hz, odometry at 10 Hz, and a trivial controller that drives in circles and is asked ten
times per second. It is judged by its clearance. The processes are started before the time is taken. The benchmark checks
that every drive took its whole time. The parts of one drive are printed too, as processor time of its thread.
"""

from __future__ import annotations

import argparse
import os
import platform
import time
from itertools import islice

import mobile_robot_simulator as mrs
from mobile_robot_simulator.falsification import run_drive
from mobile_robot_simulator.falsification.runner import Runner
from mobile_robot_simulator.falsification.samplers import sampler
from mobile_robot_simulator.requirements import Trace, always, clearance
from mobile_robot_simulator.scenarios import Free, Moving, Space, WorldMap, floor_plans

DURATION = 100.0
GOAL = 2000
"""Drives in a minute on two idle cores, with 541 beams."""


class Circling:
    """Drives in small circles, as far as there is room."""

    def __init__(self, simulation: mrs.Simulation) -> None:
        self._seen = 0

    def __call__(self, seen: mrs.benchmarks.Observation) -> tuple[float, float]:
        """Returns the speed and the turn rate."""
        self._seen += len(seen.scan.ranges) > 0
        return 0.2, 1.0


def space(beams: int) -> Space:
    """Returns worlds with ten obstacles, none of which the circles reach."""
    return Space(
        [WorldMap("room", size=(12.0, 9.0)), *floor_plans("office", seeds=range(4))],
        start=Free(0.9),
        goal=None,
        obstacles=Moving(10, at_least=10, from_start=0.9),
        parameters={
            "robot_radius": 0.2,
            "laser_beam_count": beams,
            "publish_rate": 10.0,
            "publish_map_transform": False,
            "apply_noise": False,
        },
        duration=DURATION,
    )


def measure(beams: int, processes: int, drives: int) -> float:
    """Returns the number of drives in a minute."""
    worlds, requirement = space(beams), always(clearance > 0.0)
    source, points = sampler("random", len(worlds.dimensions), 1), []
    while len(points) < drives + 8 * processes:
        points += source.ask()
    with Runner([Circling], worlds, requirement, processes) as runner:
        warm = points[: 8 * processes]
        assert len(list(runner.run(warm))) == len(warm)
        start = time.perf_counter()
        results = [drive for (drive,) in islice(runner.run(points[len(warm) : len(warm) + drives]), drives)]
        took = time.perf_counter() - start
    wrong = [drive for drive in results if drive.ending != "time" or drive.time != DURATION or drive.failed]
    assert len(results) == drives and not wrong, wrong[:1]
    return 60.0 * drives / took


def parts(beams: int) -> str:
    """Returns the shortest processor times of the parts of a drive, as a text."""
    worlds = space(beams)
    point = sampler("random", len(worlds.dimensions), 1).ask()[0]
    taken = []
    for _ in range(5):
        marks = [time.thread_time()]
        world = worlds.world(point)
        run_drive(
            world,
            Circling,
            always(clearance > 0.0),
            prepare=lambda sim, marks=marks: marks.append(time.thread_time()),
            finish=lambda sim, marks=marks: marks.append(time.thread_time()),
        )
        with world.simulation() as sim:
            sim.run_for(DURATION)
            before = time.thread_time()
            assert (clearance > 0.0).robustness(Trace(sim)) > 0.0
            judged = time.thread_time() - before
        taken.append((marks[1] - marks[0], marks[2] - marks[1] - judged, judged))
    made, driven, judged = (1000.0 * min(times) for times in zip(*taken, strict=True))
    return f"{made:.1f} ms to make the world, about {driven:.0f} ms to drive, {judged:.1f} ms to judge a robot that stands"


def main() -> None:
    """Runs and prints the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--drives", type=int, default=120)
    options = parser.parse_args()
    print(f"Python {platform.python_version()}, {platform.machine()}, version {mrs.__version__}, {os.cpu_count()} cores")
    for beams in (541, 181):
        rate = measure(beams, options.processes, options.drives)
        print(
            f"falsify/{beams}_beams  {rate:6.0f} drives of {DURATION:g} s in a minute with {options.processes} processes, "
            f"goal {GOAL}, load {os.getloadavg()[0]:.1f}"
        )
        print(f"  one drive: {parts(beams)}")


if __name__ == "__main__":
    main()
