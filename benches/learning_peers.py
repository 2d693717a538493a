"""Benchmark of environment steps a second beside other simulators: ir-sim, navground and jaxnav (of jaxmarl).

Run: python benches/learning_peers.py [--python NAME=PYTHON ...]. Each simulator runs in a process of its own, with the
Python that is named for it, so that each can have a virtual environment of its own; by default it is the Python that runs
this file. One that cannot be imported is passed over, and the benchmark says so.

All do the same kind of task: a robot with a radius of 0.2 m and a laser scanner of 200 beams drives among pillars in a room
of 10 m, at random velocities or towards goals, in steps of 0.1 s. Contact is looked for, and an episode that has ended is
followed by another. jaxnav draws its own rooms, with polygons in them.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

BEAMS, REACH, DURATION, RADIUS, SIDE = 200, 6.0, 0.1, 0.2, 10.0
PILLARS = [(2.0, 2.0), (2.0, 5.0), (2.5, 8.0), (5.0, 2.5), (5.0, 7.5), (7.5, 2.0), (8.0, 5.0), (7.5, 8.0)]
PILLAR = 0.3
SECONDS = 3.0


def rate(step: Callable[[], int], at_least: float = SECONDS) -> float:
    """Returns how many environment steps a second `step` makes, which returns the number that it has made."""
    # What is compiled for a call of one kind may be compiled again for the results of the first one.
    for _ in range(3):
        step()
    steps, start = 0, time.perf_counter()
    while (spent := time.perf_counter() - start) < at_least:
        steps += step()
    return steps / spent


def ours() -> dict[str, float | str]:
    """Steps 1,024 environments of this package."""
    import numpy as np

    import mobile_robot_simulator as mrs
    from mobile_robot_simulator.learning import NavigationVectorEnv

    count, cell = 1024, 0.05
    y, x = (np.indices((round(SIDE / cell),) * 2) + 0.5) * cell
    near = [np.hypot(x - px, y - py) < PILLAR for px, py in PILLARS]
    edge = (np.minimum(x, y) < cell) | (np.maximum(x, y) > SIDE - cell)
    world = mrs.OccupancyGrid((np.any(near, axis=0) | edge).astype(np.int8) * 100, resolution=cell)
    scanner = mrs.LaserScanner(fov=math.tau, beam_count=BEAMS, max_range=REACH)
    envs = NavigationVectorEnv(count, worlds=world, scanner=scanner, duration=DURATION, goal_distances=(2.0, 6.0))
    envs.reset(seed=1)
    actions = np.random.default_rng(2).uniform(-1.0, 1.0, (64, count, 2)).astype(np.float32)
    turn = iter(range(10**9))

    def step() -> int:
        envs.step(actions[next(turn) % 64])
        return count

    return {"rate": rate(step), "version": version("mobile-robot-simulator"), "environments": count}


def irsim() -> dict[str, float | str]:
    """Steps one world of ir-sim."""
    import irsim

    pillars = "".join(f"\n      - [{x}, {y}]" for x, y in PILLARS)
    shapes = "".join(f"\n      - {{name: circle, radius: {PILLAR}}}" for _ in PILLARS)
    angle = "range_max: 6.0, angle_range: 6.28318, number: 200, noise: true, std: 0.01"
    text = f"""
world: {{height: {SIDE}, width: {SIDE}, step_time: {DURATION}, sample_time: {DURATION}, collision_mode: stop}}
robot:
  - kinematics: {{name: diff}}
    shape: {{name: circle, radius: {RADIUS}}}
    state: [1.0, 1.0, 0.8]
    goal: [9.0, 9.0, 0.0]
    sensors: [{{name: lidar2d, {angle}}}]
obstacle:
  - number: {len(PILLARS)}
    distribution: {{name: manual}}
    state:{pillars.replace("]", ", 0]")}
    shape:{shapes}
"""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "world.yaml")
        path.write_text(text, encoding="utf-8")
        env = irsim.make(str(path), display=False, headless=True)
    dice = random.Random(2)

    def step() -> int:
        env.step([dice.uniform(0.0, 0.6), dice.uniform(-1.5, 1.5)])
        env.get_lidar_scan()
        if env.done():
            env.reset()
        return 1

    return {"rate": rate(step), "version": version("ir-sim"), "environments": 1}


def navground() -> dict[str, float | str]:
    """Steps one world of navground, in which the robot drives to points without avoiding anything."""
    from navground import core, sim

    text = f"type: Lidar\nresolution: {BEAMS}\nrange: {REACH}\nerror_std_dev: 0.01\n"
    dice = random.Random(2)
    world = sim.World()
    corners = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)]
    for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
        world.add_wall(sim.Wall(start, end))
    for pillar in PILLARS:
        world.add_obstacle(sim.Obstacle(pillar, PILLAR))
    behavior = core.Behavior.make_type("Dummy")
    agent = sim.Agent(
        radius=RADIUS, behavior=behavior, kinematics=core.Kinematics.make_type("2WDiff"), control_period=DURATION
    )
    agent.kinematics.max_speed = behavior.optimal_speed = 0.6
    agent.state_estimation = sim.load_state_estimation(text)
    agent.position = (1.0, 1.0)
    world.add_agent(agent)

    def step() -> int:
        if not behavior.has_target or behavior.check_if_target_satisfied() or agent.has_been_stuck_since(1.0):
            behavior.target = core.Target.Point((dice.uniform(0.5, 9.5), dice.uniform(0.5, 9.5)), 0.3)
        if world.get_agents_in_collision():
            agent.position = (1.0, 1.0)
        world.update(DURATION)
        return 1

    return {"rate": rate(step), "version": version("navground"), "environments": 1}


def jaxnav() -> dict[str, float | str]:
    """Steps 1,024 environments of jaxnav in one compiled call on the processor."""
    import jax
    from jaxmarl import make

    count = 1024
    env = make("jaxnav", num_agents=1, rad=RADIUS, lidar_num_beams=BEAMS, lidar_max_range=REACH, dt=DURATION)

    def one(key, state):  # type: ignore[no-untyped-def]
        actions = {name: env.action_space(name).sample(key) for name in env.agents}
        return env.step(key, state, actions)[1]

    keys = jax.random.split(jax.random.PRNGKey(0), count)
    _, states = jax.jit(jax.vmap(env.reset))(keys)
    advance = jax.jit(jax.vmap(one))
    held = [states]

    def step() -> int:
        held[0] = jax.block_until_ready(advance(keys, held[0]))
        return count

    return {"rate": rate(step), "version": version("jaxmarl"), "environments": count}


PEERS = {"ours": ours, "ir-sim": irsim, "navground": navground, "jaxnav": jaxnav}


def main() -> None:
    """Runs each simulator in a process of its own, and prints the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--python", action="append", default=[], metavar="NAME=PYTHON", help="the Python of a simulator")
    parser.add_argument("--only", choices=PEERS, help="run one simulator in this process, and print its figures as JSON")
    options = parser.parse_args()
    if options.only:
        print(json.dumps(PEERS[options.only]()))
        return
    pythons = dict(item.split("=", 1) for item in options.python)
    for name in PEERS:
        command = [pythons.get(name, sys.executable), __file__, "--only", name]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            reason = (done.stderr.strip().splitlines() or ["no output"])[-1]
            print(f"{name:>10}: not measured: {reason}")
            continue
        found = json.loads(done.stdout.strip().splitlines()[-1])
        print(f"{name:>10}: {found['rate']:12,.0f} steps/s, {found['environments']} at a time, version {found['version']}")


if __name__ == "__main__":
    main()
