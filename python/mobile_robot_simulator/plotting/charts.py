"""Charts of residuals, as PNG images: histograms, bands and beams."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from .style import INK, ROBOT, picture_style

_SIZE, _DPI = (7.0, 2.6), 110


def histogram_png(edges: NDArray[np.float64], counts: NDArray[np.int64], *, unit: str) -> bytes:
    """Returns a histogram.

    Args:
        edges: (K + 1,) edges of the bins.
        counts: (K,) number of values in each bin.
        unit: What the values are, with their unit.
    """

    def draw(axes: Axes) -> None:
        axes.stairs(counts, edges, fill=True, color=ROBOT, alpha=0.75)
        axes.axvline(0.0, color=INK, lw=0.8)
        axes.set(xlabel=unit, ylabel="beams", xlim=(edges[0], edges[-1]))

    return _chart(draw)


def bands_png(names: Sequence[str], medians: Sequence[float], mads: Sequence[float], *, label: str, unit: str) -> bytes:
    """Returns a chart with the median of each band, and a bar of the median plus and minus MAD.

    Args:
        names: Name of each band.
        medians: Median of each.
        mads: MAD of each.
        label: What the bands are of.
        unit: What the values are, with their unit.
    """

    def draw(axes: Axes) -> None:
        axes.errorbar(names, medians, yerr=mads, fmt="o", ms=5, color=ROBOT, ecolor=ROBOT, elinewidth=6, alpha=0.6)
        axes.plot(names, medians, "o", ms=5, color=INK)
        axes.axhline(0.0, color=INK, lw=0.8)
        axes.set(xlabel=label, ylabel=unit)

    return _chart(draw)


def beams_png(medians: Sequence[float], mads: Sequence[float], *, unit: str) -> bytes:
    """Returns a chart with the median of each beam, and the area within MAD of it.

    Args:
        medians: Median of each beam. NaN leaves a gap.
        mads: MAD of each beam.
        unit: What the values are, with their unit.
    """
    middle, half = np.array(medians), np.array(mads)

    def draw(axes: Axes) -> None:
        beams = np.arange(len(middle))
        axes.fill_between(beams, middle - half, middle + half, color=ROBOT, alpha=0.25, lw=0)
        axes.plot(beams, middle, color=ROBOT, lw=1.2, marker="." if len(beams) < 100 else "")
        axes.axhline(0.0, color=INK, lw=0.8)
        axes.set(xlabel="beam", ylabel=unit)

    return _chart(draw)


def _chart(draw: Callable[[Axes], None]) -> bytes:
    image = io.BytesIO()
    with picture_style():
        figure = Figure(figsize=_SIZE, dpi=_DPI, layout="constrained")
        axes = figure.add_subplot(facecolor="white")
        axes.spines[["top", "right"]].set_visible(False)
        draw(axes)
        figure.savefig(image, format="png", metadata={"Software": None})
    return image.getvalue()
