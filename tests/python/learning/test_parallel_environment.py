"""learning: several robots in one world, as PettingZoo has it."""

from __future__ import annotations

import math
import pickle
import re
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

import mobile_robot_simulator as mrs
from learning.rooms import actions, assert_same, room, task
from mobile_robot_simulator.learning import NavigationEnv, NavigationParallelEnv
from mobile_robot_simulator.scenarios import Moving

HALL = mrs.OccupancyGrid(np.zeros((60, 60), np.int8), resolution=0.1)
"""6 m by 6 m without walls."""

AHEAD, STAND = np.array([1.0, 0.0], np.float32), np.zeros(2, np.float32)


def placed(
    poses: list[tuple[float, float, float]], goals: list[tuple[float, float]], **changes: object
) -> NavigationParallelEnv:
    """Robots of radius 0.2 m in the hall, that stand at poses and measure without noise."""
    env = NavigationParallelEnv(len(poses), **task(worlds=HALL, noise=None, max_velocity=(1.0, 1.0), **changes))
    env.reset(seed=1)
    env._batch.fleet.reset(poses=poses)
    env._batch.goals[:] = goals
    return env


@pytest.mark.parametrize("changes", [{}, {"randomisation": {"slip": (0.0, 0.5)}}], ids=["plain", "random"])
def test_pettingzoo_accepts_it(changes):
    def make() -> NavigationParallelEnv:
        return NavigationParallelEnv(3, **task(**changes))

    parallel_api_test(make(), num_cycles=100)
    parallel_seed_test(make)


@pytest.mark.parametrize(
    "changes",
    [{}, {"max_velocity": (0.5, 0.4, 1.0)}, {"randomisation": {"slip": (0.0, 0.5)}}],
    ids=["plain", "sideways", "random"],
)
def test_one_robot_is_the_environment_of_gymnasium(changes):
    env, single = NavigationParallelEnv(1, **task(**changes)), NavigationEnv(**task(**changes))
    episodes = 0
    for seed in (1, None, None):
        assert_same(env.reset(seed=seed), tuple({"robot_0": each} for each in single.reset(seed=seed)))
        for given in actions(1, 60, len(env.task.max_velocity))[:, 0]:
            step = env.step({"robot_0": given})
            assert_same(step, tuple({"robot_0": each} for each in single.step(given)))
            if not env.agents:
                episodes += 1
                break
    assert episodes == 3


def test_robots_see_and_touch_each_other():
    """Two robots 0.6 m apart, with 0.2 m between them, drive at each other; a third one drives away."""
    poses = [(2.0, 3.0, 0.0), (2.6, 3.0, math.pi), (2.0, 5.0, 0.0)]
    scanner = mrs.LaserScanner(beam_count=1, max_range=4.0)
    env = placed(poses, [(5.0, 3.0), (0.5, 3.0), (4.0, 5.0)], scanner=scanner, duration=0.05)
    observations, *_ = env.step(dict.fromkeys(env.agents, STAND))
    assert [float(observations[agent]["ranges"][0]) for agent in env.agents] == pytest.approx([0.4, 0.4, 4.0], abs=1e-6)
    for _ in range(4):
        *_, terminations, truncations, infos = env.step(dict.fromkeys(env.agents, AHEAD))
        assert not any(truncations.values())
        if any(terminations.values()):
            break
    apart = infos["robot_1"]["pose"][0] - infos["robot_0"]["pose"][0]
    assert apart == pytest.approx(0.4, abs=0.02)  # what one drives while the other one counts as standing
    assert [infos[agent]["contact"] for agent in infos] == [True, True, False]
    assert infos["robot_0"]["reward_parts"]["contact"] == infos["robot_1"]["reward_parts"]["contact"] == -10.0
    assert env.agents == ["robot_2"]


def test_a_robot_that_stands_does_not_end_when_another_one_drives_against_it():
    env = placed([(2.0, 3.0, 0.0), (2.45, 3.0, math.pi)], [(5.0, 3.0), (0.5, 3.0)])
    for _ in range(4):
        *_, terminations, _, infos = env.step({"robot_0": AHEAD, "robot_1": STAND})
        if any(terminations.values()):
            break
    assert [infos[agent]["contact"] for agent in infos] == [True, False]
    *_, infos = env.step({"robot_1": -AHEAD})
    assert not infos["robot_1"]["contact"] and infos["robot_1"]["pose"][0] == pytest.approx(2.55)


def test_a_robot_that_has_ended_stays_as_an_obstacle():
    """The first robot reaches its goal at 1 m/s and would need 1 m to stop; the second one then drives against it."""
    limits = mrs.Limits(deceleration=(0.5, 0.5, 0.5))
    env = placed([(2.0, 3.0, 0.0), (3.6, 3.0, math.pi)], [(2.5, 3.0), (0.5, 3.0)], limits=limits)
    observations, rewards, terminations, _, infos = env.step({"robot_0": AHEAD, "robot_1": STAND})
    assert terminations == {"robot_0": True, "robot_1": False} and infos["robot_0"]["is_success"]
    assert rewards["robot_0"] > 9.0 and observations["robot_0"]["velocity"].tolist() == [1.0, 0.0]
    assert env.agents == ["robot_1"] and env.possible_agents == ["robot_0", "robot_1"]
    for _ in range(20):
        observations, _, terminations, _, infos = env.step({"robot_1": AHEAD})
        assert list(observations) == ["robot_1"]
        if terminations["robot_1"]:
            break
    assert infos["robot_1"]["contact"] and env.agents == []
    assert tuple(env._batch.fleet.poses[0]) == pytest.approx((2.1, 3.0, 0.0))
    assert infos["robot_1"]["pose"][0] == pytest.approx(2.5, abs=0.01)


