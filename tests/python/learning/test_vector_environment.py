"""learning: many environments equal Gymnasium's own loop over as many single ones, in each autoreset mode."""

from __future__ import annotations

import pickle
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import mobile_robot_simulator as mrs
from learning.rooms import actions, assert_same, room, task
from mobile_robot_simulator.learning import NavigationEnv, NavigationVectorEnv, training_plans
from mobile_robot_simulator.scenarios import Moving, Range

ID = "mobile_robot_simulator/Navigation-v0"
COUNT, STEPS, SEED = 9, 150, 5
DISCS = Moving(2, radius=Range(0.1, 0.2, "m"), speed=Range(0.1, 0.5, "m/s"), from_start=0.4)


def both(mode: AutoresetMode, **changes: object) -> tuple[NavigationVectorEnv, SyncVectorEnv]:
    arguments = task(**changes)
    ours = NavigationVectorEnv(COUNT, autoreset_mode=mode, **arguments)
    return ours, SyncVectorEnv([lambda: NavigationEnv(**arguments)] * COUNT, autoreset_mode=mode)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"max_velocity": (0.5, 0.4, 1.0), "limits": mrs.Limits(acceleration=(1.0, 1.0, 2.0))},
        {"randomisation": {"slip": (0.0, 0.3), "sigma_hit": (0.01, 0.1), "z_short": (0.0, 0.2)}},
        {"randomisation": {"slip": (0.1, 0.2)}, "noise": None},
        {"randomisation": {"acceleration": (0.5, 2.0)}, "limits": mrs.Limits(acceleration=(1.0, 1.0, 2.0))},
        {"obstacles": DISCS},
        {"obstacles": DISCS, "randomisation": {"slip": (0.0, 0.2)}},
    ],
)
def test_they_are_what_gymnasiums_loop_over_single_ones_is(mode, changes):
    ours, loop = both(mode, **changes)
    assert ours.single_observation_space == loop.single_observation_space
    assert ours.observation_space == loop.observation_space and ours.action_space == loop.action_space
    assert_same(ours.reset(seed=SEED), loop.reset(seed=SEED))
    ended = np.zeros(3, int)
    for given in actions(COUNT, STEPS, len(changes.get("max_velocity", (0, 0)))):
        mine, theirs = ours.step(given), loop.step(given)
        assert_same(mine, theirs)
        assert mine[0] in ours.observation_space
        info = mine[4].get("final_info", mine[4])
        ended += [mine[2].sum(), mine[3].sum(), info.get("is_success", np.zeros(1)).sum()]
    assert (ended >= 1).all()  # contacts or goals, ends of the time, and goals
    assert_same(ours.reset(), loop.reset())
    assert ours.np_random_seed == loop.np_random_seed == tuple(range(SEED, SEED + COUNT))


def test_without_autoreset_a_mask_says_which_to_reset():
    ours, loop = both(AutoresetMode.DISABLED)
    assert_same(ours.reset(seed=SEED), loop.reset(seed=SEED))
    resets = 0
    for given in actions(COUNT, STEPS):
        mine = ours.step(given)
        assert_same(mine, loop.step(given))
        if (mask := mine[2] | mine[3]).any():
            kept = {name: values.copy() for name, values in mine[0].items()}
            with pytest.raises(gymnasium.error.ResetNeeded, match=f"got {mask.sum()} that have not"):
                ours.step(given)
            assert_same(ours.reset(options={"reset_mask": mask}), loop.reset(options={"reset_mask": mask}))
            assert_same(mine[0], kept)
            resets += 1
    assert resets >= 5


@pytest.mark.parametrize("changes", [{}, {"obstacles": DISCS}])
def test_seeds_repeat_each_environment_on_its_own(changes):
    envs = NavigationVectorEnv(3, **task(**changes))
    alone = NavigationEnv(**task(**changes))
    first, _ = envs.reset(seed=[11, 4, 9])
    observation, _ = alone.reset(seed=4)
    assert_same({name: values[1] for name, values in first.items()}, observation)
    other, _ = envs.reset(seed=[None, 4, None])
    assert other["ranges"][1].tobytes() == first["ranges"][1].tobytes()
    assert other["ranges"][0].tobytes() != first["ranges"][0].tobytes()


