"""ResidualPicture: the colours of its dots, its view, and its arguments."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from mobile_robot_simulator.plotting import ResidualPicture, residuals, style
from rendering import PATH, Rendered, room

FARTHER, NEARER, FAINT = (
    tuple(round(255 * share) for share in to_rgb(name)) for name in (style.FARTHER, style.NEARER, style.FAINT)
)


def around(x: float, y: float) -> np.ndarray:
    """Many points so near to one that they make a dot larger than a pixel."""
    return np.array([x, y]) + 0.004 * np.stack(np.meshgrid(np.arange(-4, 5), np.arange(-4, 5)), -1).reshape(-1, 2)


def picture(**options: float) -> ResidualPicture:
    ends = np.vstack([around(2.0, 3.0), around(3.0, 3.5), around(4.0, 4.0)])
    return ResidualPicture(room(), PATH, ends, np.repeat([0.05, 0.3, -0.3], 81), **options)


def test_a_dot_has_the_colour_of_its_residual() -> None:
    drawn = Rendered(picture())
    assert (drawn(2.0, 3.0), drawn(3.0, 3.5), drawn(4.0, 4.0)) == (FAINT, FARTHER, NEARER)
    assert drawn(3.5, 1.4) != FARTHER
    labels = drawn.axes.get_legend_handles_labels()[1]
    assert labels == ["path", "within 0.1 m", "farther than simulated", "nearer than simulated"]


def test_the_limit_decides_what_is_right() -> None:
    drawn = Rendered(picture(limit=0.01))
    assert drawn(2.0, 3.0) == FARTHER
    assert Rendered(picture(limit=0.4))(4.0, 4.0) == FAINT


def test_a_few_far_ends_do_not_widen_the_view() -> None:
    ends = np.vstack([around(2.0, 3.0)] * 5 + [np.array([[900.0, -50.0]])])
    low_x, high_x, low_y, high_y = Rendered(ResidualPicture(room(), PATH, ends, np.zeros(len(ends)))).view
    assert -2.0 < low_x < -0.9 and 5.9 < high_x < 7.0 and -2.0 < low_y < -0.9 and 3.9 < high_y < 6.0


def test_of_many_dots_some_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(residuals, "_MOST_POINTS", 10)
    drawn = Rendered(picture())
    assert {len(line.get_xdata()) for line in drawn.axes.lines} == {0, 9, len(PATH)}


def test_arrays_are_checked() -> None:
    with pytest.raises(ValueError, match="path must have at least one row"):
        ResidualPicture(room(), np.zeros((0, 3)), np.zeros((0, 2)), np.zeros(0))
    with pytest.raises(ValueError, match="residuals must be finite numbers, one for each of 2 ends"):
        ResidualPicture(room(), PATH, np.zeros((2, 2)), np.zeros(3))
    with pytest.raises(ValueError, match="residuals must be finite numbers"):
        ResidualPicture(room(), PATH, np.zeros((2, 2)), np.array([0.0, np.nan]))
    with pytest.raises(ValueError, match="ends must be finite"):
        ResidualPicture(room(), PATH, np.full((2, 2), np.inf), np.zeros(2))
