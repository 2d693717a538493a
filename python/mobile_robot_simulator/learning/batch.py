"""Many robots that do the same task, each in an episode of its own: what both environments are made of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .._core import Fleet, FleetStep, Shape, commands_from_actions, judge_steps
from .free_space import FreeSpace
from .moving_discs import MovingDiscs
from .task import PARTS, NavigationTask

Observations = dict[str, NDArray[np.float32]]
"""Observations of N environments: ranges (N, beam_count), goal (N, 2) and velocity (N, 2) or (N, 3)."""

BLOCKS = 64
"""Number of starts that are tried until there is a goal for one."""


class Outcome(NamedTuple):
    """What a step of N environments led to."""

    rewards: NDArray[np.float64]
    """Sum of the parts of the reward, (N,)."""
    parts: NDArray[np.float64]
    """Each part of the reward with its weight, (5, N), in the order of `PARTS`."""
    reached: NDArray[np.bool_]
    """Whether the goal was reached, (N,)."""
    contacts: NDArray[np.bool_]
    """Whether something was touched, (N,)."""
    truncated: NDArray[np.bool_]
    """Whether the time is over, (N,)."""

    @property
    def terminated(self) -> NDArray[np.bool_]:
        """Whether the episode has come to its end, (N,)."""
        return self.reached | self.contacts

    def info(self, index: int) -> dict[str, Any]:
        """Returns what one environment tells about the step."""
        return {
            "contact": bool(self.contacts[index]),
            "is_success": bool(self.reached[index]),
            "reward_parts": dict(zip(PARTS, self.parts[:, index].tolist(), strict=True)),
        }


class Batch:
    """N robots, each in an episode of its own.

    All that is random in an episode is drawn from the environment's generator, a fixed number of draws for each episode, so
    that an environment does the same whatever the others do.

    Args:
        task: What the robots do.
        count: Number of robots, at least 1.
        threads: Number of threads for moving and scanning; None means one per core.
        is_shared: Whether the robots share a world, so that they see and touch each other. Then they are reset together,
            and `task` has no obstacles.

    Raises:
        ValueError: A world has no free space, or a goal is nowhere as far from a start as it must be.
    """

    def __init__(self, task: NavigationTask, count: int, threads: int | None = None, *, is_shared: bool = False) -> None:
        self.task = task
        self.is_shared = is_shared
        self.generators: list[np.random.Generator] = []
        self.generator_seeds: list[int] = []
        self.goals = np.zeros((count, 2))
        self._threads = threads
        self._steps = np.zeros(count, np.int64)
        self._space = FreeSpace(task.grids, task.footprint.reach + task.clearance)
        self._axes = (0, 2) if len(task.max_velocity) == 2 else (0, 1, 2)
        self._commands = np.zeros((count, 3))
        self._step_limit = task.step_limit
        self._max_velocity = np.array(task.max_velocity)
        self._weights = [task.rewards[name] for name in PARTS]
        self._disturbances = [task.disturbed({})] * count
        self._seeds, self._worlds = np.zeros(count, np.uint64), np.zeros(count, np.intp)
        episode = task.step_limit * task.duration
        self._discs = None if task.obstacles is None else MovingDiscs(task.obstacles, self._space, episode)
        absent = [] if self._discs is None else self._discs.absent
        self._obstacles: list[tuple[Shape, NDArray[np.float64] | None, int]] = [
            (*disc, index) for index in range(count) for disc in absent
        ]
        probe = np.random.default_rng(0)
        for world in range(len(task.grids)):
            self._drawn([world] * (count if is_shared else 1), [probe] * count)
        self.fleet = self._new_fleet(np.zeros((count, 3)))
        self.fleet.scan(np.arange(count) == 0, threads=threads)  # refuses a wrong number of threads
        self._seen = np.zeros((count, 2))
        self._step: FleetStep | None = None
        self._ranges = np.zeros((count, task.laser.beam_count), np.float32)
        self._is_released = False

    def seed(self, seeds: Sequence[int | None], mask: NDArray[np.bool_]) -> None:
        """Gives new generators to the environments of the mask that have a seed, and to all that have none yet."""
        if not self.generators:
            pairs = [gymnasium.utils.seeding.np_random(seed) for seed in seeds]
            self.generators, self.generator_seeds = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
            return
        for index in np.flatnonzero(mask).tolist():
            if (seed := seeds[index]) is not None:
                self.generators[index], self.generator_seeds[index] = gymnasium.utils.seeding.np_random(seed)

    def reset(self, mask: NDArray[np.bool_]) -> None:
        """Begins a new episode in each environment of the mask."""
        (chosen,) = mask.nonzero()
        generators = [self.generators[index] for index in chosen.tolist()]
        ranges = self.task.randomisation
        head = [generator.random(2 + len(ranges)).tolist() for generator in generators]
        # Mostly one episode begins at a time, for which numbers take less time than arrays.
        for index, (world, seed, *_) in zip(chosen.tolist(), head, strict=True):
            self._worlds[index], self._seeds[index] = int(world * len(self.task.grids)), int(seed * 2.0**53)
        if self.is_shared:
            self._worlds[:] = self._worlds[0]
        poses = np.zeros((len(mask), 3))
        poses[chosen], self.goals[chosen] = self._drawn(self._worlds[chosen].tolist(), generators)
        moved = self._draw_discs(chosen, poses, generators)
        if ranges:
            poses[~mask] = self.fleet.poses[~mask]
            for index, numbers in zip(chosen.tolist(), head, strict=True):
                drawn = {
                    name: low + number * (high - low)
                    for (name, (low, high)), number in zip(ranges.items(), numbers[2:], strict=True)
                }
                self._disturbances[index] = self.task.disturbed(drawn)
            kept = self.fleet.save(~mask)
            self.fleet = self._new_fleet(poses)
            self.fleet.restore(kept)
        else:
            self.fleet.reset(mask, poses=poses, seeds=self._seeds, grids=self._worlds)
            if moved:
                self.fleet.replace_obstacles(moved)
        if self._is_released:
            self._ranges, self._is_released = self._ranges.copy(), False
        self._ranges[chosen] = self.fleet.scan(mask, threads=self._threads)
        self._steps[chosen] = 0
        self._seen[chosen] = self.fleet.relative(self.goals, mask)

    def step(self, actions: NDArray[np.floating[Any]]) -> Outcome:
        """Moves all robots by actions (N, A) in [-1, 1] for a step, and judges where they got to."""
        task = self.task
        commands_from_actions(np.asarray(actions, np.float64), self._max_velocity, out=self._commands)
        self._step = self.fleet.step(self._commands, task.duration, threads=self._threads, out=self._step)
        assert self._step.ranges is not None
        self._ranges, self._is_released = self._step.ranges, False
        before, self._seen = self._seen, self.fleet.relative(self.goals)
        contacts = self._step.contacts.copy()
        self._steps += 1
        rewards, parts, reached, truncated = judge_steps(
            before=before,
            after=self._seen,
            contacts=contacts,
            velocities=self._step.velocities,
            elapsed=self._steps,
            duration=task.duration,
            weights=self._weights,
            goal_radius=task.goal_radius,
            step_limit=self._step_limit,
        )
        return Outcome(rewards, parts, reached, contacts, truncated)

    def stop(self, mask: NDArray[np.bool_]) -> None:
        """Makes the robots of the mask stand still where they are."""
        self.fleet.reset(mask, poses=self.fleet.poses)

    def observations(self) -> Observations:
        """Returns what the robots see now. The next step changes the ranges, unless `release` is called."""
        velocities = self.fleet.velocities
        # NumPy is slow with rows of two numbers, so each axis is a call of its own.
        along = np.empty((len(velocities), len(self._axes)), np.float32)
        for column, axis in enumerate(self._axes):
            along[:, column] = velocities[:, axis]
        return {"goal": self._seen.astype(np.float32), "ranges": self._ranges, "velocity": along}

    def release(self) -> None:
        """Leaves the arrays of the last observations to the caller: nothing changes them any more."""
        self._step, self._is_released = None, True

    def discs(self, index: int) -> list[tuple[float, float, float]]:
        """Returns the discs and other robots that are in a world now: centres x and y in the map frame, and radii [m]."""
        each, time = len(self._obstacles) // len(self._steps), self.fleet.times[index]
        present = [(shape, way) for shape, way, _ in self._obstacles[index * each :][:each] if way is not None]
        at = [[float(np.interp(time, way[:, 0], way[:, axis])) for axis in (1, 2)] for _, way in present]
        discs = [(x, y, shape.reach) for (x, y), (shape, _) in zip(at, present, strict=True)]
        others = np.delete(self.fleet.poses, index, axis=0).tolist() if self.is_shared else []
        return discs + [(x, y, self.task.footprint.reach) for x, y, _ in others]

    def _draw_discs(
        self, chosen: NDArray[np.intp], poses: NDArray[np.float64], generators: Sequence[np.random.Generator]
    ) -> list[tuple[int, Shape, NDArray[np.float64] | None]]:
        """Draws the discs of new episodes, and returns them with their indices in the fleet."""
        if self._discs is None:
            return []
        moved: list[tuple[int, Shape, NDArray[np.float64] | None]] = []
        drawn = self._discs.draw(self._worlds[chosen], poses[chosen], self.goals[chosen], generators)
        for index, discs in zip(chosen.tolist(), drawn, strict=True):
            for slot, disc in enumerate(discs, start=index * len(discs)):
                self._obstacles[slot] = (*disc, index)
                moved.append((slot, *disc))
        return moved

    def _drawn(
        self, worlds: Sequence[int], generators: Sequence[np.random.Generator]
    ) -> tuple[list[tuple[float, float, float]], list[tuple[float, float]]]:
        """Draws a start (x, y, yaw) and a goal (x, y) in each of the worlds."""
        starts, goals = [(0.0, 0.0, 0.0)] * len(worlds), [(0.0, 0.0)] * len(worlds)
        missing = list(range(len(worlds)))
        for _ in range(BLOCKS):
            lost = []
            for row in missing:
                numbers = generators[row].random(FreeSpace.NUMBERS).tolist()
                starts[row], goals[row], found = self._space.draw_one(worlds[row], self.task.goal_distances, numbers)
                if not found:
                    lost.append(row)
            missing = lost
            if self.is_shared:
                crowded = self._crowded(np.array(starts)) | self._crowded(np.array(goals))
                missing = sorted({*lost, *np.flatnonzero(crowded).tolist()})
            if not missing:
                return starts, goals
        low, high = self.task.goal_distances
        if self.is_shared and len(worlds) > 1:
            raise ValueError(
                f"a world must have room for {len(worlds)} robots, and goals {low:g} m to {high:g} m from their starts; "
                f"got none for {len(missing)} of them in {BLOCKS} draws in world {worlds[0]}"
            )
        tried = BLOCKS * FreeSpace.ATTEMPTS
        raise ValueError(
            f"a world must have a goal that a robot can reach, {low:g} m to {high:g} m from its start; "
            f"got none in {tried} draws in world {worlds[missing[0]]}"
        )

    def _crowded(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tells which of some places leave too little room to an earlier one for a robot at each of them."""
        needed = 2.0 * (self.task.footprint.reach + self.task.clearance)
        distances = np.hypot(*(places[:, None, :2] - places[None, :, :2]).T)
        return np.asarray((np.tri(len(places), k=-1, dtype=np.bool_) & (distances < needed)).any(axis=1))

    def _new_fleet(self, poses: NDArray[np.float64]) -> Fleet:
        task = self.task
        # Without randomisation, all robots are the same.
        is_random = bool(task.randomisation)
        of_robots = self._disturbances if is_random else self._disturbances[:1]
        noise = [each.noise for each in of_robots if each.noise is not None]
        limits = [each.limits for each in of_robots if each.limits is not None]
        return Fleet(
            task.grids,
            poses,
            seeds=self._seeds,
            grid_of=self._worlds,
            world_of=np.zeros(len(poses), np.intp) if self.is_shared else None,
            footprint=task.footprint,
            limits=limits or None,
            slip=[each.slip for each in of_robots] if is_random else None,
            scanner=task.scanner,
            noise=noise or None,
            obstacles=self._obstacles,
        )
