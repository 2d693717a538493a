"""Runner: drives many worlds of a space, in this process or in several."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from operator import index
from types import TracebackType
from typing import TypeAlias

from ..requirements.formula import Requirement
from ..scenarios.space import Space
from ..scenarios.world import World
from ..worker_pool import WorkerDied, WorkerPool
from .drive import Drive, Setup, run_drive
from .lost_drive import LostDrive

__all__ = ["Runner"]

_Task: TypeAlias = "World | Sequence[float]"
"""A world, or a point of the unit cube."""


class Runner:
    """Runs drives. Use it as a context manager, which ends its processes.

    Args:
        controllers: Controllers that drive in each world. With several processes, they and the requirement are pickled, so
            they must be functions or classes of a module.
        space: The space.
        requirement: The requirement.
        processes: Number of processes. The results do not depend on it.

    Raises:
        ValueError: With several processes, a controller or the requirement cannot be pickled.
    """

    def __init__(self, controllers: Sequence[Setup], space: Space, requirement: Requirement, processes: int = 1) -> None:
        self._space, self._begun = space, 0
        self._work = _Work(tuple(controllers), space, requirement)
        self._pool = WorkerPool(self._work, index(processes)) if processes > 1 else None

    def __enter__(self) -> Runner:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._pool is not None:
            self._pool.close(at_once=kind is not None)

    def run(self, points: Sequence[Sequence[float]]) -> Iterator[tuple[Drive, ...]]:
        """Yields the drives of each point of the unit cube, one for each controller, in order.

        Args:
            points: The points.

        Raises:
            ValueError: A world cannot be simulated, or the requirement needs something that it does not have.
            LostDrive: Something ended one of several processes during a drive.
        """
        begun, self._begun = self._begun, self._begun + len(points)
        if self._pool is None:
            yield from map(self._work, points)
            return
        try:
            yield from self._pool.run(points)
        except WorkerDied as died:
            if died.index is None:
                raise
            world, number = self._space.world(points[died.index]), begun + died.index + 1
            raise LostDrive(world, number, died.exit_code) from None

    def drive(self, world: World) -> Drive:
        """Runs the first controller in a world.

        Args:
            world: The world.

        Raises:
            ValueError: As for `run`.
            LostDrive: As for `run`.
        """
        if self._pool is None:
            return self._work(world)[0]
        try:
            return next(self._pool.run([world]))[0]
        except WorkerDied as died:
            if died.index is None:
                raise
            raise LostDrive(world, None, died.exit_code) from None


class _Work:
    """What a process needs to run drives."""

    def __init__(self, controllers: tuple[Setup, ...], space: Space, requirement: Requirement) -> None:
        self._controllers, self._space, self._requirement = controllers, space, requirement

    def __call__(self, task: _Task) -> tuple[Drive, ...]:
        world = task if isinstance(task, World) else self._space.world(task)
        return tuple(run_drive(world, controller, self._requirement) for controller in self._controllers)
