"""shape: discs and simple polygons, checked and copied."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import pytest

import mobile_robot_simulator as mrs

SHAPES = [
    mrs.Shape.disc(0.3),
    mrs.Shape.rectangle(0.6, 0.4),
    mrs.Shape.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]),
]


def test_shapes_have_radius_reach_points_and_area() -> None:
    disc, rectangle, angle = SHAPES
    assert (disc.radius, disc.reach, disc.points.shape) == (0.3, 0.3, (0, 2))
    assert rectangle.radius is None
    assert rectangle.points.tolist() == [[-0.3, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2]]
    assert rectangle.reach == pytest.approx(math.hypot(0.3, 0.2))
    assert angle.area == 3.0
    assert repr(disc) == "Shape.disc(0.3)"
    assert eval(repr(angle), {"Shape": mrs.Shape}) == angle


def test_corners_can_have_either_order_and_be_an_array() -> None:
    corners = np.array([[0, 0], [0, 1], [1, 0]])
    assert mrs.Shape.polygon(corners).area == mrs.Shape.polygon(corners[::-1].astype(np.float64)).area == 0.5


@pytest.mark.parametrize("shape", SHAPES, ids=repr)
def test_copies_are_equal(shape: mrs.Shape) -> None:
    assert pickle.loads(pickle.dumps(shape)) == shape
    assert copy.deepcopy(shape) == shape
    assert shape != mrs.Shape.disc(7.0)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: mrs.Shape.disc(0.0), ValueError, "radius must be positive and at most 1e6, got 0"),
        (lambda: mrs.Shape.rectangle(1.0, math.nan), ValueError, "width must be positive and at most 1e6, got NaN"),
        (lambda: mrs.Shape.polygon([(0, 0), (1, 1)]), ValueError, "the number of corners must be in 3..1000, got 2"),
        (lambda: mrs.Shape.polygon(np.zeros((4, 3))), ValueError, r"points must have shape \(N, 2\), got \(4, 3\)"),
        (lambda: mrs.Shape.polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), ValueError, "edges must meet only at the corners"),
        (lambda: mrs.Shape.polygon([(0, 0), (1, 0), (math.inf, 1)]), ValueError, "a corner must be finite"),
        (lambda: mrs.Shape.polygon("abc"), TypeError, r"points must be an \(N, 2\) array or number pairs, got str"),
    ],
)
def test_invalid_shapes_are_rejected(make, error, message) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(error, match=message):
        make()
