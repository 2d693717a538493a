"""Window: a span of time after each sample, and the extremes of values in it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Window", "largest", "smallest", "smallest_until"]

SLACK = 1e-9
"""Times that differ by less than this are the same [s]: simulated times are whole nanoseconds."""


class Window(NamedTuple):
    """A span of time, counted from each sample."""

    start: float
    """Start [s], included, at least 0."""

    end: float
    """End [s], included; infinity for the end of the trace."""

    def bounds(self, times: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Returns the index of the first sample in the window of each sample, and the index after the last one."""
        return np.searchsorted(times, times + self.start - SLACK), np.searchsorted(times, times + self.end + SLACK)


def smallest(values: NDArray[np.float64], times: NDArray[np.float64], window: Window) -> NDArray[np.float64]:
    """Returns the smallest value in the window of each sample; infinity where the window is empty.

    Doubling spans of the array are reduced once, and each window is the union of two of them ("sparse table").

    Args:
        values: (N,) float64.
        times: (N,) float64, increasing times of the values [s].
        window: The window.
    """
    first, after = window.bounds(times)
    length = after - first
    found = np.full(len(values), np.inf)
    spans, span = values, 1
    while span <= length.max(initial=0):
        fits = (span <= length) & (length < 2 * span)
        found[fits] = np.minimum(spans[first[fits]], spans[after[fits] - span])
        if len(spans) <= span:
            break
        spans = np.minimum(spans[:-span], spans[span:])
        span *= 2
    return found


def largest(values: NDArray[np.float64], times: NDArray[np.float64], window: Window) -> NDArray[np.float64]:
    """Returns the largest value in the window of each sample; minus infinity where the window is empty.

    Args:
        values: (N,) float64.
        times: (N,) float64, increasing times of the values [s].
        window: The window.
    """
    return -smallest(-values, times, window)


def smallest_until(
    first: NDArray[np.float64], then: NDArray[np.float64], times: NDArray[np.float64], window: Window
) -> NDArray[np.float64]:
    """Returns, for each sample, max over j in its window of min(then[j], first from the sample up to j).

    Args:
        first: (N,) float64.
        then: (N,) float64.
        times: (N,) float64, increasing times of both [s].
        window: The window. Where it is empty, the result is minus infinity.
    """
    found = np.full(len(times), -np.inf)
    starts, ends = window.bounds(times)
    for index, (start, end) in enumerate(zip(starts.tolist(), ends.tolist(), strict=True)):
        if start < end:
            held = np.minimum.accumulate(first[index:end])[start - index :]
            found[index] = np.minimum(held, then[start:end]).max()
    return found
