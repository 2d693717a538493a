"""Odometer: the pose and the velocity that a robot estimates from its wheels, exact or with drift, and their covariance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import MotionNoise, Pose
from ..instant import NANOSECONDS
from .velocity_profile import Velocity

EXACT, UNMEASURED = 1e-9, 1e6
"""Variance [m^2 or rad^2] of a coordinate that is known exactly, and of one that is not measured.

`EXACT` is not zero, because some receivers read zero as "unknown" and others cannot invert the matrix.
"""

PLANE = (0, 1, 5)
"""Rows of x, y and yaw among (x, y, z, rot x, rot y, rot z)."""


def _spatial_covariance(plane: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the read-only covariance (36,) of a pose or twist in space from the (3, 3) covariance of x, y and yaw."""
    covariance = np.diag([0.0, 0.0, UNMEASURED, UNMEASURED, UNMEASURED, 0.0])
    covariance[np.ix_(PLANE, PLANE)] = plane + EXACT * np.eye(3)
    flat = covariance.reshape(-1)
    flat.flags.writeable = False
    return flat


PLANAR_COVARIANCE = np.frombuffer(_spatial_covariance(np.zeros((3, 3))).tobytes())
"""Covariance (36,) of exact odometry in the plane: x, y and yaw are exact; height, roll and pitch are not measured.

As an array of a `bytes`, it can never change, so recordings convert it only once.
"""


@dataclass(slots=True)
class OdometerReading:
    """What an odometer estimates. Covariances are (36,) float64, row-major, over (x, y, z, rot x, rot y, rot z)."""

    pose: Pose
    """Pose in the odometry frame."""
    covariance: NDArray[np.float64]
    """Covariance of the pose."""
    twist: Velocity | None
    """Mean velocity since the last reading, in the robot's frame; None if it is that of the wheels."""
    twist_covariance: NDArray[np.float64]
    """Covariance of the mean velocity."""


@dataclass(frozen=True, slots=True)
class OdometerSnapshot:
    """State of an `Odometer` at one time, as returned by `Odometer.save`.

    The arrays are shared with the odometer, which never changes them in place.
    """

    noise: MotionNoise | None
    seed: int
    index: int
    wheels: Pose
    time_ns: int
    plane: NDArray[np.float64]
    reading: OdometerReading


class Odometer:
    """Estimates the pose and the velocity of a robot from the motion of its wheels.

    With noise, pose and velocity tell the same story: the velocity is the one that moves the robot from the last estimate of
    the pose to this one.

    Args:
        wheels: First pose of the wheels, in the odometry frame.
        time_ns: Time of that pose [ns].
        noise: Noise of the motion between two readings; None for exact odometry.
        seed: Seed of the noise.

    """

    def __init__(self, wheels: Pose, time_ns: int, *, noise: MotionNoise | None = None, seed: int = 0) -> None:
        self.set_noise(noise, seed)
        self._wheels, self._time_ns = wheels, time_ns
        self._plane = np.zeros((3, 3))
        self._reading = OdometerReading(wheels, PLANAR_COVARIANCE, None, PLANAR_COVARIANCE)

    @property
    def is_exact(self) -> bool:
        """True if the estimate is the pose of the wheels."""
        return self._noise is None and self._reading.covariance is PLANAR_COVARIANCE

    def set_noise(self, noise: MotionNoise | None, seed: int) -> None:
        """Changes the noise from now on. The errors made so far stay."""
        self._noise, self._seed, self._index = noise, seed, 0

    def read(self, wheels: Pose, time_ns: int) -> OdometerReading:
        """Estimates pose and velocity at a time.

        Args:
            wheels: Pose of the wheels at that time, without noise.
            time_ns: The time [ns].

        """
        if self._noise is None and self._reading.covariance is PLANAR_COVARIANCE:
            self._reading = OdometerReading(wheels, PLANAR_COVARIANCE, None, PLANAR_COVARIANCE)
        elif time_ns > self._time_ns:
            self._reading = self._estimate(wheels, (time_ns - self._time_ns) / NANOSECONDS)
        self._wheels, self._time_ns = wheels, time_ns
        return self._reading

    def pose_at(self, wheels: Pose) -> Pose:
        """Estimates the pose after the last reading, as if there had been no noise since then. Changes no later reading.

        Args:
            wheels: Pose of the wheels, without noise.

        """
        if self.is_exact:
            return wheels
        return (self._reading.pose * self._wheels.inverse() * wheels).wrapped()

    def _estimate(self, wheels: Pose, dt: float) -> OdometerReading:
        twist, before = self._wheels.twist_to(wheels, dt), self._reading.pose
        noise = NO_NOISE if self._noise is None else self._noise
        pose = noise.sample(before, twist, dt, seed=self._seed, index=self._index).wrapped()
        self._index += 1
        self._plane = noise.propagate(self._plane, before, twist, dt)
        twist_covariance = _spatial_covariance(noise.twist_covariance(twist, dt))
        return OdometerReading(pose, _spatial_covariance(self._plane), before.twist_to(pose, dt), twist_covariance)

    def save(self) -> OdometerSnapshot:
        """Returns a snapshot for `restore`."""
        return OdometerSnapshot(
            self._noise, self._seed, self._index, self._wheels, self._time_ns, self._plane, self._reading
        )

    def restore(self, state: OdometerSnapshot) -> None:
        """Returns to the state of a snapshot."""
        self._noise, self._seed, self._index = state.noise, state.seed, state.index
        self._wheels, self._time_ns, self._plane = state.wheels, state.time_ns, state.plane
        self._reading = state.reading


NO_NOISE = MotionNoise()
