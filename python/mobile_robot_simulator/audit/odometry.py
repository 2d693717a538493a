"""OdometryRules: whether the twists of an odometry topic are those of its poses."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import Pose
from ..instant import NANOSECONDS
from .findings import Findings

LONGEST_STEP_NS = 500_000_000
"""Longest time between two messages whose poses are compared with their twists [ns]."""

LARGEST_SHARE = 0.5
"""Largest difference between the motion of the poses and that of the twists, as a share of both, over the whole topic."""

LEAST_MOTION = 0.1
"""Least motion over the whole topic from which it says anything [m or rad]."""


class OdometryRules:
    """Compares the motion between the poses of a topic with its twists.

    One message says little, since noise and rounding weigh much in a short step. So the motion of the whole topic decides,
    for the velocity in the plane and for the yaw rate.

    Args:
        topic: The topic.
    """

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._before: tuple[int, Pose, NDArray[np.float64]] | None = None
        self._steps: list[tuple[int, float, NDArray[np.float64], NDArray[np.float64]]] = []

    def add(self, index: int, stamp: int, odometry: Any) -> None:
        """Adds a message whose pose is finite and has a quaternion.

        Args:
            index: Its position among the messages of the topic.
            stamp: Its stamp [ns].
            odometry: The message.
        """
        at, turned, twist = odometry.pose.pose.position, odometry.pose.pose.orientation, odometry.twist.twist
        pose = Pose.from_quaternion(at.x, at.y, qx=turned.x, qy=turned.y, qz=turned.z, qw=turned.w)
        velocity = np.array([twist.linear.x, twist.linear.y, twist.angular.z])
        if self._before is not None and np.isfinite(velocity).all():
            then, place, older = self._before
            if 0 < stamp - then <= LONGEST_STEP_NS:
                seconds = (stamp - then) / NANOSECONDS
                self._steps.append((index, seconds, np.array(place.twist_to(pose, seconds)), (older + velocity) / 2))
        self._before = (stamp, pose, velocity) if np.isfinite(velocity).all() else None

    def finish(self, findings: Findings) -> None:
        """Checks the motion once all messages are known.

        Args:
            findings: Where findings go.
        """
        for what, unit, part in (("velocity", "m/s", slice(0, 2)), ("yaw rate", "rad/s", slice(2, 3))):
            moved = sum(seconds * math.hypot(*pose[part]) for _, seconds, pose, _ in self._steps)
            said = sum(seconds * math.hypot(*twist[part]) for _, seconds, _, twist in self._steps)
            error = sum(seconds * math.hypot(*(pose - twist)[part]) for _, seconds, pose, twist in self._steps)
            if max(moved, said) < LEAST_MOTION or error <= LARGEST_SHARE * max(moved, said):
                continue
            for index, _, pose, twist in self._steps:
                if math.hypot(*(pose - twist)[part]) > LARGEST_SHARE * max(
                    math.hypot(*pose[part]), math.hypot(*twist[part])
                ):
                    shown = [" ".join(f"{number:.3g}" for number in each[part]) for each in (twist, pose)]
                    got = f"{what} {shown[0]} {unit} where the poses move with {shown[1]} {unit}"
                    findings.add("odometry-twist", self._topic, index, got)