@pytest.mark.parametrize("threads", [1, 3])
def test_threads_and_copies_change_nothing(threads):
    arguments = task(obstacles=DISCS)
    one, other = NavigationVectorEnv(5, threads=threads, copy=False, **arguments), NavigationVectorEnv(5, **arguments)
    assert_same(one.reset(seed=1), other.reset(seed=1))
    for given in actions(5, 40):
        assert_same(one.step(given), other.step(given))


def test_observations_are_copies_unless_they_need_not_be():
    for copy in (True, False):
        envs = NavigationVectorEnv(5, copy=copy, **task())
        envs.reset(seed=1)
        first, second = (envs.step(given)[0]["ranges"] for given in actions(5, 2))
        assert np.shares_memory(first, second) is not copy


def test_gymnasium_makes_them_by_name():
    envs = gymnasium.make_vec(ID, num_envs=4, **task())
    assert isinstance(envs, NavigationVectorEnv) and envs.num_envs == 4
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert repr(envs) == f"NavigationVectorEnv({ID}, num_envs=4)"
    envs = gymnasium.make_vec(ID, num_envs=2, autoreset_mode="SameStep", **task())
    assert envs.autoreset_mode is AutoresetMode.SAME_STEP


def test_a_step_ends_at_goal_contact_or_time():
    """The parts of the reward are what the poses say."""
    weights = {"progress": 2.0, "goal": 5.0, "contact": -3.0, "time": -0.5, "turning": -0.25}
    envs = NavigationVectorEnv(50, autoreset_mode="Disabled", **task(rewards=weights, noise=None, max_velocity=(0.5, 1.0)))
    before, _ = envs.reset(seed=2)
    age, ends = np.zeros(50, int), np.zeros(3, int)
    for given in actions(50, 70):
        after, rewards, terminated, truncated, info = envs.step(given)
        parts = info["reward_parts"]
        progress = 2.0 * (before["goal"][:, 0] - after["goal"][:, 0])
        np.testing.assert_allclose(parts["progress"], progress, atol=1e-5)
        reached = (after["goal"][:, 0] <= 0.45) & ~info["contact"]
        assert np.array_equal(info["is_success"], reached)
        assert np.array_equal(terminated, reached | info["contact"])
        age += 1
        assert np.array_equal(truncated, ~terminated & (age == 30))
        np.testing.assert_allclose(parts["goal"], 5.0 * reached)
        np.testing.assert_allclose(parts["contact"], -3.0 * info["contact"])
        np.testing.assert_allclose(parts["time"], -0.05)
        np.testing.assert_allclose(parts["turning"], -0.025 * np.abs(after["velocity"][:, 1]), rtol=1e-6)
        names = ("progress", "goal", "contact", "time", "turning")
        np.testing.assert_allclose(rewards, sum(parts[name] for name in names), rtol=1e-12)
        ends += [reached.sum(), info["contact"].sum(), truncated.sum()]
        if (ended := terminated | truncated).any():
            after, _ = envs.reset(options={"reset_mask": ended})
            age[ended] = 0
        before = after
    assert (ends >= 5).all()


def test_a_pickled_one_goes_on_as_the_original():
    envs = NavigationVectorEnv(4, **task(randomisation={"slip": (0.0, 0.5)}))
    envs.reset(seed=3)
    moves = actions(4, 60)
    for given in moves[:10]:
        envs.step(given)
    copy = pickle.loads(pickle.dumps(envs))
    for given in moves[10:]:
        assert_same(envs.step(given), copy.step(given))


def test_closing_twice_is_allowed_and_a_step_after_that_is_not():
    envs = NavigationVectorEnv(2, **task())
    envs.reset(seed=1)
    envs.close()
    envs.close()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="got a call after close"):
        envs.step(np.zeros((2, 2), np.float32))
    with pytest.raises(gymnasium.error.ClosedEnvironmentError):
        envs.reset()


def test_a_bad_action_is_named_and_changes_nothing():
    envs, other = NavigationVectorEnv(3, **task()), NavigationVectorEnv(3, **task())
    for each in (envs, other):
        each.reset(seed=1)
    bad = np.zeros((3, 2), np.float32)
    bad[1, 1] = np.nan
    for given, kind, message in [
        (bad, ValueError, r"actions must be finite, got \[0.0, nan\] for environment 1"),
        (np.zeros((3, 3)), ValueError, r"actions must have shape \(3, 2\), got \(3, 3\)"),
        (np.zeros(3), ValueError, r"actions must have shape \(3, 2\), got \(3,\)"),
        (np.full((3, 2), "x"), TypeError, "actions must be an array of real numbers, got <U1"),
        ([[0, 0], [0, None], [0, 0]], TypeError, "actions must be an array of real numbers, got object"),
        ([[0, 0], [0], [0, 0]], ValueError, r"actions must have shape \(3, 2\), got rows of different lengths"),
    ]:
        with pytest.raises(kind, match=message):
            envs.step(given)
    given = np.full((3, 2), 0.5)
    assert_same(envs.step(given), other.step(given))
    assert_same(envs.step(given * 10.0), other.step(given * 2.0))  # cut to 1


