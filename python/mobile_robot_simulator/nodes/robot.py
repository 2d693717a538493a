"""MobileRobotSimulator: velocity commands in, odometry, transforms and the clock out."""

from __future__ import annotations

import math
from typing import Any

from .. import messages
from .._core import MotionNoise, Pose, Shape
from ..handle import Handle, Handles
from ..messages import (
    Clock,
    Header,
    Odometry,
    PoseWithCovariance,
    PoseWithCovarianceStamped,
    SetPose,
    TFMessage,
    Time,
    Transform,
    TransformStamped,
    Trigger,
    TwistWithCovariance,
    Vector3,
)
from ..messages import Twist as TwistMessage
from ..parameters import RobotParameters
from ..physics.constrained_motion import ConstrainedMotion
from ..physics.motion import Motion, Velocity
from ..physics.odometer import PLANAR_COVARIANCE, Odometer
from ..physics.world import Placed, World
from .interface import Node, QoS

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

PUSHED = ("robot_radius", "footprint", "contact", "velocity_limits", "acceleration_limits", "deceleration_limits")
"""Parameters of what holds the robot back; the robot stands when they change."""

FASTEST = 1e3
"""Commands beyond this [m/s, rad/s] are no robot's, and are refused."""


class MobileRobotSimulator(Handle):
    """A robot that does exactly what it is told.

    Takes velocity commands (Twist or TwistStamped) and holds each until the next, or until `velocity_timeout`. Publishes
    odometry, the transform odom -> base_link and the clock at `publish_rate`, and, with `publish_map_transform`, the
    transform map -> odom; then it also takes initialpose. The pose at any time is computed from the last command on,
    exactly, so that it does not depend on the publishing rate. The service `reset` puts the robot back to where it was at
    first, `set_pose` anywhere.

    With limits its velocity follows the commands no faster than they let it, with a footprint the world pushes back, and
    with `odometry_alphas` odometry drifts, and says by its covariance how far; map -> odom makes up for that.

    The robot moves by the world's time; stamps are those of the node's clock, which may be off.

    node: what to publish and subscribe through. start_pose: where in the map frame the robot is at first. world: what is
    around it; nothing, and the node's clock is right, if None. name: what others call the robot.
    """

    def __init__(
        self,
        node: Node,
        parameters: RobotParameters | None = None,
        *,
        start_pose: Pose | None = None,
        world: World | None = None,
        name: str = "",
    ) -> None:
        self._node = node
        self.body_name = name
        self._parameters = parameters or RobotParameters()
        self._world = world or World(lambda: node.get_clock().now().nanoseconds)
        self._first_pose = start_pose or Pose()
        self._running: Handles | None = None
        self._footprint = self._parameters.shape
        self._slipping = 0.0
        self._drifting: tuple[MotionNoise | None, int] = (None, 0)
        self.reset()
        self._world.join(self)

    @property
    def parameters(self) -> RobotParameters:
        """The parameters in use."""
        return self._parameters

    @property
    def motion(self) -> Motion:
        """The way of the robot."""
        return self._motion

    @property
    def footprint(self) -> Shape | None:
        """The robot's outline."""
        return self._footprint

    @property
    def surroundings(self) -> list[Placed]:
        """What can be seen from the robot now, but for the map."""
        return self._world.seen_by(self)

    @property
    def believed_pose(self) -> Pose:
        """Where odometry last said that the robot is, in the odometry's frame."""
        return self._believed

    @property
    def pose(self) -> Pose:
        """Where the robot is now, in the map frame."""
        return self._motion.map_pose(self._world.now_ns())

    @property
    def velocity(self) -> Velocity:
        """How the robot moves now: forward, leftward [m/s] and turning [rad/s]."""
        return self._motion.velocity(self._world.now_ns())

    @property
    def distance(self) -> float:
        """Length of the way driven so far [m]."""
        return self._motion.distance(self._world.now_ns())

    def reset(self) -> None:
        """Put the robot back to where it was at first, at rest, with odometry as it was then and no distance driven.

        What has it slip or drift goes on.
        """
        now, parameters, first = self._world.now_ns(), self._parameters, self._first_pose
        frames = (first, Pose()) if parameters.publish_map_transform else (Pose(), first)
        self._motion = self._motion_from(now, *frames)
        if self._slipping:
            self._motion.slip(self._slipping, now)
        noise, seed = self._drifting
        if noise is None:
            noise, seed = parameters.motion_noise, parameters.odometry_seed
        self._odometer = Odometer(frames[1], now, noise=noise, seed=seed)
        self._believed = frames[1]
        self._world.changed()

    def set_parameters(self, **values: Any) -> None:
        """Change parameters by their names, from now on. A command in force is held anew, for `velocity_timeout`.

        raises: ValueError that names the parameter, its value and what was needed; then nothing changes.
        """
        before, after = self._parameters, self._parameters.changed(values)
        if after == before:
            return
        now = self._world.now_ns()
        if after.velocity_timeout != before.velocity_timeout:
            self._motion.set_timeout(after.velocity_timeout, now)
        self._parameters = after
        if any(getattr(before, name) != getattr(after, name) for name in PUSHED):
            self._footprint = after.shape
            self._motion = self._motion_from(now, self._motion.map_from_own, self._motion.pose(now)).continuing(self._motion)
            self._world.changed()
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
        now = self._world.now_ns()
        if self._parameters.publish_map_transform:
            self._motion.move_frame((pose * self._motion.pose(now).inverse()).wrapped(), now)
        else:
            self._motion.place(pose, now)
            self._odometer.place(pose, now)
        self._world.changed()

    def slip(self, share: float) -> None:
        """From now on, have the robot move by this share less than its wheels turn, of which odometry knows nothing."""
        self._slipping = share
        self._motion.slip(share, self._world.now_ns())

    def drift(self, noise: MotionNoise | None, seed: int) -> None:
        """From now on, have odometry err so; as sure of where it is now as it was at first."""
        now, self._drifting = self._world.now_ns(), (noise, seed)
        self._odometer = Odometer(self._motion.wheel_pose(now), now, noise=noise, seed=seed)

    def start(self) -> None:
        """Take commands and publish from now on."""
        if self._running is not None:
            return
        node, parameters = self._node, self._parameters
        with Handles() as handles:
            self._odometry = node.create_publisher(Odometry, parameters.odometry_topic, QoS.DEFAULT)
            handles.add(node.destroy_publisher, self._odometry)
            self._transforms = node.create_publisher(TFMessage, "/tf", QoS.DEFAULT)
            handles.add(node.destroy_publisher, self._transforms)
            self._clock = node.create_publisher(Clock, "/clock", QoS.CLOCK) if parameters.publish_clock else None
            if self._clock is not None:
                handles.add(node.destroy_publisher, self._clock)
            if parameters.cmd_vel_stamped:
                commands = node.create_subscription(
                    messages.TwistStamped, parameters.velocity_topic, self._take_stamped_command, QoS.DEFAULT
                )
            else:
                commands = node.create_subscription(TwistMessage, parameters.velocity_topic, self._take_command, QoS.DEFAULT)
            handles.add(node.destroy_subscription, commands)
            if parameters.publish_map_transform:
                poses = node.create_subscription(PoseWithCovarianceStamped, "initialpose", self._take_pose, QoS.DEFAULT)
                handles.add(node.destroy_subscription, poses)
            handles.add(node.destroy_service, node.create_service(Trigger, "reset", self._answer_reset))
            handles.add(node.destroy_service, node.create_service(SetPose, "set_pose", self._answer_set_pose))
            node.set_speed(parameters.speed_factor)
            handles.add(node.destroy_timer, node.create_timer(1.0 / parameters.publish_rate, self._publish))
            if self._clock is not None and parameters.clock_rate > 0.0:
                handles.add(node.destroy_timer, node.create_timer(1.0 / parameters.clock_rate, self._publish_clock))
            self._running = handles

    def stop(self) -> None:
        """Stand still, take no more commands and publish nothing; `start` goes on from here."""
        if self._running is not None:
            self._running.close()
            self._running = None
            self._motion.stop(self._world.now_ns())

    def save(self) -> Any:
        """All that `restore` needs, but for what the node's surroundings keep."""
        return dict(vars(self)), self._motion.save(), self._odometer.save()

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        attributes, motion, odometer = state
        vars(self).update(attributes)
        self._motion.restore(motion)
        self._odometer.restore(odometer)

    def _motion_from(self, time_ns: int, map_from_own: Pose, start: Pose) -> Motion:
        parameters = self._parameters
        if self._footprint is None and parameters.limits is None:
            return Motion(time_ns, parameters.velocity_timeout, map_from_own, start)
        return ConstrainedMotion(
            time_ns,
            parameters.velocity_timeout,
            map_from_own,
            start,
            world=self._world,
            body=self,
            limits=parameters.limits,
            mode=parameters.contact,
        )

    def _restart(self) -> None:
        """Set everything up afresh, without standing still."""
        if self._running is not None:
            self._running.close()
            self._running = None
        self.start()

    def _take_stamped_command(self, message: messages.TwistStamped) -> None:
        self._take_command(message.twist)

    def _take_command(self, twist: TwistMessage) -> None:
        velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        if not all(math.isfinite(value) and abs(value) <= FASTEST for value in velocity):
            self._node.get_logger().warning(
                f"velocity command refused: vx, vy and wz must be finite and at most {FASTEST:g}, got {velocity}"
            )
            return
        self._motion.command(velocity, self._world.now_ns())

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
            self._clock.publish(Clock(self._stamp()))

    def _stamp(self) -> Time:
        return Time.from_nanoseconds(self._node.get_clock().now().nanoseconds)

    def _publish(self) -> None:
        now, stamp, parameters, motion = self._world.now_ns(), self._stamp(), self._parameters, self._motion
        if parameters.clock_rate == 0.0 and self._clock is not None:
            self._clock.publish(Clock(stamp))
        odom_from_base, covariance = self._odometer.read(motion.wheel_pose(now).wrapped(), now)
        self._believed = odom_from_base
        pose = messages.Pose.from_planar(odom_from_base)
        vx, vy, wz = motion.wheel_velocity(now)
        header = Header(stamp, parameters.odom_frame_id)
        self._odometry.publish(
            Odometry(
                header,
                parameters.base_link_frame,
                PoseWithCovariance(pose, covariance),
                TwistWithCovariance(TwistMessage(Vector3(vx, vy), Vector3(0.0, 0.0, wz)), PLANAR_COVARIANCE),
            )
        )
        position = pose.position
        odom_from_base_message = Transform(Vector3(position.x, position.y), pose.orientation)
        transforms = [TransformStamped(header, parameters.base_link_frame, odom_from_base_message)]
        if parameters.publish_map_transform:
            map_from_odom = motion.map_from_own
            if motion.slipped or self._odometer.is_noisy:
                map_from_odom = (motion.map_pose(now) * odom_from_base.inverse()).wrapped()
            map_header = Header(stamp, parameters.map_frame_id)
            transform = Transform.from_planar(map_from_odom)
            transforms.insert(0, TransformStamped(map_header, parameters.odom_frame_id, transform))
        self._transforms.publish(TFMessage(transforms))
