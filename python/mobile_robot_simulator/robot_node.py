"""MobileRobotSimulator: velocity commands in, odometry, transforms and the clock out."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from . import messages
from ._core import Pose
from .messages import Clock, Header, Odometry, PoseWithCovarianceStamped, TFMessage, Time, TransformStamped
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

Velocity = tuple[float, float, float]
STANDING: Velocity = (0.0, 0.0, 0.0)


class MobileRobotSimulator:
    """A robot that does exactly what it is told.

    Takes velocity commands (Twist or TwistStamped) and holds each until the next, or until `velocity_timeout`. Publishes
    odometry, the transform odom -> base_link and the clock at `publish_rate`, and, with `publish_map_transform`, the
    transform map -> odom; then it also takes /initialpose. The pose at any time is computed from the last command on,
    exactly, so that it does not depend on the publishing rate.

    node: what to publish and subscribe through. start_pose: where in the map frame the robot is at first.
    """

    def __init__(self, node: Node, parameters: RobotParameters | None = None, *, start_pose: Pose | None = None) -> None:
        self._node = node
        self._parameters = parameters or RobotParameters()
        self._map_from_odom = Pose()
        self._odom_from_start = Pose()
        self._twist = STANDING
        self._start_ns = self._until_ns = node.get_clock().now().nanoseconds
        self._driven_to_start = 0.0
        self._stop: Callable[[], None] | None = None
        if start_pose is not None:
            self.set_pose(start_pose)

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
        if self._stop is not None:
            return
        node, parameters = self._node, self._parameters
        self._odometry = node.create_publisher(Odometry, parameters.odometry_topic, QoS.DEFAULT)
        self._transforms = node.create_publisher(TFMessage, "/tf", QoS.DEFAULT)
        self._clock = node.create_publisher(Clock, "/clock", QoS.CLOCK)
        subscriptions = [
            node.create_subscription(
                messages.TwistStamped, parameters.velocity_topic, lambda message: self._command(message.twist), QoS.DEFAULT
            )
            if parameters.cmd_vel_stamped
            else node.create_subscription(TwistMessage, parameters.velocity_topic, self._command, QoS.DEFAULT)
        ]
        if parameters.publish_map_transform:
            subscriptions.append(
                node.create_subscription(PoseWithCovarianceStamped, "/initialpose", self._take_pose, QoS.DEFAULT)
            )
        timer = node.create_timer(1.0 / parameters.publish_rate, self._publish)

        def stop() -> None:
            node.destroy_timer(timer)
            for subscription in subscriptions:
                node.destroy_subscription(subscription)
            for publisher in (self._odometry, self._transforms, self._clock):
                node.destroy_publisher(publisher)

        self._stop = stop

    def stop(self) -> None:
        """Stand still, take no more commands and publish nothing; `start` goes on from here."""
        if self._stop is not None:
            self._stop()
            self._stop = None
            now = self._now()
            self._move_to(self._odom_from_base(now), now)
            self._twist = STANDING

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
        timeout = self._parameters.velocity_timeout
        self._twist, self._until_ns = velocity, now + round(min(timeout * NANOSECONDS, FOREVER)) if timeout else FOREVER

    def _take_pose(self, message: PoseWithCovarianceStamped) -> None:
        frame, logger = message.header.frame_id.removeprefix("/"), self._node.get_logger()
        if frame not in ("", self._parameters.map_frame_id):
            logger.warning(f"initial pose refused: it must be in frame {self._parameters.map_frame_id}, got {frame}")
            return
        try:
            pose = message.pose.pose.to_planar()
        except ValueError as error:
            logger.warning(f"initial pose refused: {error}")
            return
        self.set_pose(pose)

    def _publish(self) -> None:
        now = self._now()
        stamp, parameters = Time.from_nanoseconds(now), self._parameters
        odom_from_base = self._odom_from_base(now).wrapped()
        vx, vy, wz = self.velocity
        self._clock.publish(Clock(stamp))
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
