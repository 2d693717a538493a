"""Rigid transforms: products, inverses and interpolation, compared with rotation matrices and planar poses."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.messages import Quaternion, Transform, Vector3
from mobile_robot_simulator.nodes.rigid_transform import RigidTransform

SEED = 5


def matrix(transform: RigidTransform) -> np.ndarray:
    """The homogeneous matrix, whose columns are where the axes and the origin go."""
    columns = [transform.rotate(tuple(axis)) for axis in np.eye(3)]
    return np.vstack([np.column_stack([*columns, transform.translation]), (0, 0, 0, 1)])


def drawn(count: int) -> list[RigidTransform]:
    numbers = np.random.default_rng(SEED).normal(size=(count, 7))
    return [RigidTransform.from_message(Vector3(*row[:3]), Quaternion(*row[3:])) for row in numbers.tolist()]


def planar(x: float, y: float, yaw: float) -> RigidTransform:
    message = Transform.from_planar(mrs.Pose(x, y, yaw))
    return RigidTransform.from_message(message.translation, message.rotation)


def test_products_and_inverses_are_those_of_matrices() -> None:
    for a, b in zip(drawn(20), drawn(40)[20:], strict=True):
        assert np.allclose(matrix(a * b), matrix(a) @ matrix(b))
        assert np.allclose(matrix(a.inverse()), np.linalg.inv(matrix(a)))
        assert np.allclose(matrix(a)[:3, :3].T @ matrix(a)[:3, :3], np.eye(3))


@pytest.mark.parametrize(("axis", "to"), [("x", (1, 0, 0)), ("y", (0, 0, -1)), ("z", (0, 1, 0))])
def test_a_quarter_turn_about_each_axis(axis: str, to: tuple[float, ...]) -> None:
    quarter = RigidTransform.from_message(Vector3(), Quaternion(**{axis: 3.0, "w": 3.0}))
    assert quarter.rotate((1.0, 0.0, 0.0)) == pytest.approx(to)


def test_interpolation_of_planar_transforms_is_planar() -> None:
    first, last = planar(1.0, 2.0, 3.0), planar(2.0, 4.0, -3.0)
    for fraction in (0.0, 0.25, 0.5, 1.0):
        yaw = 3.0 + fraction * (2.0 * math.pi - 6.0)
        assert np.allclose(matrix(first.interpolate(last, fraction)), matrix(planar(1 + fraction, 2 + 2 * fraction, yaw)))


def test_interpolation_takes_equal_steps_the_short_way() -> None:
    for a, b in zip(drawn(20), drawn(40)[20:], strict=True):
        steps = [a.interpolate(b, fraction) for fraction in (0.0, 0.25, 0.5, 0.75, 1.0)]
        assert np.allclose(matrix(steps[0]), matrix(a)) and np.allclose(matrix(steps[-1]), matrix(b))
        turns = [abs((one.inverse() * two).w) for one, two in pairwise(steps)]
        assert turns == pytest.approx([turns[0]] * 4) and min(turns) >= math.cos(math.pi / 8) - 1e-12
    assert a.interpolate(a, 0.5).vector == pytest.approx(a.vector)


@pytest.mark.parametrize(
    ("translation", "rotation", "words"),
    [
        (Vector3(z=math.nan), Quaternion(), "must be finite"),
        (Vector3(), Quaternion(x=math.inf), "must be finite"),
        (Vector3(), Quaternion(w=0.0), "must not be zero"),
    ],
)
def test_what_is_no_rigid_transform_is_refused(translation: Vector3, rotation: Quaternion, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        RigidTransform.from_message(translation, rotation)
