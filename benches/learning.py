"""Benchmarks of the environments of Gymnasium: steps a second, memory, and what the layer above the core takes.

Run: python benches/learning.py [--json FILE]. Each figure is the median of several turns in one process. In each turn many
environments and a single one take their turn, so a busy machine slows both. All cores are used; `taskset` limits them. A
step of an environment has motion, contact of a footprint, a noisy scan, the reward and, after an episode, a reset.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import statistics
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.learning import NavigationEnv, NavigationVectorEnv, training_plans

ENVIRONMENTS = 1024
TURNS, STEPS = 9, 40


def seconds(call: Callable[[], object]) -> float:
    """Returns the time of a call."""
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def resident() -> int:
    """Returns the memory that the process holds now [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Timed:
    """A fleet that adds up the time of the calls of its methods and properties."""

    def __init__(self, fleet: mrs.Fleet) -> None:
        self._fleet, self.spent = fleet, 0.0
        # Methods of its own, because each look-up by `__getattr__` takes about a microsecond.
        for name in ("relative", "replace_obstacles", "reset", "scan", "step"):
            setattr(self, name, partial(self._call, getattr(fleet, name)))

    @property
    def poses(self) -> Any:
        """The poses of the robots."""
        return self._call(lambda: self._fleet.poses)

    @property
    def velocities(self) -> Any:
        """The velocities of the robots."""
        return self._call(lambda: self._fleet.velocities)

    def _call(self, method: Callable[..., Any], *arguments: Any, **keywords: Any) -> Any:
        start = time.perf_counter()
        result = method(*arguments, **keywords)
        self.spent += time.perf_counter() - start
        return result


def measure(beams: int, worlds: list[mrs.OccupancyGrid]) -> dict[str, float]:
    """Returns the figures with scans of some beams."""
    task = {"worlds": worlds, "scanner": mrs.LaserScanner(fov=math.tau, beam_count=beams, max_range=10.0)}
    before = resident()
    envs = NavigationVectorEnv(ENVIRONMENTS, copy=False, **task)
    envs.reset(seed=1)
    actions = np.random.default_rng(2).uniform(-1.0, 1.0, (STEPS, *envs.action_space.shape)).astype(np.float32)
    envs.step(actions[0])
    memory = resident() - before
    single = NavigationEnv(**task)
    single.reset(seed=1)
    timed = envs._batch.fleet = Timed(envs._batch.fleet)
    ended = 0

    def drive() -> None:
        nonlocal ended
        for chosen in actions:
            _, _, terminated, truncated, _ = envs.step(chosen)
            ended += int((terminated | truncated).sum())

    def drive_one() -> None:
        for chosen in actions[:, 0]:
            _, _, terminated, truncated, _ = single.step(chosen)
            if terminated or truncated:
                single.reset()

    times = []
    for _ in range(TURNS):
        timed.spent = 0.0
        many = seconds(drive)
        times.append((many, 1.0 - timed.spent / many, seconds(drive_one)))
    assert ended > 0
    ours, share, one = (statistics.median(column) for column in zip(*times, strict=True))
    return {
        "steps_per_second": ENVIRONMENTS * STEPS / ours,
        "layer_share": share,
        "single_steps_per_second": STEPS / one,
        "bytes_per_environment": memory / ENVIRONMENTS,
        "ended_per_step": ended / (TURNS * STEPS),
    }


def main() -> None:
    """Runs and prints all benchmarks, and writes the figures to a file with --json."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    options = parser.parse_args()
    cores = len(os.sched_getaffinity(0))
    print(f"Python {platform.python_version()}, gymnasium {gymnasium.__version__}, {platform.machine()}, {cores} cores")
    print(f"{ENVIRONMENTS} environments on floor plans; goal: 250,000 steps/s with 200 beams, 1,000,000 with 32")
    worlds = training_plans(4)
    for world in worlds:
        world.prepare()
    figures = {}
    for beams in (200, 32):
        figures[f"beams_{beams}"] = found = measure(beams, worlds)
        print(
            f"{beams:4d} beams: {found['steps_per_second']:9,.0f} steps/s,"
            f" {found['layer_share']:.1%} of the time outside of the core,"
            f" {found['ended_per_step']:.1f} episodes end in a step,"
            f" {found['bytes_per_environment'] / 1024:.1f} KiB each;"
            f" one environment alone: {found['single_steps_per_second']:,.0f} steps/s"
        )
    if options.json:
        options.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
