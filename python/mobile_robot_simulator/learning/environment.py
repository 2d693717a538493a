"""One robot that learns to navigate, as an environment of Gymnasium."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted
from .actions import checked_actions
from .batch import Batch
from .frame import frame_of
from .spaces import action_space, observation_space
from .task import NavigationTask

Observation = dict[str, NDArray[np.float32]]


class NavigationEnv(gymnasium.Env[Any, Any]):
    """A robot that drives to a goal without touching anything.

    An observation has the `ranges` of the scanner [m], the `goal` as distance and bearing [m, rad] in the robot's
    frame, and the `velocity` in the robot's frame, along the axes of the actions [m/s, rad/s]. An action has a share of
    the largest velocity for each axis, -1 to 1; larger ones are cut. An episode ends (terminated) at the goal or at
    contact, and is cut off (truncated) at the time limit.

    `info` has the `pose` of the robot in the map frame [m, m, rad]; after a step also whether it touched something
    (`contact`), whether it reached the goal (`is_success`), and each part of the reward with its weight
    (`reward_parts`).

    Environment i of a `NavigationVectorEnv` that is reset with a seed is this environment reset with `seed + i`, byte
    by byte.

    Args:
        render_mode: "rgb_array" for `render` to return frames; None for none.
        threads: Number of threads; None means one per core.
        **task: What the robot does: the arguments of `NavigationTask`.

    Raises:
        ValueError: An argument is out of range, or a world has no goal that the robot can reach.
        TypeError: An argument is unknown or has the wrong type.

    Example:
        >>> env = NavigationEnv(max_velocity=(0.5, 1.0))
        >>> observation, info = env.reset(seed=1)
        >>> observation, reward, terminated, truncated, info = env.step(np.array([1.0, 0.0], np.float32))
        >>> sorted(info)
        ['contact', 'is_success', 'pose', 'reward_parts']
        >>> observation["velocity"]
        array([0.5, 0. ], dtype=float32)
    """

    metadata = {"render_modes": ["rgb_array"]}  # noqa: RUF012 (as in Gymnasium)

    def __init__(self, *, render_mode: str | None = None, threads: int | None = 1, **task: Any) -> None:
        self.task = NavigationTask(**task)
        self.render_mode = checked_render_mode(render_mode)
        self.metadata = {**self.metadata, "render_fps": 1.0 / self.task.duration}
        self.observation_space = observation_space(self.task)
        self.action_space = action_space(self.task)
        self._batch = Batch(self.task, 1, threads)
        self._is_closed = False

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode: a world, a start and a goal drawn at random.

        Args:
            seed: Seed of all that is random from now on. None means that the draws go on.
            options: Not used.

        Returns:
            The observation, and `info`.

        Raises:
            gymnasium.error.ClosedEnvironmentError: The environment is closed.
        """
        self._check_open()
        super().reset(seed=seed)
        self._batch.generators = [self.np_random]
        self._batch.reset(np.array([True]))
        return self._observation(), {"pose": self._batch.fleet.poses[0]}

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drives for one step.

        Args:
            action: (2,) or (3,), the share of the largest velocity along each axis.

        Returns:
            The observation, the reward, whether the episode has ended, whether its time is over, and `info`.

        Raises:
            ValueError: The action has the wrong shape, or is not finite.
            TypeError: The action is no array of numbers.
            gymnasium.error.ResetNeeded: `reset` was never called.
            gymnasium.error.ClosedEnvironmentError: The environment is closed.
        """
        self._check_open()
        if not self._batch.generators:
            raise gymnasium.error.ResetNeeded("the environment must be reset before its first step, got a step")
        shape = (1, len(self.task.max_velocity))
        outcome = self._batch.step(checked_actions(np.asarray(action)[None], shape, None))
        info = {"pose": self._batch.fleet.poses[0], **outcome.info(0)}
        terminated, truncated = bool(outcome.terminated[0]), bool(outcome.truncated[0])
        return self._observation(), float(outcome.rewards[0]), terminated, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """Returns a picture of world, robot, scan and goal, (256, 256, 3) uint8; None without a render mode."""
        self._check_open()
        return None if self.render_mode is None else frame_of(self._batch, 0)

    def close(self) -> None:
        """Closes the environment: no other method may be called then. It may be closed twice."""
        self._is_closed = True

    def _check_open(self) -> None:
        if self._is_closed:
            raise gymnasium.error.ClosedEnvironmentError("the environment must be open, got a call after close()")

    def _observation(self) -> Observation:
        observations = self._batch.observations()
        self._batch.release()
        return {name: values[0] for name, values in observations.items()}


def checked_render_mode(render_mode: str | None) -> str | None:
    """Returns the mode.

    Raises:
        ValueError: It is unknown.
    """
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f"render_mode must be 'rgb_array' or None, got {quoted(render_mode)}")
    return render_mode
