"""Push: a velocity that the world adds to that of a robot."""

from __future__ import annotations

from typing import TypeAlias

from .._core import Pose
from .velocity_profile import Velocity

Push: TypeAlias = tuple[float, float]
"""Velocity (vx, vy) in the map frame [m/s], beside that of the wheels. It does not turn the robot."""


def displaced(pose: Pose, push: Push, duration: float) -> Pose:
    """Returns a pose after a push.

    The wheels move the robot in its own frame, and a push does not change its heading. So the robot reaches the pose that it
    would reach without the push, displaced by velocity times duration, exactly.

    Args:
        pose: Pose that is reached without the push.
        push: Its velocity, in the frame of the pose.
        duration: How long it has lasted [s].
    """
    return Pose(pose.x + push[0] * duration, pose.y + push[1] * duration, pose.yaw)


def turned(push: Push, yaw: float) -> Push:
    """Returns a push in a frame whose axes are turned clockwise by a yaw [rad]: `turned((1.0, 0.0), pi / 2)` is (0, 1)."""
    velocity = Pose(0.0, 0.0, yaw) * Pose(*push)
    return velocity.x, velocity.y


def with_push(velocity: Velocity, push: Push, yaw: float) -> Velocity:
    """Returns the velocity of a robot that is pushed, in its own frame.

    Args:
        velocity: Velocity that its wheels give it, in its own frame.
        push: The push.
        yaw: Heading of the robot in the frame of the push [rad].
    """
    vx, vy = turned(push, -yaw)
    return velocity[0] + vx, velocity[1] + vy, velocity[2]
