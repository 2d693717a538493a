"""beams: the beams of a log equal those of a scanner and, if they are uneven, rays of their own."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from compare.simulated_logs import LASER, free_poses, log_of, office
from mobile_robot_simulator.compare import beams
from mobile_robot_simulator.compare.beams import Beams

GRID = office()
POSES = free_poses(GRID, 7)


def one_by_one(angles: np.ndarray, max_range: float) -> np.ndarray:
    """The ranges of all beams, each cast alone."""
    rays = [[(x, y, yaw + angle) for angle in angles] for x, y, yaw in POSES]
    return np.array([mrs.cast_rays(GRID, np.array(each), max_range) for each in rays])


def test_beams_of_a_log_are_those_of_its_scanner() -> None:
    cast = Beams.of_log(log_of(GRID, POSES)).cast(GRID, POSES)
    np.testing.assert_array_equal(cast, LASER.scan_batch(GRID, POSES))


@pytest.mark.parametrize(
    "angles",
    [
        np.array([0.7]),
        np.array([-1.0, 0.0, 0.1, 2.0]),
        np.array([1.0, 0.5, 0.0]),
        np.linspace(-0.3, 2.5 * math.pi, 9),
        np.array([0.5, 0.5, 0.5]),
    ],
    ids=["one", "uneven", "clockwise", "more than a turn", "equal"],
)
def test_any_angles(angles: np.ndarray) -> None:
    cast = Beams(angles, 9.0).cast(GRID, POSES)
    np.testing.assert_allclose(cast, one_by_one(angles, 9.0), atol=1e-4)
    assert cast.shape == (7, len(angles)) and cast.dtype == np.float32


def test_angles_with_rounded_digits_count_as_even(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beams, "cast_rays", None)
    Beams(LASER.angles.round(4), 9.0).cast(GRID, POSES)


@pytest.mark.parametrize("angles", [LASER.angles, np.array([-1.0, 0.0, 0.1])], ids=["even", "uneven"])
def test_chunks_do_not_matter(angles: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Beams(angles, 9.0).cast(GRID, POSES)
    monkeypatch.setattr(beams, "_CHUNK", 2 * len(angles))
    shares: list[float] = []
    np.testing.assert_array_equal(Beams(angles, 9.0).cast(GRID, POSES, progress=shares.append), whole)
    assert shares == [2 / 7, 4 / 7, 6 / 7, 1.0]


def test_every_second_beam() -> None:
    some = Beams(LASER.angles, 9.0).every(2)
    np.testing.assert_allclose(some.angles, LASER.angles[::2])
    np.testing.assert_allclose(some.cast(GRID, POSES), Beams(LASER.angles, 9.0).cast(GRID, POSES)[:, ::2], atol=1e-4)
