"""MobileRobotSimulator: velocity commands in, odometry, transforms and the clock out."""

from __future__ import annotations

import math
from contextlib import ExitStack
from typing import Any

import numpy as np

from . import messages
from ._core import Pose
from .messages import (
    Clock,
    Header,
    Odometry,
    PoseWithCovarianceStamped,
    SetPose,
    TFMessage,
    Time,
    TransformStamped,
    Trigger,
)
from .messages import Twist as TwistMessage
from .node_interface import Node, QoS
from .parameters import RobotParameters

NANOSECONDS = 1e9

FOREVER = 2**62
"""A time in nanoseconds that is never reached."""

FASTEST = 1e3
"""Commands beyond this [m/s, rad/s] are no robot's, and are refused."""

EXACT, UNMEASURED = 1e-9, 1e6
_covariance = np.zeros((6, 6))
np.fill_diagonal(_covariance, [EXACT, EXACT, UNMEASURED, UNMEASURED, UNMEASURED, EXACT])
PLANAR_COVARIANCE = _covariance.reshape(-1)
"""What is known of a robot that moves exactly in the plane: x, y and yaw for sure, height, roll and pitch not at all.

Not zero, which means "not known" to some readers and cannot be inverted by others.
"""
PLANAR_COVARIANCE.flags.writeable = False

SET_UP = (
    "publish_map_transform",
    "publish_rate",
    "publish_clock",
    "clock_rate",
    "velocity_topic",
    "odometry_topic",
    "cmd_vel_stamped",
)
"""Parameters that what `start` sets up hangs on."""

Velocity = tuple[float, float, float]
STANDING: Velocity = (0.0, 0.0, 0.0)


