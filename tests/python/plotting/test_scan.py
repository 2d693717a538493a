"""ScanPicture: its view, and its arguments."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from mobile_robot_simulator import Pose
from mobile_robot_simulator.plotting import ScanPicture
from rendering import HITS, Rendered, room


def test_the_view_contains_the_end_points_of_the_beams() -> None:
    drawn = Rendered(ScanPicture(room(), Pose(2.5, 2.5), HITS + np.array([3.0, 0.0])))
    low_x, high_x, _, _ = drawn.view
    assert -2.0 < low_x < -0.5 and 7.5 < high_x < 9.0


def test_given_axes_show_the_scan() -> None:
    axes = Figure().add_subplot()
    assert ScanPicture(room(), Pose(2.5, 2.5), HITS).plot(axes) is axes
    assert axes.get_legend_handles_labels()[1] == ["scan", "laser"]


def test_arrays_are_checked() -> None:
    with pytest.raises(ValueError, match=r"pose must have shape \(N, 3\), got \(1, 2\)"):
        ScanPicture(room(), (1.0, 2.0), HITS)
    with pytest.raises(ValueError, match="scan_points must be finite"):
        ScanPicture(room(), (1.0, 2.0, 0.0), HITS * np.nan)
