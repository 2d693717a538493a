"""Odometer: what a robot believes of its way, exactly or with drift, and how sure it is."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import MotionNoise, Pose
from ..instant import NANOSECONDS

EXACT, UNMEASURED = 1e-9, 1e6
PLANE = (0, 1, 5)
"""Rows of x, y and yaw among (x, y, z, rot x, rot y, rot z)."""


def _covariance_of(plane: NDArray[np.float64]) -> NDArray[np.float64]:
    covariance = np.diag([0.0, 0.0, UNMEASURED, UNMEASURED, UNMEASURED, 0.0])
    covariance[np.ix_(PLANE, PLANE)] = plane + EXACT * np.eye(3)
    flat = covariance.reshape(-1)
    flat.flags.writeable = False
    return flat


PLANAR_COVARIANCE = _covariance_of(np.zeros((3, 3)))
"""What is known of a robot that moves exactly in the plane: x, y and yaw for sure, height, roll and pitch not at all.

Not zero, which means "not known" to some readers and cannot be inverted by others.
"""


class Odometer:
    """Where the wheels say that the robot is.

    noise: how the wheels err between two readings; they do not if None. seed: names the errors.
    """

    def __init__(self, wheels: Pose, time_ns: int, *, noise: MotionNoise | None = None, seed: int = 0) -> None:
        self._noise, self._seed = noise, seed
        self._index = 0
        self.place(wheels, time_ns)

    @property
    def errs(self) -> bool:
        """Whether what it says can be off."""
        return self._noise is not None

    def place(self, wheels: Pose, time_ns: int) -> None:
        """Take the robot to be where it is, for sure."""
        self._wheels = self._believed = wheels
        self._time_ns = time_ns
        self._plane = np.zeros((3, 3))
        self._covariance = PLANAR_COVARIANCE

    def read(self, wheels: Pose, time_ns: int) -> tuple[Pose, NDArray[np.float64]]:
        """The pose that the robot believes in, and its covariance (36,), from where the wheels would really have led it."""
        if self._noise is None:
            return wheels, PLANAR_COVARIANCE
        dt = (time_ns - self._time_ns) / NANOSECONDS
        if dt > 0.0:
            twist, before = self._wheels.twist_to(wheels, dt), self._believed
            self._believed = self._noise.sample(before, twist, dt, seed=self._seed, index=self._index).wrapped()
            self._plane = self._noise.propagate(self._plane, before, twist, dt)
            self._covariance = _covariance_of(self._plane)
            self._index += 1
            self._wheels, self._time_ns = wheels, time_ns
        return self._believed, self._covariance

    def save(self) -> Any:
        """All that `restore` needs."""
        return dict(vars(self))

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        vars(self).update(state)
