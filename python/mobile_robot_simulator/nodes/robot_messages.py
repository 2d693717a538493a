"""The messages of a robot: odometry, transforms and clock.

A function below `@recipe` returns the values of its message; see `MessageRecipe`. To its callers it returns the message.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Pose
from ..instant import NANOSECONDS
from ..message_recipe import recipe
from ..messages import Clock, Header, JointState, Odometry, TFMessage, Time
from ..physics.odometer import PLANAR_COVARIANCE
from ..physics.velocity_profile import Velocity
from ..physics.wheel_course import WheelCourse


@recipe(Clock)
def clock_message(stamp_ns: int) -> tuple[Any, ...]:
    """Returns the message for /clock, for a time [ns]."""
    return divmod(stamp_ns, NANOSECONDS)


@recipe(Odometry)
def exact_odometry_message(stamp_ns: int, frames: tuple[str, str], course: WheelCourse) -> tuple[Any, ...]:
    """Returns the message for odometry without errors: `odometry_message` for a stamp [ns] and what the wheels do then."""
    return _odometry(*divmod(stamp_ns, NANOSECONDS), frames, course.pose, course.velocity)


@recipe(TFMessage)
def exact_transforms_message(
    stamp_ns: int, map_frame: tuple[str, Pose] | None, frames: tuple[str, str], course: WheelCourse
) -> tuple[Any, ...]:
    """Returns the transforms that belong to `exact_odometry_message`.

    Args:
        stamp_ns: Time of the transforms [ns].
        map_frame: Name of the map frame, and the pose of the odometry frame in it; None if it is not published.
        frames: Frame of the odometry, and the robot's frame.
        course: What the wheels do at that time.
    """
    sec, nanosec = divmod(stamp_ns, NANOSECONDS)
    frame, child = frames
    transform = _transform(sec, nanosec, frame, child, course.pose)
    if map_frame is None:
        return ([transform],)
    name, pose = map_frame
    return ([_transform(sec, nanosec, name, frame, pose), transform],)


@recipe(Odometry)
def odometry_message(
    stamp: Time,
    frames: tuple[str, str],
    pose: Pose,
    velocity: Velocity,
    covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
    twist_covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
) -> tuple[Any, ...]:
    """Returns the message for a pose and a velocity.

    Args:
        stamp: Time of both.
        frames: Frame of the pose, and the robot's frame, in which the velocity is.
        pose: Pose of the robot.
        velocity: Velocity of the robot.
        covariance: Covariance of the pose, (36,).
        twist_covariance: Covariance of the velocity, (36,).
    """
    return _odometry(stamp.sec, stamp.nanosec, frames, pose, velocity, covariance, twist_covariance)


@recipe(TFMessage)
def transforms_message(stamp: Time, links: Iterable[tuple[str, str, Pose]]) -> tuple[Any, ...]:
    """Returns the message for /tf.

    Args:
        stamp: Time of the transforms.
        links: Name of the frame, name of the child frame, and pose of the child in the frame, for each transform.
    """
    return ([_transform(stamp.sec, stamp.nanosec, *link) for link in links],)


def _odometry(
    sec: int,
    nanosec: int,
    frames: tuple[str, str],
    pose: Pose,
    velocity: Velocity,
    covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
    twist_covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
) -> tuple[Any, ...]:
    """Returns the values of an Odometry: header, child frame, position, orientation, linear and angular velocity."""
    frame, child = frames
    z, w = pose.quaternion
    vx, vy, wz = velocity
    twist = vx, vy, 0.0, 0.0, 0.0, wz, twist_covariance
    return sec, nanosec, frame, child, pose.x, pose.y, 0.0, 0.0, 0.0, z, w, covariance, *twist


def _transform(sec: int, nanosec: int, frame: str, child: str, pose: Pose) -> tuple[Any, ...]:
    """Returns the values of a TransformStamped: header, child frame, translation and rotation."""
    z, w = pose.quaternion
    return sec, nanosec, frame, child, pose.x, pose.y, 0.0, 0.0, 0.0, z, w


def joint_states_message(
    stamp: Time, names: tuple[str, ...], joints: tuple[NDArray[np.float64], NDArray[np.float64]]
) -> JointState:
    """Returns the message for the wheels and the steering of a robot.

    Args:
        stamp: Time of both.
        names: Name of each joint.
        joints: Positions [rad] and velocities [rad/s] of the joints.
    """
    return JointState(Header(stamp), list(names), *joints)
