"""charts: images that show their numbers, with the same bytes each time."""

from __future__ import annotations

import io
from collections.abc import Callable

import numpy as np
import pytest
from PIL import Image

from mobile_robot_simulator.plotting.charts import bands_png, beams_png, histogram_png

EDGES = np.linspace(-0.5, 0.5, 11)


def histogram(fullest: int) -> bytes:
    return histogram_png(EDGES, np.eye(10, dtype=np.int64)[fullest] * 50, unit="error [m]")


def bands(highest: int) -> bytes:
    return bands_png([f"{k} m" for k in range(10)], np.eye(10)[highest].tolist(), [0.02] * 10, label="range", unit="[m]")


def beams(highest: int) -> bytes:
    return beams_png(np.eye(10)[highest].tolist(), [0.01] * 10, unit="error [m]")


charts = pytest.mark.parametrize("chart", [histogram, bands, beams])


def dark(png: bytes) -> np.ndarray:
    """Columns of the upper half of the axes that have a pixel which is not white."""
    pixels = np.asarray(Image.open(io.BytesIO(png)).convert("L"))
    upper = pixels[10 : len(pixels) // 2, 90:]
    return np.flatnonzero((upper < 200).any(axis=0)) / upper.shape[1]


@charts
def test_the_largest_value_is_where_it_belongs(chart: Callable[[int], bytes]) -> None:
    left, right = dark(chart(2)), dark(chart(7))
    assert 0.1 < np.median(left) < 0.4 and 0.6 < np.median(right) < 0.9


@charts
def test_the_same_numbers_give_the_same_bytes(chart: Callable[[int], bytes]) -> None:
    assert chart(3) == chart(3) != chart(4)


def test_beams_without_residuals_leave_a_gap() -> None:
    assert beams_png([0.1, np.nan, 0.3], [0.01, np.nan, 0.01], unit="m").startswith(b"\x89PNG")
