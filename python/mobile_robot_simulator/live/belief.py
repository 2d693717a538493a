"""Belief: where the odometry of a robot believes the robot to be, in the map frame."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .._core import Pose
from ..instant import NANOSECONDS
from ..messages import Odometry

if TYPE_CHECKING:
    from ..simulation.ground_truth import GroundTruth

_NOTICED = 1e-6
"""Distance that a robot must be moved without driving to count as moved by hand [m]."""


class Belief:
    """Believed pose of one robot.

    The odometry measures motion only. So its frame is placed in the map such that both poses agree at the first odometry
    message, and again when the robot is moved by hand or reset.
    """

    def __init__(self) -> None:
        self._map_from_odom: Pose | None = None
        self._since_ns = 0
        self._last: tuple[Pose, float, int] | None = None

    def update(self, truth: GroundTruth, odometry: object, moves: int) -> tuple[Pose, bool]:
        """Returns the believed pose now, and True if the robot has been moved by hand since the last call.

        Between two odometry messages, the believed pose moves as the true one does.

        Args:
            truth: True state of the robot.
            odometry: Last message of the robot's odometry; anything else if there is none.
            moves: Number of moves by hand that are known of. Others are noticed if the robot is farther away than it drove.
        """
        pose, distance, now_ns = truth.pose, truth.distance, round(truth.time * NANOSECONDS)
        moved = False
        if self._last is None:
            self._since_ns = now_ns if now_ns else -1
        else:
            before, driven, known = self._last
            way = math.hypot(pose.x - before.x, pose.y - before.y)
            moved = moves != known or distance < driven or way > distance - driven + _NOTICED
            if moved:
                self._map_from_odom, self._since_ns = None, now_ns
        self._last = pose, distance, moves
        if not isinstance(odometry, Odometry) or odometry.header.stamp.nanoseconds <= self._since_ns:
            return pose, moved
        then = truth.pose_at(odometry.header.stamp.nanoseconds / NANOSECONDS)
        place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        reported = Pose.from_quaternion(place.x, place.y, qx=turn.x, qy=turn.y, qz=turn.z, qw=turn.w)
        if self._map_from_odom is None:
            self._map_from_odom = then * reported.inverse()
        return self._map_from_odom * reported * (then.inverse() * pose), moved