def test_starts_and_goals_leave_room():
    env = NavigationParallelEnv(6, **task())
    for seed in range(20):
        _, infos = env.reset(seed=seed)
        assert len(set(env._batch.fleet.grid_of.tolist())) == 1
        for places in ([infos[agent]["pose"][:2] for agent in env.agents], env._batch.goals):
            apart = [math.dist(one, other) for row, one in enumerate(places) for other in places[:row]]
            assert min(apart) >= 2 * (0.2 + 0.05)


@pytest.mark.parametrize("threads", [2, None])
def test_the_same_seed_gives_the_same_bytes_with_any_number_of_threads(threads):
    env, other = NavigationParallelEnv(3, **task()), NavigationParallelEnv(3, threads=threads, **task())
    other.reset(seed=2)
    assert_same(env.reset(seed=1), other.reset(seed=1))
    for given in actions(3, 60):
        if not env.agents:
            assert_same(env.reset(), other.reset())
        chosen = {agent: given[int(agent[-1])] for agent in env.agents}
        assert_same(env.step(chosen), other.step(chosen))


def test_a_pickled_one_goes_on_as_the_original():
    env = NavigationParallelEnv(3, **task())
    env.reset(seed=3)
    copy = pickle.loads(pickle.dumps(env))
    chosen = dict.fromkeys(env.agents, AHEAD)
    assert_same(env.step(chosen), copy.step(chosen))
    assert_same(env.reset(), copy.reset())


def test_the_picture_shows_all_robots():
    poses, goals = [(1.0, 1.0, 0.0), (4.0, 4.0, 0.0)], [(3.0, 1.0), (1.0, 4.0)]
    env = placed(poses, goals, time_limit=0.1)
    assert env.render() is None
    shown = placed(poses, goals)
    shown.render_mode = "rgb_array"
    picture = shown.render()
    pixel = 256 / 6.0
    assert picture[256 - round(4.0 * pixel), round(4.0 * pixel)].tolist() == [60, 60, 60]


@pytest.mark.parametrize(
    ("arguments", "kind", "message"),
    [
        ({"robot_count": 0}, ValueError, "robot_count must be at least 1, got 0"),
        ({"robot_count": 1.5}, TypeError, "robot_count must be an integer, got 1.5"),
        ({"render_mode": "human"}, ValueError, "render_mode must be 'rgb_array' or None, got 'human'"),
        ({"obstacles": Moving(1)}, ValueError, "robots that share a world must have no obstacles, got Moving"),
        ({"threads": 0}, ValueError, "threads"),
        ({"speed": 1.0}, TypeError, "speed"),
        (
            {"robot_count": 60, "worlds": room()},
            ValueError,
            "a world must have room for 60 robots, and goals 0.5 m to 1.5 m from their starts; got none for ",
        ),
    ],
)
def test_bad_arguments(arguments, kind, message):
    with pytest.raises(kind, match=re.escape(message)):
        NavigationParallelEnv(**task(**arguments))


def test_a_bad_action_is_named_and_changes_nothing():
    env, other = NavigationParallelEnv(2, **task()), NavigationParallelEnv(2, **task())
    with pytest.raises(gymnasium.error.ResetNeeded, match="must be reset before a step"):
        env.step({})
    for each in (env, other):
        each.reset(seed=1)
    for chosen, kind, message in (
        ([AHEAD, AHEAD], TypeError, "actions must be a dict, got ["),
        ({"robot_0": AHEAD}, ValueError, "actions must be those of robot_0, robot_1, got ['robot_0']"),
        ({"robot_0": AHEAD, "robot_1": AHEAD, "robot_2": AHEAD}, ValueError, "got ['robot_0', 'robot_1', 'robot_2']"),
        ({"robot_0": AHEAD, "robot_1": [0.0, math.nan]}, ValueError, "robot_1: actions must be finite, got [0.0, nan]"),
        ({"robot_0": [1.0], "robot_1": AHEAD}, ValueError, "robot_0: actions must have shape (2,), got (1,)"),
        ({"robot_0": AHEAD, "robot_1": "ahead"}, TypeError, "robot_1: actions must be an array of real numbers"),
    ):
        with pytest.raises(kind, match=re.escape(message)):
            env.step(chosen)
    chosen = dict.fromkeys(env.agents, AHEAD)
    assert_same(env.step(chosen), other.step(chosen))


def test_closing_twice_is_allowed_and_a_step_after_that_is_not():
    env = NavigationParallelEnv(2, **task())
    env.reset(seed=1)
    env.close()
    env.close()
    for call in (env.reset, env.render, lambda: env.step(dict.fromkeys(env.agents, AHEAD))):
        with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="after close"):
            call()


def test_pettingzoo_is_imported_only_when_asked_for():
    code = "import sys; import mobile_robot_simulator.learning as learning; assert 'pettingzoo' not in sys.modules"
    missing = "; sys.modules['pettingzoo'] = None; learning.NavigationParallelEnv"
    done = subprocess.run([sys.executable, "-c", code + missing], capture_output=True, text=True, timeout=60)
    assert "ImportError: learning.NavigationParallelEnv needs pettingzoo: pip install" in done.stderr
