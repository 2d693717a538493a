"""WheelOdometer: the pose that a robot computes from the encoders of its wheels, with errors of its calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .._core import Drive, Pose
from ..instant import NANOSECONDS
from .motion import Motion
from .velocity_profile import STANDING, Velocity


@dataclass(frozen=True, slots=True)
class WheelReading:
    """What a `WheelOdometer` read at one time. The array is never changed in place.

    Attributes:
        time_ns: The time [ns].
        angles: Angle of each wheel [rad].
        steering: Steering angle of the robot [rad].
        wheels: Pose that the robot would have if its wheels had never slipped.
        pose: Pose that the odometer computes, in the same frame.
        velocity: Mean velocity since the reading before, as the odometer computes it.

    """

    time_ns: int
    angles: NDArray[np.float64]
    steering: float
    wheels: Pose
    pose: Pose
    velocity: Velocity


class WheelOdometer:
    """Computes the pose of a robot from the angles of its wheels, each time it is read.

    Between two readings it takes the path for an arc, as a real one does. The steering angle is measured exactly; its mean
    between two readings is that of both.

    Args:
        drive: Wheels of the robot with the radius and the track that the robot believes in.
        ticks: Counts of an encoder per turn of its wheel; 0 for exact encoders.
        motion: Motion of the robot.
        pose: First pose that the odometer reports.
        time_ns: The present [ns].

    """

    def __init__(self, drive: Drive, ticks: float, motion: Motion, pose: Pose, time_ns: int) -> None:
        self._drive, self._ticks = drive, ticks
        self._latest = self._reading(motion, pose, STANDING, time_ns)

    def read(self, motion: Motion, time_ns: int) -> WheelReading:
        """Reads the wheels now [ns]."""
        before = self._latest
        if time_ns > before.time_ns:
            now = self._reading(motion, before.pose, before.velocity, time_ns)
            steering = 0.5 * (before.steering + now.steering) if self._drive.kind == "ackermann" else None
            arc = self._drive.odometry(before.angles, now.angles, steering_angle=steering, ticks=self._ticks)
            pose, dt = before.pose.integrate(arc, 1.0).wrapped(), (time_ns - before.time_ns) / NANOSECONDS
            velocity = arc[0] / dt, arc[1] / dt, arc[2] / dt
            self._latest = WheelReading(time_ns, now.angles, now.steering, now.wheels, pose, velocity)
        return self._latest

    def pose_at(self, wheels: Pose) -> Pose:
        """Pose after the last reading, as if there had been no error since then. Changes no later reading.

        Args:
            wheels: Pose that the robot would have if its wheels had never slipped.

        """
        return (self._latest.pose * self._latest.wheels.inverse() * wheels).wrapped()

    def save(self) -> WheelReading:
        """Returns the state for `restore`."""
        return self._latest

    def restore(self, state: WheelReading) -> None:
        """Returns to a saved state."""
        self._latest = state

    @staticmethod
    def _reading(motion: Motion, pose: Pose, velocity: Velocity, time_ns: int) -> WheelReading:
        steering = motion.steering_at(time_ns)
        return WheelReading(time_ns, motion.rolled(time_ns), steering, motion.wheel_pose(time_ns).wrapped(), pose, velocity)
