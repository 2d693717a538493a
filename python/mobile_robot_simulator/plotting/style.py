"""Colours and Matplotlib settings of saved pictures."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any

from matplotlib import style
from matplotlib.colors import LinearSegmentedColormap

FREE, OCCUPIED, UNKNOWN = (255, 255, 255), (38, 42, 51), (226, 229, 233)
INK, FAINT, ROBOT, SCAN, GOAL = "#262a33", "#8a919c", "#1f4fd8", "#e8442e", "#f5a300"
CONTACT = "#c00018"
FARTHER, NEARER = "#1f4fd8", "#d3261a"
SHAPE = "#b9c2d0"
TIME = LinearSegmentedColormap.from_list("time", ["#20308f", "#7a2bc4", "#d62a9d", "#ff8a3d"])
"""Colours along a path, from its start to its end."""

_SETTINGS: dict[str, Any] = {
    "axes.edgecolor": FAINT,
    "axes.facecolor": tuple(value / 255 for value in UNKNOWN),
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.titlecolor": INK,
    "axes.titlelocation": "left",
    "axes.titlesize": 12,
    "axes.titleweight": "bold",
    "font.size": 9,
    "legend.frameon": False,
    "svg.hashsalt": "mobile-robot-simulator",
    "xtick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.color": FAINT,
    "ytick.labelcolor": INK,
}


def picture_style() -> AbstractContextManager[None]:
    """Returns a context that applies the settings of saved pictures.

    The settings start from Matplotlib's defaults, so the user's own settings do not change a picture.
    """
    settings: list[Any] = ["default", _SETTINGS]
    return style.context(settings)
