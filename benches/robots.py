"""Benchmark of worlds with many robots: wall time and processor time of a robot and simulated second.

Run: python benches/robots.py [COUNT ...]. The robots stand 3 m apart in one hall and drive in circles. They see one another
with 541 noisy beams at 10 Hz and a maximum range of 30 m, publish odometry at 50 Hz, and could touch one another. Each
figure is the least of a few turns; the processor time is that of all threads. Adding 10,000 obstacles is timed, too.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import time

import numpy as np

import mobile_robot_simulator as mrs

COUNTS = (1, 10, 100, 300, 1000)
SPACING = 3.0
TURNS = 5


def world(count: int) -> mrs.Simulation:
    """Returns a hall with robots that drive in circles."""
    side = math.ceil(math.sqrt(count))
    cells = np.pad(np.zeros((int((side + 1) * SPACING / 0.05),) * 2, np.int8), 1, constant_values=100)
    robots = {
        f"robot{index}": (SPACING * (index % side + 1), SPACING * (index // side + 1), 0.7 * index) for index in range(count)
    }
    parameters = {"robot_radius": 0.2, "velocity_timeout": 0.0, "publish_rate": 50.0}
    simulation = mrs.Simulation(
        mrs.OccupancyGrid(cells=cells, resolution=0.05), parameters=parameters, seed=1, robots=robots
    )
    command = mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.3), angular=mrs.messages.Vector3(z=0.6))
    for name in robots:
        simulation.publish(f"/{name}/cmd_vel", command)
    return simulation


def measure(count: int) -> tuple[float, float]:
    """Returns the wall time and the processor time of a simulated second [s]."""
    simulation, seconds = world(count), max(0.2, 20.0 / count)
    simulation.run_for(0.4)
    walls, processors = [], []
    for _ in range(TURNS):
        wall, processor = time.perf_counter(), time.process_time()
        simulation.run_for(seconds)
        walls.append((time.perf_counter() - wall) / seconds)
        processors.append((time.process_time() - processor) / seconds)
    sees = [len(robot.robot.surroundings) for robot in simulation.robots.values()]
    assert sees == [count - 1] * count and not any(robot.truth.contacts for robot in simulation.robots.values())
    return min(walls), min(processors)


def add_obstacles(count: int) -> float:
    """Returns the processor time of adding obstacles to a world with ten robots [s]."""
    simulation, disc = world(10), mrs.Shape.disc(0.1)
    start = time.thread_time()
    for index in range(count):
        simulation.add_obstacle(disc, (-5.0 - 0.5 * (index % 100), 0.5 * (index // 100), 0.0))
    return time.thread_time() - start


def main() -> None:
    """Runs and prints the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("counts", nargs="*", type=int, default=COUNTS)
    print(f"Python {platform.python_version()}, {platform.machine()}, version {mrs.__version__}, {os.cpu_count()} cores")
    counts = parser.parse_args().counts
    # First, because to clear away the worlds of the others takes time.
    print(f"10,000 obstacles added in {add_obstacles(10_000):.3f} s; load {os.getloadavg()[0]:.1f}")
    for count in counts:
        wall, processor = measure(count)
        each = f"{1e3 * wall / count:6.3f} ms each, {1e3 * processor / count:6.3f} ms of processor time"
        print(f"{count:6} robots: {each}, {1.0 / wall:7.2f} times real time")


if __name__ == "__main__":
    main()
