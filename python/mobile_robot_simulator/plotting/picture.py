"""Picture: base class of pictures, which can be drawn in Matplotlib axes or saved to a file."""

from __future__ import annotations

import io
import os
from abc import ABC, abstractmethod
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..new_files import write_files
from ..quoting import quoted
from .style import picture_style
from .view import LONGEST_SIDE, Points

_DPI, _NOTEBOOK_DPI = 150, 80
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.65, 0.25, 0.85, 0.25  # space around the axes [in]
_TITLE = 0.25  # extra space above the axes for a title [in]
_LEGEND = 0.48  # distance from the axes down to the legend [in]

# Metadata to leave out, by kind of file. Otherwise dates and versions would make the bytes of equal pictures differ.
_METADATA: dict[str, dict[str, None]] = {
    ".png": {"Software": None},
    ".pdf": {"Creator": None, "Producer": None, "CreationDate": None},
    ".svg": {"Creator": None, "Date": None},
}


class Picture(ABC):
    """Base class of pictures. A subclass defines the part of the map frame to show (`view`) and what to draw in it (`draw`).

    Attributes:
        title: Title above the axes, or None.
    """

    title: str | None = None

    @abstractmethod
    def view(self) -> Points:
        """Returns the lower left and upper right corner of the view in the map frame [m], (2, 2)."""

    @abstractmethod
    def draw(self, axes: Axes) -> None:
        """Draws in axes that already show the view."""

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the picture in Matplotlib axes and returns the axes.

        Args:
            ax: Axes to draw in, which then show the picture's view. None opens a new pyplot figure with a legend.

        Raises:
            TypeError: `ax` is something else.
        """
        if not isinstance(ax, Axes | None):
            raise TypeError(f"ax must be Matplotlib axes or None, got {quoted(ax)}")
        axes = ax
        if axes is None:
            from matplotlib import pyplot

            _, axes = pyplot.subplots()
        _show(axes, self.view(), self.title)
        axes.apply_aspect()
        self.draw(axes)
        if ax is None and axes.get_legend_handles_labels()[0]:
            axes.legend()
        return axes

    def save(self, file: str | os.PathLike[str]) -> None:
        """Saves the picture, with a legend below the axes. An existing file is replaced in one step.

        Args:
            file: File to write. Its ending selects the format: .png, .pdf or .svg.

        Raises:
            ValueError: The file has another ending.
            TypeError: It is not a path.
            OSError: The folder does not exist or cannot be written.
        """
        if not isinstance(file, (str, os.PathLike)):
            raise TypeError(f"a picture's file must be a text or a Path, got {quoted(file)}")
        path = Path(file)
        suffix = path.suffix.lower()
        if suffix not in _METADATA:
            raise ValueError(f"a picture's file must end in {', '.join(_METADATA)}, got {quoted(str(path))}")
        write_files({path: self._image(suffix, _DPI)})

    def to_png(self, dpi: int = _NOTEBOOK_DPI) -> bytes:
        """Returns the picture as a PNG image. The default is for notebooks: at most about 800 pixels a side."""
        return self._image(".png", dpi)

    def to_figure(self, dpi: int = _DPI) -> Figure:
        """Returns a figure of the picture that is independent of pyplot and of the user's settings."""
        view = self.view()
        low, high = view
        width, height = (high - low) * LONGEST_SIDE / (high - low).max()
        full_width, full_height = width + _LEFT + _RIGHT, height + _BOTTOM + _TOP + (_TITLE if self.title else 0.0)
        with picture_style():
            figure = Figure(figsize=(full_width, full_height), dpi=dpi)
            axes = figure.add_axes((_LEFT / full_width, _BOTTOM / full_height, width / full_width, height / full_height))
            _show(axes, view, self.title)
            self.draw(axes)
            if axes.get_legend_handles_labels()[0]:
                _add_legend(axes, dpi)
        return figure

    def _image(self, suffix: str, dpi: int) -> bytes:
        """Returns the bytes of the picture's file."""
        image = io.BytesIO()
        with picture_style():
            self.to_figure(dpi).savefig(image, format=suffix[1:], dpi=dpi, metadata=_METADATA[suffix])
        return image.getvalue()


def _show(axes: Axes, view: Points, title: str | None) -> None:
    """Makes axes show a view, with x and y at the same scale."""
    low, high = view
    axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    if title:
        axes.set_title(title)


def _add_legend(axes: Axes, dpi: int) -> None:
    """Adds a legend in one line below the axes."""
    axes.legend(
        loc="upper left",
        bbox_to_anchor=(0.0, -_LEGEND * dpi / axes.get_window_extent().height),
        ncols=5,
        borderaxespad=0.0,
        borderpad=0.0,
        handletextpad=0.4,
        columnspacing=1.8,
    )