class MobileRobotSimulator:
    """A robot that does exactly what it is told.

    Takes velocity commands (Twist or TwistStamped) and holds each until the next, or until `velocity_timeout`. Publishes
    odometry, the transform odom -> base_link and the clock at `publish_rate`, and, with `publish_map_transform`, the
    transform map -> odom; then it also takes /initialpose. The pose at any time is computed from the last command on,
    exactly, so that it does not depend on the publishing rate. The service `reset` puts the robot back to where it was at
    first, `set_pose` anywhere.

    node: what to publish and subscribe through. start_pose: where in the map frame the robot is at first.
    """

    def __init__(self, node: Node, parameters: RobotParameters | None = None, *, start_pose: Pose | None = None) -> None:
        self._node = node
        self._parameters = parameters or RobotParameters()
        self._first_pose = start_pose or Pose()
        self._running: ExitStack | None = None
        self.reset()

    @property
    def parameters(self) -> RobotParameters:
        """The parameters in use."""
        return self._parameters

    @property
    def pose(self) -> Pose:
        """Where the robot is now, in the map frame."""
        return (self._map_from_odom * self._odom_from_base(self._now())).wrapped()

    @property
    def velocity(self) -> Velocity:
        """How the robot moves now: forward, leftward [m/s] and turning [rad/s]."""
        return self._twist if self._now() < self._until_ns else STANDING

    @property
    def distance(self) -> float:
        """Length of the way driven so far [m]."""
        return self._driven(self._now())

    def reset(self) -> None:
        """Put the robot back to where it was at first, at rest, with odometry as it was then and no distance driven."""
        self._map_from_odom = self._odom_from_start = Pose()
        self._twist, self._driven_to_start = STANDING, 0.0
        self._start_ns = self._until_ns = self._now()
        self.set_pose(self._first_pose)

    def set_parameters(self, **values: Any) -> None:
        """Change parameters by their names, from now on. A command in force is held anew, for `velocity_timeout`.

        raises: ValueError that names the parameter, its value and what was needed; then nothing changes.
        """
        before, after = self._parameters, self._parameters.changed(values)
        if after == before:
            return
        self._parameters = after
        now = self._now()
        if now < self._until_ns and after.velocity_timeout != before.velocity_timeout:
            self._until_ns = self._end_of_command(now)
        if self._running is None:
            return
        self._node.set_speed(after.speed_factor)
        if all(getattr(before, name) == getattr(after, name) for name in SET_UP):
            return
        try:
            self._restart()
        except Exception:
            self._parameters = before
            self._restart()
            raise

    def set_pose(self, pose: Pose) -> None:
        """Put the robot somewhere in the map.

        With the map transform, odometry goes on as if nothing had happened and map -> odom takes up the change; without,
        odometry itself starts anew from there.
        """
        now = self._now()
        odom_from_base = self._odom_from_base(now)
        if self._parameters.publish_map_transform:
            self._map_from_odom = (pose * odom_from_base.inverse()).wrapped()
        else:
            self._move_to(pose, now)

    def start(self) -> None:
        """Take commands and publish from now on."""
        if self._running is not None:
            return
        node, parameters = self._node, self._parameters
        with ExitStack() as handles:
            self._odometry = node.create_publisher(Odometry, parameters.odometry_topic, QoS.DEFAULT)
            handles.callback(node.destroy_publisher, self._odometry)
            self._transforms = node.create_publisher(TFMessage, "/tf", QoS.DEFAULT)
            handles.callback(node.destroy_publisher, self._transforms)
            self._clock = node.create_publisher(Clock, "/clock", QoS.CLOCK) if parameters.publish_clock else None
            if self._clock is not None:
                handles.callback(node.destroy_publisher, self._clock)
            if parameters.cmd_vel_stamped:
                commands = node.create_subscription(
                    messages.TwistStamped,
                    parameters.velocity_topic,
                    lambda message: self._command(message.twist),
                    QoS.DEFAULT,
                )
            else:
                commands = node.create_subscription(TwistMessage, parameters.velocity_topic, self._command, QoS.DEFAULT)
            handles.callback(node.destroy_subscription, commands)
            if parameters.publish_map_transform:
                poses = node.create_subscription(PoseWithCovarianceStamped, "/initialpose", self._take_pose, QoS.DEFAULT)
                handles.callback(node.destroy_subscription, poses)
            handles.callback(node.destroy_service, node.create_service(Trigger, "reset", self._answer_reset))
            handles.callback(node.destroy_service, node.create_service(SetPose, "set_pose", self._answer_set_pose))
            node.set_speed(parameters.speed_factor)
            handles.callback(node.destroy_timer, node.create_timer(1.0 / parameters.publish_rate, self._publish))
            if parameters.clock_rate > 0.0:
                handles.callback(node.destroy_timer, node.create_timer(1.0 / parameters.clock_rate, self._publish_clock))
            self._running = handles.pop_all()

    def stop(self) -> None:
        """Stand still, take no more commands and publish nothing; `start` goes on from here."""
        if self._running is not None:
            self._running.close()
            self._running = None
            now = self._now()
            self._move_to(self._odom_from_base(now), now)
            self._twist = STANDING

    def _restart(self) -> None:
        """Set everything up afresh, without standing still."""
        if self._running is not None:
            self._running.close()
            self._running = None
        self.start()

    def _now(self) -> int:
        return self._node.get_clock().now().nanoseconds

    def _moving(self, time_ns: int) -> float:
        """Seconds that the robot has moved under the last command since it was at its last known pose."""
        return max(0, min(time_ns, self._until_ns) - self._start_ns) / NANOSECONDS

    def _odom_from_base(self, time_ns: int) -> Pose:
        return self._odom_from_start.integrate(self._twist, self._moving(time_ns))

    def _driven(self, time_ns: int) -> float:
        return self._driven_to_start + math.hypot(*self._twist[:2]) * self._moving(time_ns)

    def _move_to(self, odom_from_base: Pose, time_ns: int) -> None:
        """Be at a pose, and move on from there as before."""
        self._driven_to_start = self._driven(time_ns)
        self._odom_from_start, self._start_ns = odom_from_base.wrapped(), time_ns

    def _command(self, twist: TwistMessage) -> None:
        velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        if not all(math.isfinite(value) and abs(value) <= FASTEST for value in velocity):
            self._node.get_logger().warning(
                f"velocity command refused: vx, vy and wz must be finite and at most {FASTEST:g}, got {velocity}"
            )
            return
        now = self._now()
        self._move_to(self._odom_from_base(now), now)
        self._twist, self._until_ns = velocity, self._end_of_command(now)

    def _end_of_command(self, now: int) -> int:
        """Until when a command holds that comes now."""
        timeout = self._parameters.velocity_timeout
        return now + round(min(timeout * NANOSECONDS, FOREVER)) if timeout else FOREVER

    def _answer_reset(
        self, request: messages.TriggerRequest, response: messages.TriggerResponse
    ) -> messages.TriggerResponse:
        self.reset()
        response.success, response.message = True, f"the robot is back at {self._first_pose}"
        return response

    def _answer_set_pose(
        self, request: messages.SetPoseRequest, response: messages.SetPoseResponse
    ) -> messages.SetPoseResponse:
        self._take_pose(request.pose)
        return response

    def _take_pose(self, message: PoseWithCovarianceStamped) -> None:
        frame, logger = message.header.frame_id.removeprefix("/"), self._node.get_logger()
        if frame not in ("", self._parameters.map_frame_id):
            logger.warning(f"pose refused: it must be in frame {self._parameters.map_frame_id}, got {frame}")
            return
        try:
            pose = message.pose.pose.to_planar()
        except ValueError as error:
            logger.warning(f"pose refused: {error}")
            return
        self.set_pose(pose)

    def _publish_clock(self) -> None:
        if self._clock is not None:
            self._clock.publish(Clock(Time.from_nanoseconds(self._now())))

    def _publish(self) -> None:
        now = self._now()
        stamp, parameters = Time.from_nanoseconds(now), self._parameters
        odom_from_base = self._odom_from_base(now).wrapped()
        vx, vy, wz = self.velocity
        if parameters.clock_rate == 0.0:
            self._publish_clock()
        self._odometry.publish(
            Odometry(
                Header(stamp, parameters.odom_frame_id),
                parameters.base_link_frame,
                messages.PoseWithCovariance(messages.Pose.from_planar(odom_from_base), PLANAR_COVARIANCE),
                messages.TwistWithCovariance(
                    TwistMessage(messages.Vector3(vx, vy), messages.Vector3(z=wz)), PLANAR_COVARIANCE
                ),
            )
        )
        links = [(parameters.odom_frame_id, parameters.base_link_frame, odom_from_base)]
        if parameters.publish_map_transform:
            links.insert(0, (parameters.map_frame_id, parameters.odom_frame_id, self._map_from_odom))
        self._transforms.publish(
            TFMessage(
                [
                    TransformStamped(Header(stamp, parent), child, messages.Transform.from_planar(pose))
                    for parent, child, pose in links
                ]
            )
        )
