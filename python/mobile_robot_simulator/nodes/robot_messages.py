"""The messages of a robot: odometry, transforms and clock.

A function below `@recipe` returns the values of its message; see `MessageRecipe`. To its callers it returns the message.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
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


def _split_odometry(
    stamp_ns: int, frames: tuple[str, str], course: WheelCourse
) -> tuple[tuple[str, str], tuple[float, ...]]:
    return frames, (*divmod(stamp_ns, NANOSECONDS), *course.place, *course.velocity)


@recipe(Odometry, _split_odometry)
def exact_odometry_message(
    frames: tuple[str, str], sec: int, nanosec: int, x: float, y: float, z: float, w: float, *velocity: float
) -> tuple[Any, ...]:
    """Returns the message for odometry without errors: `odometry_message` for a stamp [ns] and what the wheels do then.

    Its arguments are the stamp, the frame of the odometry with the robot's frame, and a `WheelCourse`.
    """
    return _odometry(sec, nanosec, frames, (x, y, z, w), velocity)


def _split_transforms(
    stamp_ns: int, map_frame: tuple[str, Pose] | None, frames: tuple[str, str], course: WheelCourse
) -> tuple[tuple[str, ...], tuple[float, ...]]:
    if map_frame is None:
        return frames, (*divmod(stamp_ns, NANOSECONDS), *course.place)
    name, pose = map_frame
    return (name, *frames), (*divmod(stamp_ns, NANOSECONDS), pose.x, pose.y, *pose.quaternion, *course.place)


@recipe(TFMessage, _split_transforms)
def exact_transforms_message(chain: tuple[str, ...], sec: int, nanosec: int, *places: float) -> tuple[Any, ...]:
    """Returns the transforms that belong to `exact_odometry_message`.

    Its arguments are the stamp [ns], the name of the map frame with the pose of the odometry frame in it, or None if that is
    not published, the frame of the odometry with the robot's frame, and a `WheelCourse`.
    """
    links = pairwise(chain)
    return ([(sec, nanosec, *link, *_place(*places[4 * at : 4 * at + 4])) for at, link in enumerate(links)],)


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
    place = (pose.x, pose.y, *pose.quaternion)
    return _odometry(stamp.sec, stamp.nanosec, frames, place, velocity, covariance, twist_covariance)


@recipe(TFMessage)
def transforms_message(stamp: Time, links: Iterable[tuple[str, str, Pose]]) -> tuple[Any, ...]:
    """Returns the message for /tf.

    Args:
        stamp: Time of the transforms.
        links: Name of the frame, name of the child frame, and pose of the child in the frame, for each transform.
    """
    head = stamp.sec, stamp.nanosec
    return ([(*head, frame, child, *_place(pose.x, pose.y, *pose.quaternion)) for frame, child, pose in links],)


def _odometry(
    sec: int,
    nanosec: int,
    frames: tuple[str, str],
    place: tuple[float, float, float, float],
    velocity: tuple[float, ...],
    covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
    twist_covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
) -> tuple[Any, ...]:
    """Returns the values of an Odometry: header, child frame, position, orientation, linear and angular velocity."""
    vx, vy, wz = velocity
    twist = vx, vy, 0.0, 0.0, 0.0, wz, twist_covariance
    return sec, nanosec, *frames, *_place(*place), covariance, *twist


def _place(x: float, y: float, z: float, w: float) -> tuple[float, ...]:
    """Returns the values of a position, or a translation, and of a rotation with these components of its quaternion."""
    return x, y, 0.0, 0.0, 0.0, z, w


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
