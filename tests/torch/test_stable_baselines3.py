"""stable_baselines3: the adapter equals Stable-Baselines3's own loop over single environments, and trains with it."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor

from learning.rooms import actions, assert_same, task
from mobile_robot_simulator.learning import NavigationEnv, NavigationVectorEnv
from mobile_robot_simulator.learning.stable_baselines3 import StableBaselinesVecEnv

COUNT, STEPS, SEED = 7, 120, 5


def adapted(count: int = COUNT, **changes: object) -> StableBaselinesVecEnv:
    return StableBaselinesVecEnv(NavigationVectorEnv(count, autoreset_mode="SameStep", **task(**changes)))


def assert_same_values(one: object, other: object) -> None:
    """Like `assert_same`, but a number of NumPy is also the number that it holds."""
    if isinstance(one, dict):
        assert isinstance(other, dict) and sorted(one) == sorted(other)
        for name in one:
            assert_same_values(one[name], other[name])
    elif isinstance(one, np.ndarray):
        assert_same(one, other)
    else:
        assert one == other


def test_it_is_what_the_loop_of_stable_baselines3_is():
    ours, loop = adapted(), DummyVecEnv([lambda: NavigationEnv(**task())] * COUNT)
    assert ours.observation_space == loop.observation_space and ours.action_space == loop.action_space
    assert ours.num_envs == loop.num_envs and ours.render_mode == loop.render_mode
    ends = np.zeros(2, int)
    for turn in range(2):
        if turn == 0:  # the second turn goes on with the same draws
            assert ours.seed(SEED) == loop.seed(SEED)
        assert_same(ours.reset(), dict(loop.reset()))
        assert_same_values(ours.reset_infos[-1], loop.reset_infos[-1])
        for given in actions(COUNT, STEPS):
            (seen, rewards, dones, infos), theirs = ours.step(given), loop.step(given)
            assert_same((seen, rewards, dones), (dict(theirs[0]), *theirs[1:3]))
            for index in range(COUNT):
                assert_same_values(infos[index], theirs[3][index] if dones[index] else {})
                assert_same_values(ours.reset_infos[index], loop.reset_infos[index])
            cut = [info["TimeLimit.truncated"] for info in infos if info]
            ends += [sum(cut), len(cut) - sum(cut)]
    assert (ends >= 5).all()


def test_observations_are_those_of_the_environments_without_a_copy(monkeypatch):
    envs, returned = adapted(), []
    for name in ("reset", "step"):
        method = getattr(envs.envs, name)
        monkeypatch.setattr(
            envs.envs, name, lambda *given, method=method, **named: returned.append(method(*given, **named)) or returned[-1]
        )
    seen = [envs.reset(), envs.step(actions(COUNT, 1)[0])[0]]
    assert all(mine[name] is theirs[0][name] for mine, theirs in zip(seen, returned, strict=True) for name in mine)


def test_the_next_step_leaves_observations_as_they_are():
    envs = adapted()
    envs.seed(1)
    first = envs.reset()["ranges"]
    kept = first.copy()
    second = envs.step(actions(COUNT, 1)[0])[0]["ranges"]
    assert np.array_equal(first, kept) and not np.shares_memory(first, second)


def test_ppo_learns_from_it_the_same_for_a_seed():
    def trained() -> PPO:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # PPO suggests another size of its batches
            policy = {"net_arch": [8]}
            model = PPO("MultiInputPolicy", VecMonitor(adapted()), n_steps=32, policy_kwargs=policy, seed=3, device="cpu")
        return model.learn(3 * 32 * COUNT)

    one, other = trained(), trained()
    assert len(one.ep_info_buffer) > 5 and {"r", "l", "t"} <= set(one.ep_info_buffer[0])
    assert len(one.ep_success_buffer) == len(one.ep_info_buffer)
    for mine, theirs in zip(one.policy.parameters(), other.policy.parameters(), strict=True):
        assert np.array_equal(mine.detach().numpy(), theirs.detach().numpy())
    returns, lengths = evaluate_policy(one, VecMonitor(adapted(3)), n_eval_episodes=5, return_episode_rewards=True)
    assert len(returns) == len(lengths) == 5


def test_pictures():
    envs = StableBaselinesVecEnv(NavigationVectorEnv(3, autoreset_mode="SameStep", render_mode="rgb_array", **task()))
    envs.reset()
    assert envs.render_mode == "rgb_array" and envs.render().shape == (512, 512, 3)
    assert adapted(2).get_images() == [None, None]


def test_what_it_refuses():
    with pytest.raises(ValueError, match="autoreset_mode='SameStep', got 'NextStep'"):
        StableBaselinesVecEnv(NavigationVectorEnv(2, **task()))
    with pytest.raises(TypeError, match="envs must be a NavigationVectorEnv, got"):
        StableBaselinesVecEnv(NavigationEnv(**task()))
    envs = adapted(2)
    assert envs.get_attr("num_envs", [1]) == [2] and not envs.has_attr("wings")
    assert envs.env_is_wrapped(VecMonitor) == [False, False]
    with pytest.raises(TypeError, match="cannot be set; got 'task'"):
        envs.set_attr("task", None)
    with pytest.raises(TypeError, match="have no methods, got 'fly'"):
        envs.env_method("fly")
    envs.close()
    envs.close()
