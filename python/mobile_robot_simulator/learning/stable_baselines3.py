"""The vector environment of navigation as one of Stable-Baselines3. Importing this module needs that package."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NoReturn

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from ..quoting import quoted
from .vector_environment import NavigationVectorEnv

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    raise ImportError("learning.stable_baselines3 needs stable-baselines3: pip install stable-baselines3") from error

Indices = int | Sequence[int] | None


class StableBaselinesVecEnv(VecEnv):  # type: ignore[misc]
    """The environments of a `NavigationVectorEnv` for the algorithms of Stable-Baselines3.

    The observations are the arrays of the environments, without a copy. All else is what a `DummyVecEnv` of as many
    `NavigationEnv` returns, with one difference: the info of an environment is empty, except in the step that ends its
    episode. Wrap it in a `VecMonitor` to have the returns and the lengths of the episodes logged.

    Args:
        envs: The environments, made with `autoreset_mode="SameStep"`.

    Raises:
        TypeError: `envs` is no `NavigationVectorEnv`.
        ValueError: It has another autoreset mode.
    """

    def __init__(self, envs: NavigationVectorEnv) -> None:
        if not isinstance(envs, NavigationVectorEnv):
            raise TypeError(f"envs must be a NavigationVectorEnv, got {quoted(envs)}")
        if envs.autoreset_mode is not AutoresetMode.SAME_STEP:
            raise ValueError(f"envs must be made with autoreset_mode='SameStep', got '{envs.autoreset_mode.value}'")
        self.envs = envs
        self._actions: Any = None
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> dict[str, NDArray[np.float32]]:
        """Begins an episode in each environment, with the seeds of `seed` if it was called since the last reset.

        Returns:
            The observations, one row for each environment.
        """
        observations, info = self.envs.reset(seed=self._seeds)
        self._reset_seeds()
        self._reset_options()
        self.reset_infos = [{"pose": pose} for pose in info["pose"]]
        return observations

    def step_async(self, actions: NDArray[np.float32]) -> None:
        """Takes the actions (N, A) of the next step."""
        self._actions = actions

    def step_wait(
        self,
    ) -> tuple[dict[str, NDArray[np.float32]], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Drives all robots for one step; those whose episode ends begin another one.

        Returns:
            The observations, the rewards (N,), whether each episode has ended (N,), and an info for each environment. The
            info of an episode that has ended has what `NavigationEnv.step` returned, `terminal_observation`, and
            `TimeLimit.truncated`.
        """
        observations, rewards, terminated, truncated, info = self.envs.step(self._actions)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        ended = terminated | truncated
        for index in np.flatnonzero(ended).tolist():
            infos[index] = {
                **_of_one(info["final_info"], index),
                "terminal_observation": info["final_obs"][index],
                "TimeLimit.truncated": bool(truncated[index]),
            }
            self.reset_infos[index] = {"pose": info["pose"][index]}
        return observations, rewards.astype(np.float32), ended, infos

    def close(self) -> None:
        """Closes the environments. May be called twice."""
        self.envs.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Returns a picture of each environment; None for each without a render mode."""
        return self.envs.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """Returns an attribute of the vector environment, once for each of the indices."""
        return [getattr(self.envs, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> NoReturn:
        """Refuses: the environments share their attributes.

        Raises:
            TypeError: Always.
        """
        raise TypeError(f"environments of one fleet share their attributes, which cannot be set; got {quoted(attr_name)}")

    def env_method(self, method_name: str, *method_args: Any, indices: Indices = None, **method_kwargs: Any) -> NoReturn:
        """Refuses: the environments have no methods of their own.

        Raises:
            TypeError: Always.
        """
        raise TypeError(f"environments of one fleet are stepped together and have no methods, got {quoted(method_name)}")

    def env_is_wrapped(self, wrapper_class: type, indices: Indices = None) -> list[bool]:
        """Returns False for each of the indices: no environment has a wrapper of its own."""
        return [False for _ in self._get_indices(indices)]


def _of_one(info: dict[str, Any], index: int) -> dict[str, Any]:
    """Returns the info of one environment from that of all of them."""
    return {
        name: _of_one(values, index) if isinstance(values, dict) else values[index]
        for name, values in info.items()
        if not name.startswith("_")
    }
