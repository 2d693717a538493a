"""Runner: drives many worlds of a space, in this process or in several."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from operator import index
from types import TracebackType
from typing import SupportsIndex

from ..quoting import quoted
from ..requirements.formula import Requirement, checked
from ..scenarios.space import Space
from ..scenarios.world import World
from .drive import Drive, Setup, run_drive

__all__ = ["Runner"]


class Runner:
    """Runs drives. Use it as a context manager, which ends its processes.

    Args:
        controllers: Controllers that drive in each world. With several processes, they and the requirement are pickled, so
            they must be functions or classes of a module.
        space: The space.
        requirement: The requirement.
        processes: Number of processes. The results do not depend on it.

    Raises:
        ValueError: `processes` is below 1.
        TypeError: A controller is not callable, or the space or the requirement is something else.
    """

    def __init__(self, controllers: Sequence[Setup], space: Space, requirement: Requirement, processes: int = 1) -> None:
        for controller in controllers:
            if not callable(controller):
                raise TypeError(f"a controller must be a function of the simulation, got {quoted(controller)}")
        if not isinstance(space, Space):
            raise TypeError(f"the space must be a scenarios.Space, got {quoted(space)}")
        if not isinstance(processes, SupportsIndex) or index(processes) < 1:
            raise ValueError(f"processes must be at least 1, got {quoted(processes)}")
        self.space = space
        self._work = _Work(tuple(controllers), space, checked(requirement))
        self._pool: ProcessPoolExecutor | None = None
        if processes > 1:
            self._pool = ProcessPoolExecutor(
                index(processes), multiprocessing.get_context("spawn"), initializer=_begin, initargs=(self._work,)
            )

    def __enter__(self) -> Runner:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def run(self, points: Sequence[Sequence[float]]) -> Iterator[tuple[Drive, ...]]:
        """Yields the drives of each point of the unit cube, one for each controller, in order.

        Args:
            points: The points.

        Raises:
            ValueError: A world cannot be simulated, or the requirement needs something that it does not have.
        """
        if self._pool is None:
            return map(self._work.drive_point, points)
        return self._pool.map(_drive_point, points, chunksize=2)

    def drive(self, world: World) -> Drive:
        """Runs the first controller in a world, in this process.

        Args:
            world: The world.

        Raises:
            ValueError: As for `run`.
        """
        return self._work.drive(world)[0]


class _Work:
    """What a process needs to run drives."""

    def __init__(self, controllers: tuple[Setup, ...], space: Space, requirement: Requirement) -> None:
        self._controllers, self._space, self._requirement = controllers, space, requirement

    def drive_point(self, point: Sequence[float]) -> tuple[Drive, ...]:
        return self.drive(self._space.world(point))

    def drive(self, world: World) -> tuple[Drive, ...]:
        return tuple(run_drive(world, controller, self._requirement) for controller in self._controllers)


_work: list[_Work] = []
"""The work of this process, if it is one of a pool."""


def _begin(work: _Work) -> None:
    _work[:] = [work]


def _drive_point(point: Sequence[float]) -> tuple[Drive, ...]:
    return _work[0].drive_point(point)
