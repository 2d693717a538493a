"""Trains a small policy to drive to goals by evolution strategies, in NumPy alone, and tests it on floor plans it never saw.

Run: python examples/learning/evolution.py --out learning.png

The policy is a network with one hidden layer. It sees the nearest obstacle in each of some directions, the goal and the
velocity. In each generation, pairs of policies with opposite random changes drive through the same episodes. The parameters
move along the changes, weighted by the ranks of the rewards, with the steps of Adam. The same seed gives the same policy.

Source: T. Salimans and others, Evolution Strategies as a Scalable Alternative to Reinforcement Learning, 2017,
https://arxiv.org/abs/1703.03864.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.learning import NavigationVectorEnv, training_plans, unseen_plans

BEAMS, SECTORS, HIDDEN = 48, 24, 24
PAIRS, EPISODES = 40, 24
SPREAD, RATE = 0.05, 0.04
INPUTS = SECTORS + 4 + 2
SIZES = [(INPUTS, HIDDEN), (HIDDEN,), (HIDDEN, 2), (2,)]
COUNT = sum(math.prod(size) for size in SIZES)


def task(worlds: list[mrs.OccupancyGrid]) -> dict[str, Any]:
    """Returns the arguments of the environments."""
    return {
        "worlds": worlds,
        "scanner": mrs.LaserScanner(fov=math.tau, beam_count=BEAMS, max_range=6.0),
        "noise": mrs.BeamModel(sigma_hit=0.02, z_hit=0.99, z_max=0.0, z_rand=0.01),
        "duration": 0.2,
        "time_limit": 30.0,
        "goal_distances": (1.0, 4.0),
        "autoreset_mode": "Disabled",
        "copy": False,
    }


def act(policies: np.ndarray, seen: dict[str, np.ndarray]) -> np.ndarray:
    """Returns the actions (N, 2) of N robots, of which N / P in a row follow each of P policies (P, COUNT)."""
    near = seen["ranges"].reshape(len(seen["ranges"]), SECTORS, -1).min(axis=2)
    distance, bearing = seen["goal"].T
    goal = np.stack([np.minimum(distance, 3.0) / 3.0, 1.0 / (1.0 + distance), np.cos(bearing), np.sin(bearing)], axis=1)
    inputs = np.concatenate([np.exp(-near), goal, seen["velocity"]], axis=1, dtype=np.float64)
    inputs = inputs.reshape(len(policies), -1, INPUTS)
    parts, first = [], 0
    for size in SIZES:
        parts.append(policies[:, first : first + math.prod(size)].reshape(-1, *size))
        first += math.prod(size)
    hidden = np.tanh(inputs @ parts[0] + parts[1][:, None])
    return np.tanh(hidden @ parts[2] + parts[3][:, None]).reshape(-1, 2)


class Drives(NamedTuple):
    """One episode in each of N environments."""

    rewards: np.ndarray
    """Sum of the rewards, (N,)."""
    reached: np.ndarray
    """Whether the goal was reached, (N,)."""
    poses: np.ndarray
    """Pose after each step, (steps + 1, N, 3); NaN after the end."""
    goals: np.ndarray
    """Goals in the map frame, (N, 2)."""


def drive(envs: NavigationVectorEnv, policies: np.ndarray, seeds: list[int]) -> Drives:
    """Drives one episode in each environment, N / P in a row with each of P policies."""
    seen, info = envs.reset(seed=seeds)
    (distance, bearing), (x, y, yaw) = seen["goal"].T, info["pose"].T
    goals = np.stack([x + distance * np.cos(yaw + bearing), y + distance * np.sin(yaw + bearing)], axis=1)
    rewards, reached, running = np.zeros(envs.num_envs), np.zeros(envs.num_envs, bool), np.ones(envs.num_envs, bool)
    poses = [info["pose"]]
    while running.any():
        seen, reward, terminated, truncated, info = envs.step(act(policies, seen))
        rewards[running] += reward[running]
        reached |= running & info["is_success"]
        poses.append(np.where(running[:, None], info["pose"], np.nan))
        if (ended := terminated | truncated).any():
            # They begin another episode, which does not count, so that all can be stepped together.
            running &= ~ended
            seen, _ = envs.reset(options={"reset_mask": ended})
    return Drives(rewards, reached, np.array(poses), goals)


def ranks(rewards: np.ndarray) -> np.ndarray:
    """Returns the rank of each reward, from -0.5 for the least to 0.5 for the largest."""
    return rewards.argsort().argsort() / (len(rewards) - 1) - 0.5


def train(kind: str, generations: int, seed: int) -> tuple[np.ndarray, list[float]]:
    """Returns a trained policy, and the share of goals that was reached in each generation."""
    generator = np.random.default_rng(seed)
    envs = NavigationVectorEnv(2 * PAIRS * EPISODES, **task(training_plans(32, kind)))
    policy, mean, square, shares = generator.normal(0.0, 0.1, COUNT), np.zeros(COUNT), np.zeros(COUNT), list[float]()
    for generation in range(1, generations + 1):
        changes = generator.normal(size=(PAIRS, COUNT))
        policies = policy + SPREAD * np.concatenate([changes, -changes])
        # All policies drive through the same episodes.
        seeds = [int(number) for number in generator.integers(2**31, size=EPISODES)] * (2 * PAIRS)
        drives = drive(envs, policies, seeds)
        weights = ranks(drives.rewards.reshape(2 * PAIRS, EPISODES).mean(axis=1))
        gradient = ((weights[:PAIRS] - weights[PAIRS:]) @ changes) / (2 * PAIRS * SPREAD) - 0.005 * policy
        mean, square = 0.9 * mean + 0.1 * gradient, 0.999 * square + 0.001 * gradient**2
        step = (mean / (1.0 - 0.9**generation)) / (np.sqrt(square / (1.0 - 0.999**generation)) + 1e-8)
        policy = policy + RATE * (1.0 - 0.9 * generation / generations) * step
        shares.append(float(drives.reached.mean()))
        print(f"generation {generation:3d}: {shares[-1]:6.1%} of goals, reward {drives.rewards.mean():6.2f}", flush=True)
    return policy, shares


def draw(out: Path, shares: list[float], world: mrs.OccupancyGrid, drives: Drives) -> None:
    """Draws the learning curve, and drives through one world."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 4.2), layout="constrained")
    curve, plan = figure.subplots(1, 2, width_ratios=(1.0, 1.3))
    curve.plot(np.arange(1, len(shares) + 1), np.array(shares) * 100.0)
    curve.set(xlabel="generation", ylabel="goals reached in training [%]", ylim=(0.0, 100.0))
    world.plot(plan)
    for index, (goal, is_reached) in enumerate(zip(drives.goals, drives.reached, strict=True)):
        colour = f"C{index % 10}"
        plan.plot(*drives.poses[:, index, :2].T, color=colour, linewidth=1.5)
        plan.plot(*drives.poses[0, index, :2], "o", color=colour, markersize=5.0)
        plan.plot(*goal, "*" if is_reached else "x", color=colour, markersize=10.0)
    plan.set_title("a plan not seen in training; stars are reached goals")
    figure.savefig(out, dpi=100)


def main() -> None:
    """Trains, tests and draws."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kind", default="cave", help="kind of the floor plans")
    parser.add_argument("--generations", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="write a picture of the learning curve and of drives to this file")
    options = parser.parse_args()
    policy, shares = train(options.kind, options.generations, options.seed)
    worlds = unseen_plans(20, options.kind)
    drives = drive(NavigationVectorEnv(500, **task(worlds)), policy[None], list(range(500)))
    print(f"unseen plans: {drives.reached.mean():.1%} of 500 goals reached without contact")
    if options.out:
        draw(
            options.out, shares, worlds[0], drive(NavigationVectorEnv(10, **task(worlds[:1])), policy[None], list(range(10)))
        )


if __name__ == "__main__":
    main()
