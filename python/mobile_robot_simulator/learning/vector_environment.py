"""Many robots that learn to navigate, as a vector environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Sequence
from operator import index
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ..quoting import quoted
from .actions import checked_actions
from .batch import Batch, Observations, Outcome
from .environment import checked_render_mode
from .frame import frame_of, grid_of
from .spaces import action_space, observation_space
from .task import PARTS, NavigationTask

Flags = NDArray[np.bool_]


class NavigationVectorEnv(VectorEnv[Observations, NDArray[np.float32], NDArray[Any]]):
    """Many environments like `NavigationEnv`, stepped together in one call of the core.

    Observations, rewards and `info` are those of a `gymnasium.vector.SyncVectorEnv` of as many `NavigationEnv`, for
    each of the autoreset modes, byte by byte.

    Args:
        num_envs: Number of environments, at least 1.
        autoreset_mode: When an episode that has ended is followed by another: `NEXT_STEP` (in the next step, which
            ignores the action), `SAME_STEP` (at once; `info` has `final_obs` and `final_info`), or `DISABLED` (by
            `reset(options={"reset_mask": mask})`).
        render_mode: "rgb_array" for `render` to return frames; None for none.
        copy: Whether each observation has arrays of its own. With False, the next step writes its ranges where the last
            ones were, which takes less time.
        threads: Number of threads; None means one per core. The result does not depend on it.
        **task: What the robots do: the arguments of `NavigationTask`.

    Raises:
        ValueError: An argument is out of range, or a world has no goal that the robot can reach.
        TypeError: An argument is unknown or has the wrong type.

    Example:
        >>> envs = NavigationVectorEnv(num_envs=3)
        >>> observations, info = envs.reset(seed=1)
        >>> observations, rewards, terminations, truncations, info = envs.step(np.zeros((3, 2), np.float32))
        >>> rewards.round(2), info["reward_parts"]["time"]
        (array([-0.01, -0.01, -0.01]), array([-0.01, -0.01, -0.01]))
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012 (as in Gymnasium)

    def __init__(
        self,
        num_envs: int = 1,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        copy: bool = True,
        threads: int | None = None,
        **task: Any,
    ) -> None:
        try:
            count = index(num_envs)
        except TypeError:
            raise TypeError(f"num_envs must be an integer, got {quoted(num_envs)}") from None
        if count < 1:
            raise ValueError(f"num_envs must be at least 1, got {count}")
        self.autoreset_mode = _checked_mode(autoreset_mode)
        self.task = NavigationTask(**task)
        self.num_envs = count
        self.render_mode = checked_render_mode(render_mode)
        self.metadata = {
            **self.metadata,
            "render_fps": 1.0 / self.task.duration,
            "autoreset_mode": self.autoreset_mode,
        }
        self.single_observation_space = observation_space(self.task)
        self.single_action_space = action_space(self.task)
        self.observation_space = batch_space(self.single_observation_space, count)
        self.action_space = batch_space(self.single_action_space, count)
        self._copy = copy
        self._batch = Batch(self.task, count, threads)
        self._ended = np.zeros(count, np.bool_)
        self._every = np.ones(count, np.bool_)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seed of each environment."""
        return tuple(self._batch.generator_seeds)

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """The generator of each environment."""
        return tuple(self._batch.generators)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins an episode in all environments, or in some of them.

        Args:
            seed: Seeds of all that is random from now on: one for each environment, or a number for seed, seed + 1 and
                so on. None means that the draws go on.
            options: `{"reset_mask": mask}` resets only those environments for which the mask, (N,) bool, is true.

        Returns:
            The observations of all environments, and `info`.

        Raises:
            ValueError: There are not as many seeds as environments, a seed is negative, or the mask has the wrong shape
                or is true nowhere.
            TypeError: A seed is no integer, or the mask is no array of bool.
            gymnasium.error.ClosedEnvironmentError: The environment is closed.
        """
        self._check_open()
        if not isinstance(options, (dict, type(None))):
            raise TypeError(f"options must be a dict or None, got {quoted(options)}")
        mask = self._mask((options or {}).get("reset_mask"))
        self._batch.seed(self._seeds(seed), mask)
        self._batch.reset(mask)
        self._ended[mask] = False
        return self._observations(), _grouped({"pose": self._batch.fleet.poses}, mask.copy(), np.flatnonzero(~mask))

    def step(self, actions: NDArray[np.float32]) -> tuple[Observations, NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """Drives all robots for one step.

        Args:
            actions: (N, 2) or (N, 3), for each robot the share of the largest velocity along each axis.

        Returns:
            The observations, the rewards (N,), whether each episode has ended, whether its time is over, and `info`.

        Raises:
            ValueError: The actions have the wrong shape, or are not finite.
            TypeError: The actions are no array of numbers.
            gymnasium.error.ResetNeeded: An environment must be reset first.
            gymnasium.error.ClosedEnvironmentError: The environment is closed.
        """
        self._check_open()
        if not self._batch.generators:
            raise gymnasium.error.ResetNeeded("the environments must be reset before their first step, got a step")
        assert self.action_space.shape is not None
        commands = checked_actions(actions, self.action_space.shape)
        resting = self._ended
        if self.autoreset_mode is AutoresetMode.DISABLED and resting.any():
            first = int(resting.argmax())
            raise gymnasium.error.ResetNeeded(
                f"episodes that have ended must be reset with options={{'reset_mask': mask}} before a step, "
                f"got {int(resting.sum())} that have not, the first in environment {first}"
            )
        outcome = self._batch.step(commands)
        rewards, terminated, truncated = outcome.rewards, outcome.terminated, outcome.truncated
        info: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            started = terminated | truncated
            (which,) = started.nonzero()
            if len(which):
                info |= self._final(outcome, started)
        else:
            started = resting
            (which,) = started.nonzero()
            if len(which):
                rewards[which], terminated[which], truncated[which] = 0.0, False, False
            self._ended = terminated | truncated
        info |= _grouped(_judgement(outcome), ~started, which)
        if len(which):
            self._batch.reset(started)
        info |= {"pose": self._batch.fleet.poses, "_pose": self._every.copy()}
        return self._observations(), rewards, terminated, truncated, info

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Returns a picture of each environment, (256, 256, 3) uint8; None without a render mode."""
        self._check_open()
        return None if self.render_mode is None else tuple(frame_of(self._batch, index) for index in range(self.num_envs))

    def render_grid(self, count: int = 16) -> NDArray[np.uint8]:
        """Returns one picture of many environments: the frames of the first ones, side by side in rows.

        Args:
            count: Number of environments to show; all if there are fewer.

        Returns:
            (H, W, 3) uint8.

        Raises:
            ValueError: `count` is less than 1.
        """
        self._check_open()
        if index(count) < 1:
            raise ValueError(f"count must be at least 1, got {count}")
        return grid_of([frame_of(self._batch, index) for index in range(min(count, self.num_envs))])

    def _observations(self) -> Observations:
        observations = self._batch.observations()
        if self._copy:
            self._batch.release()
        return observations

    def _final(self, outcome: Outcome, ended: Flags) -> dict[str, Any]:
        """Returns the observations and the info with which episodes have ended."""
        observations = self._batch.observations()
        last = np.full(self.num_envs, None, dtype=object)
        for which in np.flatnonzero(ended):
            last[which] = {name: values[which].copy() for name, values in observations.items()}
        info = {name: values.copy(order="K") for name, values in _judgement(outcome).items()}
        info["pose"] = self._batch.fleet.poses
        return {
            "final_obs": last,
            "_final_obs": ended.copy(),
            "final_info": _grouped(info, ended.copy(), np.flatnonzero(~ended)),
            "_final_info": ended.copy(),
        }

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        seeds: list[int | None]
        try:
            if isinstance(seed, (Sequence, np.ndarray)):
                seeds = [None if each is None else index(each) for each in seed]
            else:
                seeds = [index(seed) + offset for offset in range(self.num_envs)]
        except TypeError:
            raise TypeError(f"seed must be an integer, a list of integers and None, or None, got {quoted(seed)}") from None
        if len(seeds) != self.num_envs:
            raise ValueError(f"there must be a seed for each of {self.num_envs} environments, got {len(seeds)}")
        for which, each in enumerate(seeds):
            if each is not None and each < 0:
                raise ValueError(f"a seed must be at least 0, got {each} for environment {which}")
        return seeds

    def _mask(self, mask: Any) -> Flags:
        if mask is None:
            return np.ones(self.num_envs, np.bool_)
        if not (isinstance(mask, np.ndarray) and mask.dtype == np.bool_):
            raise TypeError(f"reset_mask must be an array of bool, got {quoted(mask)}")
        if mask.shape != (self.num_envs,):
            raise ValueError(f"reset_mask must have shape ({self.num_envs},), got {mask.shape}")
        if not mask.any():
            raise ValueError("reset_mask must be true for at least one environment, got none")
        if not self._batch.generators and not mask.all():
            raise gymnasium.error.ResetNeeded("the first reset must be one of all environments, got a reset_mask of some")
        return mask

    def _check_open(self) -> None:
        if self.closed:
            raise gymnasium.error.ClosedEnvironmentError("the environment must be open, got a call after close()")


def _checked_mode(mode: AutoresetMode | str) -> AutoresetMode:
    try:
        return AutoresetMode(mode)
    except ValueError:
        names = ", ".join(repr(each.value) for each in AutoresetMode)
        raise ValueError(f"autoreset_mode must be one of {names}, got {quoted(mode)}") from None


def _judgement(outcome: Outcome) -> dict[str, Any]:
    return {"contact": outcome.contacts, "is_success": outcome.reached, "reward_parts": outcome.parts.T}


def _grouped(info: dict[str, NDArray[Any]], mask: Flags, others: NDArray[np.intp]) -> dict[str, Any]:
    """Returns info as Gymnasium has it: the values of the environments of the mask, 0 for the others, and the mask.

    Each array has a row for each environment. It is changed in place.
    """
    if len(others) == len(mask):
        return {}
    grouped: dict[str, Any] = {}
    for name, values in info.items():
        if len(others):
            values[others] = 0
        grouped[name], grouped[f"_{name}"] = values, mask
    if (parts := grouped.get("reward_parts")) is not None:
        named = zip(PARTS, parts.T, strict=True)
        grouped["reward_parts"] = {key: value for name, part in named for key, value in ((name, part), (f"_{name}", mask))}
    return grouped
