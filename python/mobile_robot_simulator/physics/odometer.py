"""Odometer: the pose that a robot estimates from its wheels, exact or with drift, and the covariance of the estimate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import MotionNoise, Pose
from ..instant import NANOSECONDS

EXACT, UNMEASURED = 1e-9, 1e6
"""Variance [m^2 or rad^2] of a coordinate that is known exactly, and of one that is not measured.

`EXACT` is not zero, because some receivers read zero as "unknown" and others cannot invert the matrix.
"""

PLANE = (0, 1, 5)
"""Rows of x, y and yaw among (x, y, z, rot x, rot y, rot z)."""


def _spatial_covariance(plane: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the read-only covariance (36,) of a pose in space from the (3, 3) covariance of x, y and yaw."""
    covariance = np.diag([0.0, 0.0, UNMEASURED, UNMEASURED, UNMEASURED, 0.0])
    covariance[np.ix_(PLANE, PLANE)] = plane + EXACT * np.eye(3)
    flat = covariance.reshape(-1)
    flat.flags.writeable = False
    return flat


PLANAR_COVARIANCE = _spatial_covariance(np.zeros((3, 3)))
"""Covariance (36,) of exact odometry in the plane: x, y and yaw are exact; height, roll and pitch are not measured."""


@dataclass(frozen=True, slots=True)
class OdometerSnapshot:
    """State of an `Odometer` at one time, as returned by `Odometer.save`.

    The arrays are shared with the odometer, which never changes them in place.
    """

    index: int
    wheels: Pose
    estimate: Pose
    time_ns: int
    plane: NDArray[np.float64]
    covariance: NDArray[np.float64]


class Odometer:
    """Estimates the pose of a robot from the motion of its wheels.

    Args:
        wheels: First pose of the wheels, in the odometry frame.
        time_ns: Time of that pose [ns].
        noise: Noise of the motion between two readings; None for exact odometry.
        seed: Seed of the noise.

    """

    def __init__(self, wheels: Pose, time_ns: int, *, noise: MotionNoise | None = None, seed: int = 0) -> None:
        self._noise, self._seed = noise, seed
        self._index = 0
        self.place(wheels, time_ns)

    @property
    def is_noisy(self) -> bool:
        """True if the estimate can differ from the pose of the wheels."""
        return self._noise is not None

    def place(self, wheels: Pose, time_ns: int) -> None:
        """Sets the estimate to the pose of the wheels, and its covariance to that of exact odometry."""
        self._wheels = self._estimate = wheels
        self._time_ns = time_ns
        self._plane = np.zeros((3, 3))
        self._covariance = PLANAR_COVARIANCE

    def read(self, wheels: Pose, time_ns: int) -> tuple[Pose, NDArray[np.float64]]:
        """Estimates the pose at a time.

        Args:
            wheels: Pose of the wheels at that time, without noise.
            time_ns: The time [ns].

        Returns:
            The estimated pose, in the odometry frame, and its covariance (36,) over (x, y, z, rot x, rot y, rot z).

        """
        if self._noise is None:
            return wheels, PLANAR_COVARIANCE
        dt = (time_ns - self._time_ns) / NANOSECONDS
        if dt > 0.0:
            twist, before = self._wheels.twist_to(wheels, dt), self._estimate
            self._estimate = self._noise.sample(before, twist, dt, seed=self._seed, index=self._index).wrapped()
            self._plane = self._noise.propagate(self._plane, before, twist, dt)
            self._covariance = _spatial_covariance(self._plane)
            self._index += 1
            self._wheels, self._time_ns = wheels, time_ns
        return self._estimate, self._covariance

    def save(self) -> OdometerSnapshot:
        """Returns a snapshot for `restore`."""
        return OdometerSnapshot(self._index, self._wheels, self._estimate, self._time_ns, self._plane, self._covariance)

    def restore(self, state: OdometerSnapshot) -> None:
        """Returns to the state of a snapshot."""
        self._index, self._time_ns = state.index, state.time_ns
        self._wheels, self._estimate = state.wheels, state.estimate
        self._plane, self._covariance = state.plane, state.covariance
