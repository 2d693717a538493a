"""learning: one environment, as Gymnasium expects it."""

from __future__ import annotations

import math
import pickle

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv

import mobile_robot_simulator as mrs
from learning.rooms import actions, assert_same, environment, room, task
from mobile_robot_simulator.learning import NavigationEnv

ID = "mobile_robot_simulator/Navigation-v0"


@pytest.mark.parametrize("changes", [{}, {"max_velocity": (0.5, 0.3, 1.0)}])
def test_gymnasiums_check_passes(changes):
    env = gymnasium.make(ID, render_mode="rgb_array", **task(**changes))
    check_env(env.unwrapped)


def test_an_observation_is_what_pose_and_map_say():
    grid = room()
    env = NavigationEnv(**task(worlds=grid, noise=None, footprint=mrs.Shape.disc(0.1), max_velocity=(0.4, 0.5)))
    observation, info = env.reset(seed=8)
    start, scanner = info["pose"], env.task.laser
    distance, bearing = observation["goal"]
    goal = start[:2] + distance * np.array([math.cos(start[2] + bearing), math.sin(start[2] + bearing)])
    for _ in range(5):
        observation, _, _, _, info = env.step(np.array([0.5, -1.0], np.float32))
        pose = info["pose"]
        assert observation["ranges"].tobytes() == scanner.scan(grid, tuple(pose)).tobytes()
        seen = math.atan2(goal[1] - pose[1], goal[0] - pose[0]) - pose[2]
        assert observation["goal"][0] == pytest.approx(math.dist(goal, pose[:2]), abs=1e-5)
        assert math.remainder(observation["goal"][1] - seen, math.tau) == pytest.approx(0.0, abs=1e-5)
        assert observation["velocity"].tolist() == [np.float32(0.2), np.float32(-0.5)]
    end = mrs.Pose(*start).integrate((0.2, 0.0, -0.5), 0.5)
    assert tuple(info["pose"]) == pytest.approx(tuple(end), abs=1e-9)


def test_the_same_seed_repeats_an_episode():
    env, other = NavigationEnv(**task()), NavigationEnv(**task())
    for each in (env, other):
        each.reset(seed=1)
    env.reset(seed=2)
    other.reset(seed=2)
    for given in actions(1, 20)[:, 0]:
        assert_same(env.step(given), other.step(given))


def test_goals_can_be_reached_and_poses_touch_nothing():
    cells = np.zeros((30, 60), np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = cells[:, 30] = 100  # two rooms
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    env = NavigationEnv(**task(worlds=grid, goal_distances=(1.0, 5.0)))
    sides = set()
    for seed in range(100):
        observation, info = env.reset(seed=seed)
        x, y, yaw = info["pose"]
        distance, bearing = observation["goal"]
        goal = (x + distance * math.cos(yaw + bearing), y + distance * math.sin(yaw + bearing))
        assert grid.is_free_disc(x, y, 0.2499) and grid.is_free_disc(*goal, 0.2499)
        assert (x < 3.0) == (goal[0] < 3.0) and 1.0 <= distance <= 5.0
        sides.add(x < 3.0)
    assert sides == {True, False}


def test_randomisation_draws_for_each_episode():
    env = NavigationEnv(**task(randomisation={"slip": (0.2, 0.6), "sigma_hit": (0.1, 0.2)}, max_velocity=(0.5, 1.0)))
    slips, sigmas = set(), set()
    for seed in range(30):
        env.reset(seed=seed)
        observation, *_ = env.step(np.array([0.0, 1.0], np.float32))
        fleet = env._batch.fleet
        slips.add(fleet.slip[0])
        sigmas.add(fleet.noise[0].sigma_hit)
        assert observation["velocity"][1] == pytest.approx(1.0 - fleet.slip[0], abs=1e-6)
    assert len(slips) == len(sigmas) == 30
    assert 0.2 <= min(slips) < 0.3 and 0.5 < max(slips) <= 0.6
    assert 0.1 <= min(sigmas) and max(sigmas) <= 0.2


def test_limits_are_scaled_for_each_episode():
    limits = mrs.Limits(velocity=(0.6, 1.0, 2.0), acceleration=(1.0, 1.0, 4.0), deceleration=(2.0, 2.0, 8.0))
    ranges = {"velocity": (0.5, 1.0), "acceleration": (0.5, 2.0), "deceleration": (1.0, 1.0)}
    env = NavigationEnv(**task(limits=limits, randomisation=ranges, max_velocity=(0.6, 2.0)))
    factors = set()
    for seed in range(20):
        env.reset(seed=seed)
        observation, *_ = env.step(np.array([1.0, 0.0], np.float32))
        found = env._batch.fleet.limits[0]
        factor = found.acceleration[0]
        assert tuple(found.acceleration) == (factor, factor, 4.0 * factor) and tuple(found.deceleration) == (2.0, 2.0, 8.0)
        assert 0.3 <= found.velocity[0] <= 0.6
        # From a stand, for the 0.1 s of a step.
        assert observation["velocity"][0] == pytest.approx(0.1 * factor, abs=1e-6)
        assert observation in env.observation_space
        factors.add(factor)
    assert len(factors) == 20 and min(factors) < 0.7 and 1.7 < max(factors) <= 2.0


def test_closing_twice_is_allowed_and_a_call_after_that_is_not():
    env = NavigationEnv(render_mode="rgb_array", **task())
    env.reset(seed=1)
    env.close()
    env.close()
    for call in (lambda: env.step(np.zeros(2, np.float32)), env.reset, env.render):
        with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="must be open, got a call after close"):
            call()


def test_bad_use():
    env = NavigationEnv(**task())
    with pytest.raises(gymnasium.error.ResetNeeded, match="before its first step"):
        env.step(np.zeros(2))
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"actions must be finite, got \[inf, 0.0\]$"):
        env.step(np.array([np.inf, 0.0]))
    with pytest.raises(ValueError, match=r"actions must have shape \(2,\), got \(3,\)"):
        env.step(np.zeros(3))
    env.close()
    env.close()


def test_a_pickled_one_goes_on_as_the_original():
    env = NavigationEnv(**task())
    env.reset(seed=1)
    env.step(np.array([1.0, 0.5], np.float32))
    copy = pickle.loads(pickle.dumps(env))
    for given in actions(1, 10)[:, 0]:
        assert_same(env.step(given), copy.step(given))
    assert_same(env.reset(), copy.reset())


@pytest.mark.slow
@pytest.mark.parametrize("context", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
def test_workers_do_what_one_process_does(context):
    """The core's threads have run in this process before it forks."""
    mrs.LaserScanner().scan_batch(room(), np.zeros((4000, 3)), threads=4)
    loop = SyncVectorEnv([environment] * 2)
    workers = AsyncVectorEnv([environment] * 2, context=context, shared_memory=False)
    try:
        assert_same(workers.reset(seed=1), loop.reset(seed=1))
        for given in actions(2, 30):
            assert_same(workers.step(given), loop.step(given))
    finally:
        workers.close()


def test_a_picture_shows_robot_and_goal():
    env = NavigationEnv(render_mode="rgb_array", **task(worlds=room()))
    env.reset(seed=1)
    frame = env.render()
    colours = {tuple(colour) for colour in frame.reshape(-1, 3).tolist()}
    assert frame.shape == (256, 256, 3) and {(31, 119, 180), (44, 160, 44), (214, 39, 40)} <= colours
