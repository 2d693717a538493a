"""Requirement: a formula of signal temporal logic, and its robustness.

Source of the semantics: A. Donzé and O. Maler, *Robust satisfaction of temporal logic over real-valued signals*, FORMATS
2010, section 2, on samples: a window contains the samples in it. Windows end where the trace ends.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted
from .trace import Trace
from .windows import Window, largest, smallest, smallest_until

__all__ = ["Comparison", "Requirement", "always", "checked", "eventually", "until"]

Robustness = NDArray[np.float64]


class Requirement(ABC):
    """A condition on drives with a robustness: positive if it holds, negative if it is violated.

    Conditions are strict, so a robustness of 0 counts as violated. Robustness has the unit of the signal that decides, so
    combine signals whose margins compare, or look at them one by one.
    """

    @abstractmethod
    def over_time(self, trace: Trace) -> Robustness:
        """Returns the robustness at each sample, (N,) float64: by how much the requirement holds from there on.

        Args:
            trace: The drive.

        Raises:
            ValueError: A signal needs something that the drive does not have, such as a goal, or has a value that is NaN.
        """

    def robustness(self, trace: Trace) -> float:
        """Returns the robustness of the whole drive: that at its start.

        Args:
            trace: The drive.

        Raises:
            ValueError: As for `over_time`.
        """
        return float(self.over_time(trace)[0])

    def __and__(self, other: Requirement) -> Requirement:
        return Both(self, checked(other))

    def __or__(self, other: Requirement) -> Requirement:
        return Either(self, checked(other))

    def __invert__(self) -> Requirement:
        return Not(self)

    def __bool__(self) -> bool:
        raise TypeError(f"requirement {self!r} has no truth value; combine requirements with &, | and ~")


def always(requirement: Requirement, within: tuple[float, float] = (0.0, math.inf)) -> Requirement:
    """Returns the requirement that another one holds at all times of a window.

    Args:
        requirement: The other requirement.
        within: Start and end of the window [s], counted from the time for which it is evaluated, both included.

    Raises:
        TypeError: It is not a requirement.
        ValueError: The window does not start at 0 s or later, or ends before it starts.
    """
    return Always(checked(requirement), _window(within))


def eventually(requirement: Requirement, within: tuple[float, float] = (0.0, math.inf)) -> Requirement:
    """Returns the requirement that another one holds at some time of a window.

    Args:
        requirement: The other requirement.
        within: Start and end of the window [s], as for `always`.

    Raises:
        TypeError: It is not a requirement.
        ValueError: The window is not valid for `always`.
    """
    return Eventually(checked(requirement), _window(within))


def until(first: Requirement, then: Requirement, within: tuple[float, float] = (0.0, math.inf)) -> Requirement:
    """Returns the requirement that `then` holds at some time of a window, and `first` at all times before and then.

    Args:
        first: Requirement that must hold from now until `then` does, that time included.
        then: Requirement that must hold at some time of the window.
        within: Start and end of the window [s], as for `always`.

    Raises:
        TypeError: One is not a requirement.
        ValueError: The window is not valid for `always`.
    """
    return Until(checked(first), checked(then), _window(within))


@dataclass(frozen=True)
class Comparison(Requirement):
    """A signal is above or below a limit. Its robustness is the distance from the limit."""

    name: str
    unit: str
    measure: Callable[[Trace], NDArray[np.float64]]
    limit: float
    is_above: bool

    def __repr__(self) -> str:
        return f"{self.name} {'>' if self.is_above else '<'} {self.limit:g} {self.unit}"

    def over_time(self, trace: Trace) -> Robustness:
        """Returns the distance from the limit."""
        values = np.asarray(self.measure(trace), np.float64)
        if values.shape != trace.times.shape:
            raise ValueError(f"signal {self.name} must have a value per sample, {trace.times.shape}, got {values.shape}")
        if np.isnan(values).any():
            raise ValueError(f"signal {self.name} must not be NaN, but is at {trace.times[np.isnan(values)][0]:g} s")
        return values - self.limit if self.is_above else self.limit - values


@dataclass(frozen=True, repr=False)
class Both(Requirement):
    """Two requirements hold."""

    first: Requirement
    second: Requirement

    def __repr__(self) -> str:
        return f"{_part(self.first, Both)} & {_part(self.second, Both)}"

    def over_time(self, trace: Trace) -> Robustness:
        """Returns the smaller robustness."""
        return np.minimum(self.first.over_time(trace), self.second.over_time(trace))


@dataclass(frozen=True, repr=False)
class Either(Requirement):
    """At least one of two requirements holds."""

    first: Requirement
    second: Requirement

    def __repr__(self) -> str:
        return f"{_part(self.first, Either)} | {_part(self.second, Either)}"

    def over_time(self, trace: Trace) -> Robustness:
        """Returns the larger robustness."""
        return np.maximum(self.first.over_time(trace), self.second.over_time(trace))


@dataclass(frozen=True, repr=False)
class Not(Requirement):
    """A requirement does not hold."""

    inner: Requirement

    def __repr__(self) -> str:
        return f"~({self.inner})"

    def over_time(self, trace: Trace) -> Robustness:
        """Returns the negative robustness."""
        return -self.inner.over_time(trace)


@dataclass(frozen=True, repr=False)
class Always(Requirement):
    """A requirement holds at all times of a window."""

    inner: Requirement
    window: Window

    def __repr__(self) -> str:
        return f"always({self.inner}{_shown(self.window)})"

    def over_time(self, trace: Trace) -> Robustness:
        """Returns the smallest robustness in the window, infinity if the window is empty."""
        return smallest(self.inner.over_time(trace), trace.times, self.window)


@dataclass(frozen=True, repr=False)
class Eventually(Requirement):
    """A requirement holds at some time of a window."""

    inner: Requirement
    window: Window

    def __repr__(self) -> str:
        return f"eventually({self.inner}{_shown(self.window)})"

    def over_time(self, trace: Trace) -> Robustness:
        """Returns the largest robustness in the window, minus infinity if the window is empty."""
        return largest(self.inner.over_time(trace), trace.times, self.window)


@dataclass(frozen=True, repr=False)
class Until(Requirement):
    """A requirement holds until another one does."""

    first: Requirement
    then: Requirement
    window: Window

    def __repr__(self) -> str:
        return f"until({self.first}, {self.then}{_shown(self.window)})"

    def over_time(self, trace: Trace) -> Robustness:
        """Returns the largest value, over the window, of the smaller one of `then` there and of all `first` up to there."""
        return smallest_until(self.first.over_time(trace), self.then.over_time(trace), trace.times, self.window)


def checked(requirement: object) -> Requirement:
    """Returns a requirement as it is.

    Args:
        requirement: The requirement.

    Raises:
        TypeError: It is not one.
    """
    if not isinstance(requirement, Requirement):
        raise TypeError(f"a requirement such as clearance > 0.2 is needed, got {quoted(requirement)}")
    return requirement


def _window(within: tuple[float, float]) -> Window:
    try:
        start, end = map(float, within)
    except (TypeError, ValueError):
        raise ValueError(f"a window must be two numbers (start, end) [s], got {quoted(within)}") from None
    if not 0.0 <= start <= end or math.isinf(start):
        raise ValueError(f"a window must start at 0 s or later and must not end before that, got {quoted(within)}")
    return Window(start, end)


def _part(requirement: Requirement, around: type[Requirement]) -> str:
    needs_brackets = isinstance(requirement, Both | Either) and not isinstance(requirement, around)
    return f"({requirement})" if needs_brackets else f"{requirement}"


def _shown(window: Window) -> str:
    return "" if window == Window(0.0, math.inf) else f", within=({window.start:g} s, {window.end:g} s)"
