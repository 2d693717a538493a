"""Samplers: which points of the unit cube a search tries next."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Literal, Protocol, get_args

import numpy as np

from ..quoting import quoted

__all__ = ["Method", "Sampler", "sampler"]

Method = Literal["random", "sobol", "cma"]
"""Ways to search: independent points, points that fill the cube evenly, and points that learn from earlier results."""

Points = list[list[float]]

BATCH = 32
"""Number of points that are tried before the next ones are chosen, for any number of processes. A power of 2 for Sobol."""

POPULATION = 16
"""Number of points of a generation of CMA-ES. Its default for 30 dimensions is 14."""

NEEDED = "the methods sobol and cma need scipy and cmaes: pip install 'mobile-robot-simulator[falsification]'"


class Sampler(Protocol):
    """Proposes points, and may learn from their results."""

    def ask(self) -> Points:
        """Returns the next points to try."""

    def tell(self, points: Points, values: Sequence[float]) -> None:
        """Takes the results of the points, smaller ones being better."""


def sampler(method: Method, dimensions: int, seed: int) -> Sampler:
    """Returns a sampler. The same arguments give the same points, if the same results are told.

    Args:
        method: "random", "sobol" or "cma" (CMA-ES, with restarts).
        dimensions: Number of dimensions.
        seed: Seed of the points.

    Raises:
        ValueError: The method is unknown.
        ImportError: The method needs an extra.
    """
    if method not in get_args(Method):
        raise ValueError(f"method must be one of {', '.join(get_args(Method))}, got {quoted(method)}")
    if method == "random":
        return _Random(dimensions, seed)
    return _Sobol(dimensions, seed) if method == "sobol" else _Cma(dimensions, seed)


class _Random:
    def __init__(self, dimensions: int, seed: int) -> None:
        # According to its documentation, random.Random gives the same numbers on every platform.
        self._dimensions, self._random = dimensions, random.Random(seed)

    def ask(self) -> Points:
        return [[self._random.random() for _ in range(self._dimensions)] for _ in range(BATCH)]

    def tell(self, points: Points, values: Sequence[float]) -> None:
        pass


class _Sobol:
    def __init__(self, dimensions: int, seed: int) -> None:
        try:
            from scipy.stats import qmc
        except ImportError as error:
            raise ImportError(NEEDED) from error
        self._dimensions = dimensions
        self._sobol = qmc.Sobol(max(dimensions, 1), scramble=True, seed=seed)

    def ask(self) -> Points:
        return [row[: self._dimensions] for row in self._sobol.random(BATCH).tolist()]

    def tell(self, points: Points, values: Sequence[float]) -> None:
        pass


class _Cma:
    """CMA-ES (Hansen 2016, arXiv:1604.00772). It starts again elsewhere when it has converged."""

    def __init__(self, dimensions: int, seed: int) -> None:
        self._dimensions, self._seed, self._restarts = dimensions, seed, 0
        self._start()

    def ask(self) -> Points:
        if self._cma.should_stop():
            self._restarts += 1
            self._start()
        return [self._cma.ask()[: self._dimensions].tolist() for _ in range(POPULATION)]

    def tell(self, points: Points, values: Sequence[float]) -> None:
        if len(points) < POPULATION:  # The budget ended within the generation.
            return
        # The package needs two dimensions and finite numbers; a generation uses only their order.
        order = np.argsort(np.argsort(values, kind="stable"), kind="stable")
        padding = [0.5] * (self._width - self._dimensions)
        self._cma.tell([(np.array([*point, *padding]), float(rank)) for point, rank in zip(points, order, strict=True)])

    def _start(self) -> None:
        try:
            from cmaes import CMA
        except ImportError as error:
            raise ImportError(NEEDED) from error
        self._width = max(self._dimensions, 2)
        own = random.Random(f"{self._seed} {self._restarts}")
        mean = np.full(self._width, 0.5) if not self._restarts else np.array([own.random() for _ in range(self._width)])
        bounds = np.tile([0.0, 1.0], (self._width, 1))
        self._cma = CMA(mean, 0.3, bounds=bounds, population_size=POPULATION, seed=own.randrange(2**32))
