"""samplers: points of the unit cube, the same for the same seed; CMA-ES learns from what it is told."""

from __future__ import annotations

import numpy as np
import pytest

from mobile_robot_simulator.falsification.samplers import sampler

METHODS = ("random", "sobol", "cma")
SEED = 5


def search(method, dimensions, seed, rounds):
    """Returns the points of a search for the smallest squared distance to (0.3, 0.3, ...), and these distances."""
    source, points, values = sampler(method, dimensions, seed), [], []
    while len(points) < rounds:
        asked = source.ask()
        found = [sum((share - 0.3) ** 2 for share in point) for point in asked]
        source.tell(asked, found)
        points += asked
        values += found
    return points, values


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dimensions", [0, 1, 2, 40])
def test_points_are_in_the_cube_and_repeat(method, dimensions):
    points, _ = search(method, dimensions, SEED, 96)
    assert all(len(point) == dimensions and all(0.0 <= share <= 1.0 for share in point) for point in points)
    assert search(method, dimensions, SEED, 96)[0] == points
    if dimensions:
        assert search(method, dimensions, SEED + 1, 96)[0] != points


def test_learning_gets_nearer_than_chance():
    nearest = {method: min(search(method, 8, SEED, 480)[1]) for method in METHODS}
    assert nearest["cma"] < 0.1 * min(nearest["random"], nearest["sobol"])


def test_learning_starts_again_when_it_has_converged():
    points, values = search("cma", 2, SEED, 3000)
    late = np.array(points[-500:])
    assert min(values) < 1e-12 and late.std(axis=0).min() > 1e-6


def test_sobol_fills_the_square_more_evenly_than_chance():
    """64 points of a scrambled Sobol sequence have exactly one point in each of 8 x 8 squares."""
    squares = {(int(8 * x), int(8 * y)) for x, y in search("sobol", 2, SEED, 64)[0]}
    assert len(squares) == 64 > len({(int(8 * x), int(8 * y)) for x, y in search("random", 2, SEED, 64)[0]})


def test_infinite_results_are_taken():
    source = sampler("cma", 3, SEED)
    for _ in range(3):
        points = source.ask()
        source.tell(points, [float("-inf"), float("inf"), *[0.0] * (len(points) - 2)])
    source.tell(source.ask()[:3], [1.0, 2.0, 3.0])
    assert len(source.ask()) == 16
