"""learning: discs that move to and fro, how they are drawn, and how robots meet them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from learning.rooms import actions, room, task
from mobile_robot_simulator.learning import FreeSpace, NavigationEnv, NavigationTask
from mobile_robot_simulator.learning.batch import Batch
from mobile_robot_simulator.learning.moving_discs import LEGS, MovingDiscs
from mobile_robot_simulator.scenarios import Moving, Range

MANY = 400
HALL = mrs.OccupancyGrid(np.zeros((100, 120), np.int8), resolution=0.1)
LIMITS = Moving(3, at_least=1, radius=Range(0.2, 0.4, "m"), speed=Range(0.3, 0.9, "m/s"), from_start=1.0)


def drawn(limits: Moving, seed: int = 1, duration: float = 30.0) -> tuple[np.ndarray, np.ndarray, list]:
    """Starts, goals and discs of many episodes in a hall."""
    starts = np.random.default_rng(seed).uniform(0.0, 10.0, (MANY, 3))
    goals = np.random.default_rng(seed + 1).uniform(0.0, 10.0, (MANY, 2))
    generators = [np.random.default_rng([seed, index]) for index in range(MANY)]
    discs = MovingDiscs(limits, FreeSpace([HALL], 0.3), duration)
    return starts, goals, discs.draw(np.zeros(MANY, np.intp), starts, goals, generators)


def test_discs_are_what_the_limits_say() -> None:
    starts, _, episodes = drawn(LIMITS)
    counts, speeds, radii = [], [], []
    for start, discs in zip(starts, episodes, strict=True):
        assert len(discs) == 3
        present = [(shape.reach, way) for shape, way in discs if way is not None]
        counts.append(len(present))
        for radius, way in present:
            assert math.dist(way[0, 1:3], start[:2]) >= radius + 1.0
            assert way[0, 0] == 0.0 and way[-1, 0] >= 30.0 and way.shape[0] >= 2
            legs, times = np.linalg.norm(np.diff(way[:, 1:3], axis=0), axis=1), np.diff(way[:, 0])
            assert (way[::2, 1:] == way[0, 1:]).all() and (way[1::2, 1:] == way[1, 1:]).all()
            assert LEGS[0] - 1e-9 <= legs.min() and legs.max() <= LEGS[1] + 1e-9
            speeds.append((legs / times).mean())
            radii.append(radius)
            assert np.allclose(legs / times, speeds[-1])
    assert 0.3 <= min(speeds) < 0.32 and 0.88 < max(speeds) <= 0.9
    assert 0.2 <= min(radii) < 0.21 and 0.39 < max(radii) <= 0.4
    # One to three, each as likely; a few of them are too near to the start.
    assert set(counts) <= {0, 1, 2, 3} and min(np.bincount(counts, minlength=4)[1:]) > 0.2 * MANY


def test_discs_that_stand_keep_away_from_the_goal() -> None:
    _, goals, episodes = drawn(Moving(2, at_least=2))
    gaps = []
    for goal, discs in zip(goals, episodes, strict=True):
        for shape, way in discs:
            if way is not None:
                assert way.shape == (1, 4)
                gaps.append(math.dist(way[0, 1:3], goal) - shape.reach)
    assert 0.6 <= min(gaps) < 0.8


def test_robots_see_and_touch_discs() -> None:
    """A robot of 0.2 m drives along x at 1 m/s. A disc of 0.3 m comes towards it at 1 m/s, from 3 m ahead of it."""
    limits = Moving(1, at_least=1, speed=Range(1.0, 1.0, "m/s"))
    arguments = task(worlds=HALL, noise=None, max_velocity=(1.0, 1.0), duration=0.1, obstacles=limits, goal_radius=0.1)
    arguments["scanner"] = mrs.LaserScanner(beam_count=1, max_range=4.0)
    batch = Batch(NavigationTask(**arguments), 3)
    batch.seed([1, 2, 3], np.ones(3, bool))
    batch.reset(np.ones(3, bool))
    batch.fleet.reset(poses=[(2.0, 5.0, 0.0)] * 3)
    batch.goals[:] = (9.0, 5.0)
    disc, way = mrs.Shape.disc(0.3), [(0.0, 5.0, 5.0, 0.0), (3.0, 2.0, 5.0, 0.0)]
    batch.fleet.replace_obstacles([(0, disc, way), (1, disc, None), (2, disc, [(0.0, 5.0, 8.0, 0.0), (3.0, 5.0, 5.0, 0.0)])])
    for step in range(1, 13):
        outcome = batch.step(np.tile([1.0, 0.0], (3, 1)))
        assert not outcome.contacts.any()
        ahead = batch.observations()["ranges"][:, 0]
        gap = 3.0 - 2 * 0.1 * step - 0.3
        assert ahead[0] == pytest.approx(gap, abs=1e-6) and ahead[1] == 4.0
    outcome = batch.step(np.tile([1.0, 0.0], (3, 1)))  # after 1.25 s they meet
    assert outcome.contacts.tolist() == outcome.terminated.tolist() == [True, False, False]
    assert [outcome.info(index)["reward_parts"]["contact"] for index in range(3)] == [-10.0, 0.0, 0.0]


def test_observations_show_the_discs_of_each_episode() -> None:
    obstacles = Moving(3, at_least=3, speed=Range(0.2, 0.6, "m/s"), from_start=0.3)
    arguments = task(worlds=room(9.0, 8.0), noise=None, obstacles=obstacles)
    arguments["scanner"] = mrs.LaserScanner(fov=math.tau, beam_count=90, max_range=4.0)
    env = NavigationEnv(**arguments)
    scanner, shorter = env.task.laser, 0
    for seed in range(4):
        observation, info = env.reset(seed=seed)
        for given in actions(1, 12)[:, 0]:
            discs = [(mrs.Shape.disc(reach), (x, y, 0.0)) for x, y, reach in env._batch.discs(0)]
            pose = tuple(info["pose"])
            true = scanner.scan(env.task.grids[0], pose, obstacles=discs)
            assert np.allclose(observation["ranges"], true, atol=1e-5)
            shorter += int((true < scanner.scan(env.task.grids[0], pose)).sum())
            observation, _, terminated, _, info = env.step(given)
            if terminated:
                break
    assert shorter > 20


def test_a_picture_shows_the_discs() -> None:
    arguments = task(worlds=room(9.0, 8.0), obstacles=Moving(3, at_least=3, from_start=0.3))
    env, empty = NavigationEnv(render_mode="rgb_array", **arguments), NavigationEnv(render_mode="rgb_array", **arguments)
    env.reset(seed=1)
    empty.reset(seed=1)
    empty._batch._obstacles = []
    different = (env.render() != empty.render()).any(axis=2)
    scale = 256 / 9.0
    area = sum(math.pi * (reach * scale) ** 2 for *_, reach in env._batch.discs(0))
    assert area > 0.0 and different.sum() == pytest.approx(area, rel=0.2)
