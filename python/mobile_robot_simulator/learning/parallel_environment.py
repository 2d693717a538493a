"""Several robots that learn to navigate in one world, as a parallel environment of PettingZoo."""

from __future__ import annotations

from collections.abc import Mapping
from operator import index
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from ..quoting import quoted
from .actions import checked_actions
from .batch import Batch
from .environment import Observation, checked_render_mode
from .frame import frame_of
from .spaces import action_space, observation_space
from .task import NavigationTask

try:
    from pettingzoo import ParallelEnv
except ImportError as error:
    raise ImportError(
        "learning.NavigationParallelEnv needs pettingzoo: pip install 'mobile-robot-simulator[learning]'"
    ) from error

Steps = tuple[dict[str, Observation], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]
"""Observations, rewards, whether episodes have ended, whether their time is over, and infos, by the name of the robot."""


class NavigationParallelEnv(ParallelEnv):  # type: ignore[misc]
    """Several robots in one world that see and touch each other, each on its way to a goal of its own.

    Observations, actions, rewards and infos of a robot are those of `NavigationEnv`. The robots are `robot_0`, `robot_1`
    and so on. One that has reached its goal, touched something or run out of time leaves `agents`, and stands where it is
    as an obstacle until the next `reset`. A robot that stands goes on if another one drives against it.

    Starts leave room for a robot at each of them, and so do goals. A start may be near to the goal of another robot.

    Args:
        robot_count: Number of robots, at least 1.
        render_mode: "rgb_array" for `render` to return frames; None for none.
        threads: Number of threads; None means one per core. The result does not depend on it.
        **task: What the robots do: the arguments of `NavigationTask`, without `obstacles`.

    Raises:
        ValueError: An argument is out of range, there are obstacles, or a world has no room for the robots and their goals.
        TypeError: An argument is unknown or has the wrong type.

    Example:
        >>> env = NavigationParallelEnv(3)
        >>> observations, infos = env.reset(seed=1)
        >>> actions = {agent: np.array([1.0, 0.0], np.float32) for agent in env.agents}
        >>> observations, rewards, terminations, truncations, infos = env.step(actions)
        >>> env.agents, observations["robot_2"]["ranges"].shape
        (['robot_0', 'robot_1', 'robot_2'], (64,))
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 (as in PettingZoo)
        "name": "navigation_v0",
        "render_modes": ["rgb_array"],
        "is_parallelizable": True,
    }

    def __init__(
        self, robot_count: int = 2, *, render_mode: str | None = None, threads: int | None = 1, **task: Any
    ) -> None:
        try:
            count = index(robot_count)
        except TypeError:
            raise TypeError(f"robot_count must be an integer, got {quoted(robot_count)}") from None
        if count < 1:
            raise ValueError(f"robot_count must be at least 1, got {count}")
        self.task = NavigationTask(**task)
        if self.task.obstacles is not None:
            raise ValueError(f"robots that share a world must have no obstacles, got {quoted(self.task.obstacles)}")
        self.render_mode = checked_render_mode(render_mode)
        self.metadata = {**self.metadata, "render_fps": 1.0 / self.task.duration}
        self.possible_agents = [f"robot_{robot}" for robot in range(count)]
        self.agents: list[str] = []
        self.observation_spaces = {agent: observation_space(self.task) for agent in self.possible_agents}
        self.action_spaces = {agent: action_space(self.task) for agent in self.possible_agents}
        self._batch = Batch(self.task, count, threads, is_shared=True)
        self._is_closed = False

    def observation_space(self, agent: str) -> spaces.Dict:
        """Returns the space of the observations of a robot."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Box:
        """Returns the space of the actions of a robot."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begins an episode of all robots: a world, starts and goals drawn at random.

        Args:
            seed: Seed of all that is random from now on. None means that the draws go on.
            options: Not used.

        Returns:
            The observations and the infos, by the name of the robot.

        Raises:
            ValueError: There was no room for the robots or their goals in many draws.
            gymnasium.error.ClosedEnvironmentError: The environment is closed.
        """
        self._check_open()
        count = len(self.possible_agents)
        if seed is not None or not self._batch.generators:
            self._batch.generators = [gymnasium.utils.seeding.np_random(seed)[0]] * count
        self._batch.reset(np.ones(count, np.bool_))
        self.agents = self.possible_agents[:]
        poses = self._batch.fleet.poses
        return self._observations(), {agent: {"pose": poses[robot]} for robot, agent in enumerate(self.agents)}

    def step(self, actions: Mapping[str, NDArray[np.float32]]) -> Steps:
        """Drives all robots of `agents` for one step.

        Args:
            actions: For each robot of `agents`, (2,) or (3,), the share of the largest velocity along each axis.

        Returns:
            The observations, the rewards, whether episodes have ended, whether their time is over, and the infos, by the
            name of the robot. Robots whose episodes end in this step are included.

        Raises:
            ValueError: The actions are not those of `agents`, have the wrong shape, or are not finite.
            TypeError: The actions are no dict of arrays of numbers.
            gymnasium.error.ResetNeeded: No robot is left, or `reset` was never called.
            gymnasium.error.ClosedEnvironmentError: The environment is closed.
        """
        self._check_open()
        if not self.agents:
            raise gymnasium.error.ResetNeeded("the environment must be reset before a step, got a step without agents")
        outcome = self._batch.step(self._commands(actions))
        observations, poses = self._observations(), self._batch.fleet.poses
        live = {agent: self.possible_agents.index(agent) for agent in self.agents}
        rewards = {agent: float(outcome.rewards[robot]) for agent, robot in live.items()}
        terminations = {agent: bool(outcome.terminated[robot]) for agent, robot in live.items()}
        truncations = {agent: bool(outcome.truncated[robot]) for agent, robot in live.items()}
        infos = {agent: {"pose": poses[robot], **outcome.info(robot)} for agent, robot in live.items()}
        ended = [agent for agent in live if terminations[agent] or truncations[agent]]
        if ended:
            self._batch.stop(np.array([agent in ended for agent in self.possible_agents]))
            self.agents = [agent for agent in self.agents if agent not in ended]
        return observations, rewards, terminations, truncations, infos

    def render(self) -> NDArray[np.uint8] | None:
        """Returns a picture of the world with all robots, the scan and the goal of the first; None without a render mode."""
        self._check_open()
        return None if self.render_mode is None else frame_of(self._batch, 0)

    def close(self) -> None:
        """Closes the environment: no other method may be called then. It may be closed twice."""
        self._is_closed = True

    def _commands(self, actions: Mapping[str, NDArray[np.float32]]) -> NDArray[np.float64]:
        """Returns the actions of all robots, (N, A). A robot whose episode has ended has zeros."""
        if not isinstance(actions, Mapping):
            raise TypeError(f"actions must be a dict, got {quoted(actions)}")
        if set(actions) != set(self.agents):
            raise ValueError(f"actions must be those of {', '.join(self.agents)}, got {quoted(list(actions))}")
        shape = (1, len(self.task.max_velocity))
        commands = np.zeros((len(self.possible_agents), shape[1]))
        for agent, action in actions.items():
            try:
                commands[self.possible_agents.index(agent)] = checked_actions([action], shape, None)[0]
            except (TypeError, ValueError) as error:
                raise type(error)(f"{agent}: {error}") from None
        return commands

    def _observations(self) -> dict[str, Observation]:
        """Returns the observations of the robots of `agents`."""
        observations = self._batch.observations()
        self._batch.release()
        return {
            agent: {name: values[robot] for name, values in observations.items()}
            for robot, agent in enumerate(self.possible_agents)
            if agent in self.agents
        }

    def _check_open(self) -> None:
        if self._is_closed:
            raise gymnasium.error.ClosedEnvironmentError("the environment must be open, got a call after close()")
