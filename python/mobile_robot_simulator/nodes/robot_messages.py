"""The messages of a robot: odometry, transforms and clock."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .._core import Pose
from ..messages import (
    Clock,
    Header,
    JointState,
    Odometry,
    PoseWithCovariance,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    Twist,
    TwistWithCovariance,
    Vector3,
)
from ..messages import Pose as PoseMessage
from ..physics.odometer import PLANAR_COVARIANCE
from ..physics.velocity_profile import Velocity
from ..physics.wheel_course import WheelCourse


def clock_message(stamp_ns: int) -> Clock:
    """Returns the message for /clock, for a time [ns]."""
    return Clock(Time.from_nanoseconds(stamp_ns))


def exact_odometry_message(stamp_ns: int, frames: tuple[str, str], course: WheelCourse) -> Odometry:
    """Returns the message for odometry without errors: `odometry_message` for a stamp [ns] and what the wheels do then."""
    return odometry_message(Time.from_nanoseconds(stamp_ns), frames, course.pose, course.velocity)


def exact_transforms_message(
    stamp_ns: int, map_frame: tuple[str, Pose] | None, frames: tuple[str, str], course: WheelCourse
) -> TFMessage:
    """Returns the transforms that belong to `exact_odometry_message`.

    Args:
        stamp_ns: Time of the transforms [ns].
        map_frame: Name of the map frame, and the pose of the odometry frame in it; None if it is not published.
        frames: Frame of the odometry, and the robot's frame.
        course: What the wheels do at that time.
    """
    links = [] if map_frame is None else [(map_frame[0], frames[0], map_frame[1])]
    return transforms_message(Time.from_nanoseconds(stamp_ns), [*links, (*frames, course.pose)])


def odometry_message(
    stamp: Time,
    frames: tuple[str, str],
    pose: Pose,
    velocity: Velocity,
    covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
    twist_covariance: NDArray[np.float64] = PLANAR_COVARIANCE,
) -> Odometry:
    """Returns the message for a pose and a velocity.

    Args:
        stamp: Time of both.
        frames: Frame of the pose, and the robot's frame, in which the velocity is.
        pose: Pose of the robot.
        velocity: Velocity of the robot.
        covariance: Covariance of the pose, (36,).
        twist_covariance: Covariance of the velocity, (36,).
    """
    vx, vy, wz = velocity
    return Odometry(
        Header(stamp, frames[0]),
        frames[1],
        PoseWithCovariance(PoseMessage.from_planar(pose), covariance),
        TwistWithCovariance(Twist(Vector3(vx, vy), Vector3(0.0, 0.0, wz)), twist_covariance),
    )


def transforms_message(stamp: Time, links: Iterable[tuple[str, str, Pose]]) -> TFMessage:
    """Returns the message for /tf.

    Args:
        stamp: Time of the transforms.
        links: Name of the frame, name of the child frame, and pose of the child in the frame, for each transform.
    """
    return TFMessage(
        [TransformStamped(Header(stamp, frame), child, Transform.from_planar(pose)) for frame, child, pose in links]
    )


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
