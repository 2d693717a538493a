"""VelocityProfile: the velocity of a robot's wheels over time, from one command until the next."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._core import Drive, Limits, Pose
from ..instant import NANOSECONDS

Velocity: TypeAlias = tuple[float, float, float]
"""Velocity (vx, vy, wz) in the robot's frame: forward and to the left [m/s], counter-clockwise [rad/s]."""

STANDING: Velocity = (0.0, 0.0, 0.0)

FOREVER = 2**62
"""End time of a command without a timeout [ns]."""


@dataclass(slots=True)
class VelocityProfile:
    """The velocity of a robot's wheels while it follows a command, and after the command has ended.

    Profiles never change, as segments; see `Segment`.

    Without limits, the velocity is that of the command from the start until `until_ns`, then zero. With limits, it
    approaches the command, and after `until_ns` zero, as fast as they allow.

    Attributes:
        start_ns: Start time [ns].
        velocity: Velocity of the wheels just before the start. Matters only with limits.
        command: Velocity that is commanded until `until_ns`.
        until_ns: Time at which the command ends [ns].
        limits: Limits on the velocity and its change; None for no limits.

    """

    start_ns: int
    velocity: Velocity
    command: Velocity
    until_ns: int
    limits: Limits | None = None

    def held_until(self, until_ns: int) -> VelocityProfile:
        """Returns this profile with a command that ends at another time [ns]."""
        return VelocityProfile(self.start_ns, self.velocity, self.command, until_ns, self.limits)

    @property
    def is_constant(self) -> bool:
        """True if the velocity does not change until the command ends."""
        return self.limits is None

    def ramp_velocity_at(self, time_ns: float) -> Velocity:
        """Velocity from which another profile goes on."""
        return self.velocity_at(time_ns)

    def velocity_at(self, time_ns: float) -> Velocity:
        """Velocity of the wheels."""
        if self.limits is None:
            return self.command if time_ns < self.until_ns else STANDING
        velocity = self.limits.apply(self.command, self.velocity, self._held(time_ns))
        after = self._seconds_after_end(time_ns)
        return velocity if after == 0.0 else self.limits.apply(STANDING, velocity, after)

    def move(self, pose: Pose, time_ns: float, grip: float = 1.0) -> Pose:
        """Pose that is reached at a time by a robot that was at a pose at the start.

        Args:
            pose: Pose at the start, in any frame.
            time_ns: The time [ns]. Before the start, the pose stays that of the start.
            grip: Share of the motion of the wheels that the robot makes; 1 without slip.

        """
        held = self._held(time_ns)
        if self.limits is None:
            return pose.integrate(self.command if grip == 1.0 else scaled(self.command, grip), held)
        pose = self.limits.integrate(pose, self.command, self.velocity, held, grip=grip)
        after = self._seconds_after_end(time_ns)
        if after == 0.0:
            return pose
        velocity = self.limits.apply(self.command, self.velocity, held)
        return self.limits.integrate(pose, STANDING, velocity, after, grip=grip)

    def trace(self, pose: Pose, times_ns: NDArray[np.int64], grip: float = 1.0) -> NDArray[np.float64]:
        """Poses that are reached at several times: those of `move`.

        Args:
            pose: Pose at the start, in any frame.
            times_ns: (N,) int64, the times [ns].
            grip: Share of the motion of the wheels that the robot makes; 1 without slip.

        Returns:
            (N, 3) float64, rows (x, y, yaw) [m, m, rad].
        """
        held = self._held_times(times_ns)
        if self.limits is None:
            return pose.trace(scaled(self.command, grip), held)
        poses = self.limits.trace(pose, self.command, self.velocity, held, grip=grip)
        is_after = times_ns > self.until_ns
        if is_after.any():
            longest = self._held(self.until_ns)
            velocity = self.limits.apply(self.command, self.velocity, longest)
            released = self.limits.integrate(pose, self.command, self.velocity, longest, grip=grip)
            after = (times_ns[is_after] - self.until_ns) / NANOSECONDS
            poses[is_after] = self.limits.trace(released, STANDING, velocity, after, grip=grip)
        return poses

    def distance(self, time_ns: float) -> float:
        """Length of the path that the wheels have driven since the start [m]."""
        held = self._held(time_ns)
        if self.limits is None:
            return math.hypot(self.command[0], self.command[1]) * held
        driven = self.limits.distance(self.command, self.velocity, held)
        after = self._seconds_after_end(time_ns)
        if after == 0.0:
            return driven
        velocity = self.limits.apply(self.command, self.velocity, held)
        return driven + self.limits.distance(STANDING, velocity, after)

    def rolled(self, time_ns: float, drive: Drive, steering: float) -> NDArray[np.float64]:
        """Angle by which each wheel of a robot has turned since the start [rad], at a constant velocity.

        Args:
            time_ns: The time [ns].
            drive: Wheels of the robot.
            steering: Steering angle of the robot at the start [rad]. The front wheels keep it.

        Returns:
            (wheel_count,) float64.
        """
        rates: NDArray[np.float64] = drive.wheels_of_twist([self.command], [steering])[0]
        return rates * self._held(time_ns)

    def _held_times(self, times_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Times for which the command has been followed [s]."""
        held: NDArray[np.float64] = np.maximum(np.minimum(times_ns, self.until_ns) - self.start_ns, 0) / NANOSECONDS
        return held

    def _held(self, time_ns: float) -> float:
        """Time for which the command has been followed [s]."""
        held_ns = (time_ns if time_ns < self.until_ns else self.until_ns) - self.start_ns
        return held_ns / NANOSECONDS if held_ns > 0 else 0.0

    def _seconds_after_end(self, time_ns: float) -> float:
        return max(0, time_ns - self.until_ns) / NANOSECONDS


def scaled(velocity: Velocity, factor: float) -> Velocity:
    """Returns a velocity times a factor."""
    return velocity if factor == 1.0 else (velocity[0] * factor, velocity[1] * factor, velocity[2] * factor)