@pytest.mark.parametrize(
    "arguments, kind, message",
    [
        ({"num_envs": 0}, ValueError, "num_envs must be at least 1, got 0"),
        ({"num_envs": 2.5}, TypeError, "num_envs must be an integer, got 2.5"),
        ({"render_mode": "human"}, ValueError, "render_mode must be 'rgb_array' or None, got 'human'"),
        ({"autoreset_mode": "Never"}, ValueError, "one of 'NextStep', 'SameStep', 'Disabled', got 'Never'"),
        ({"speed": 1.0}, TypeError, "unexpected keyword argument 'speed'"),
        ({"threads": 0}, ValueError, r"threads must be in 1\.\.1024, got 0"),
        ({"threads": "two"}, TypeError, "threads must be an integer, got str"),
    ],
)
def test_bad_arguments(arguments, kind, message):
    with pytest.raises(kind, match=message):
        NavigationVectorEnv(**{"num_envs": 2, **task(), **arguments})


def test_bad_resets():
    envs = NavigationVectorEnv(2, **task())
    with pytest.raises(gymnasium.error.ResetNeeded, match="before their first step"):
        envs.step(np.zeros((2, 2)))
    with pytest.raises(gymnasium.error.ResetNeeded, match="the first reset must be one of all"):
        envs.reset(options={"reset_mask": np.array([True, False])})
    with pytest.raises(ValueError, match="a seed for each of 2 environments, got 3"):
        envs.reset(seed=[1, 2, 3])
    with pytest.raises(ValueError, match="a seed must be at least 0, got -5 for environment 0"):
        envs.reset(seed=-5)
    with pytest.raises(ValueError, match="a seed must be at least 0, got -2 for environment 1"):
        envs.reset(seed=[3, -2])
    for seed in ("a", 1.5, [1, 2.5]):
        with pytest.raises(TypeError, match="seed must be an integer, a list of integers and None, or None, got"):
            envs.reset(seed=seed)
    with pytest.raises(TypeError, match="options must be a dict or None, got 'all'"):
        envs.reset(options="all")
    with pytest.raises(ValueError, match=r"shape \(2,\), got \(3,\)"):
        envs.reset(options={"reset_mask": np.ones(3, bool)})
    with pytest.raises(TypeError, match=r"array of bool, got \[True, False\]"):
        envs.reset(options={"reset_mask": [True, False]})
    with pytest.raises(ValueError, match="at least one environment, got none"):
        envs.reset(options={"reset_mask": np.zeros(2, bool)})


def test_pictures():
    envs = NavigationVectorEnv(5, render_mode="rgb_array", **task())
    envs.reset(seed=1)
    frames = envs.render()
    assert len(frames) == 5 and {frame.shape for frame in frames} == {(256, 256, 3)}
    sheet = envs.render_grid()
    assert sheet.shape == (512, 768, 3)
    assert np.array_equal(sheet[256:, 256:512], frames[4]) and (sheet[256:, 512:] == 255).all()
    assert envs.render_grid(1).shape == (256, 256, 3)
    assert NavigationVectorEnv(1, **task()).render() is None
    with pytest.raises(ValueError, match="count must be at least 1, got 0"):
        envs.render_grid(0)


def test_a_package_without_gymnasium_says_what_is_missing():
    code = "import sys; sys.modules['gymnasium'] = None; import mobile_robot_simulator.learning"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert "learning needs gymnasium: pip install 'mobile-robot-simulator[learning]'" in done.stderr


def test_thousands_fit_into_one_call():
    envs = gymnasium.make_vec(ID, num_envs=2000, worlds=training_plans(2, size=(10.0, 8.0)))
    observations, _ = envs.reset(seed=1)
    assert observations in envs.observation_space
    observations, *_ = envs.step(np.zeros((2000, 2), np.float32))
    assert observations in envs.observation_space
    assert room().shape == (30, 40)
