"""DriveProfile: the velocity of a robot on wheels over time, from one command until the next, and how it steers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .._core import Drive, Pose, WheelMotion
from ..instant import NANOSECONDS
from .velocity_profile import STANDING, Velocity, VelocityProfile


@dataclass(frozen=True)
class Steering:
    """The steering angle of a robot over time: it turns to its goal at a constant rate, and stays there.

    Attributes:
        drive: Wheels of the robot, with the limits of its steering.
        start_ns: Start time [ns].
        angle: Steering angle at the start [rad].
        goal: Steering angle to aim at [rad].
        rate: Largest rate of change [rad/s], beside that of the drive.

    """

    drive: Drive
    start_ns: int
    angle: float = 0.0
    goal: float = 0.0
    rate: float = math.inf

    def at(self, time_ns: float) -> float:
        """Steering angle [rad]."""
        return self._motion.steering(self._elapsed(time_ns))

    def rate_at(self, time_ns: float) -> float:
        """Rate of change of the steering angle [rad/s]."""
        return self._motion.steering_rate(self._elapsed(time_ns))

    def moving(self, velocity: Velocity, command: Velocity, profile: VelocityProfile, time_ns: float) -> WheelMotion:
        """Motion of the wheels from a time on, under the limits of a profile.

        Args:
            velocity: Velocity at that time.
            command: Velocity that is commanded from then on.
            profile: Has the limits.
            time_ns: The time [ns].

        """
        return WheelMotion(
            self.drive,
            velocity,
            command,
            limits=profile.limits,
            steering_angle=self.at(time_ns),
            steering_goal=self.goal,
            steering_rate=self.rate,
        )

    @cached_property
    def _motion(self) -> WheelMotion:
        return WheelMotion(
            self.drive,
            STANDING,
            STANDING,
            steering_angle=self.angle,
            steering_goal=self.goal,
            steering_rate=self.rate,
        )

    def _elapsed(self, time_ns: float) -> float:
        return max(0, time_ns - self.start_ns) / NANOSECONDS


@dataclass(kw_only=True)
class DriveProfile(VelocityProfile):
    """A `VelocityProfile` of a robot on wheels: they do what `WheelMotion` says.

    The command is a velocity that `Drive.command` returned. The steering does not end with the command.

    Attributes:
        steering: Steering angle of the robot.

    """

    steering: Steering

    def held_until(self, until_ns: int) -> DriveProfile:
        """Returns this profile with a command that ends at another time [ns]."""
        return replace(self, until_ns=until_ns)

    @property
    def is_constant(self) -> bool:
        """True if the velocity does not change until the command ends."""
        return self.limits is None and self.steering.drive.kind != "ackermann"

    def velocity_at(self, time_ns: float) -> Velocity:
        """Velocity of the robot without slip."""
        motion, elapsed = self._motion_at(time_ns)
        return motion.velocity(elapsed)

    def ramp_velocity_at(self, time_ns: float) -> Velocity:
        """Velocity from which another profile goes on."""
        motion, elapsed = self._motion_at(time_ns)
        return motion.ramp_velocity(elapsed)

    def move(self, pose: Pose, time_ns: float, grip: float = 1.0) -> Pose:
        """Pose that is reached at a time by a robot that was at a pose at the start; see `VelocityProfile.move`."""
        pose = self._driving.integrate(pose, self._held(time_ns), grip=grip)
        after = self._seconds_after_end(time_ns)
        return pose if after == 0.0 else self._released.integrate(pose, after, grip=grip)

    def trace(self, pose: Pose, times_ns: NDArray[np.int64], grip: float = 1.0) -> NDArray[np.float64]:
        """Poses that are reached at several times; see `VelocityProfile.trace`."""
        poses = self._driving.trace(pose, self._held_times(times_ns), grip=grip)
        is_after = times_ns > self.until_ns
        if is_after.any():
            released = self._driving.integrate(pose, self._held(self.until_ns), grip=grip)
            after = (times_ns[is_after] - self.until_ns) / NANOSECONDS
            poses[is_after] = self._released.trace(released, after, grip=grip)
        return poses

    def distance(self, time_ns: float) -> float:
        """Length of the path without slip since the start [m]."""
        driven = self._driving.distance(self._held(time_ns))
        after = self._seconds_after_end(time_ns)
        return driven if after == 0.0 else driven + self._released.distance(after)

    def rolled(self, time_ns: float, drive: Drive, steering: float) -> NDArray[np.float64]:
        """Angle by which each wheel has turned since the start [rad]; see `VelocityProfile.rolled`."""
        rolled = self._driving.rolled(self._held(time_ns))
        after = self._seconds_after_end(time_ns)
        return rolled if after == 0.0 else rolled + self._released.rolled(after)

    @cached_property
    def _driving(self) -> WheelMotion:
        """Motion while the command is held."""
        return self.steering.moving(self.velocity, self.command, self, self.start_ns)

    @cached_property
    def _released(self) -> WheelMotion:
        """Motion after the end of the command."""
        velocity = self._driving.ramp_velocity(self._held(self.until_ns))
        return self.steering.moving(velocity, STANDING, self, self.until_ns)

    def _motion_at(self, time_ns: float) -> tuple[WheelMotion, float]:
        """The motion at a time, and the time since it began [s]."""
        if time_ns < self.until_ns:
            return self._driving, self._held(time_ns)
        return self._released, self._seconds_after_end(time_ns)
