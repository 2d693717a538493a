"""MobileRobotSimulator: the node that moves a robot by velocity commands and publishes odometry, tf and the clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, SupportsFloat, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from .. import messages
from .._core import MAX_COMMAND, MotionNoise, Obstacles, OccupancyGrid, Pose, Shape, touches
from ..handle import Handle, Handles
from ..messages import (
    AckermannDriveStamped,
    Message,
    PoseWithCovarianceStamped,
    SetPose,
    Trigger,
)
from ..messages import Twist as TwistMessage
from ..parameters import RobotParameters
from ..physics.constrained_motion import ConstrainedMotion
from ..physics.crowd import Placed
from ..physics.motion import Motion, MotionSnapshot
from ..physics.push import Push
from ..physics.velocity_profile import Velocity
from ..physics.world import Passing, World
from ..quoting import quoted
from .interface import Node, QoS
from .map_listener import MapListener, MapListenerSnapshot
from .robot_odometry import RobotOdometry, RobotOdometrySnapshot
from .robot_output import RobotOutput, RobotOutputSnapshot
from .steady_time import SteadyTime
from .transforms import check_frame
from .waiting import WaitingLog

RESTART_PARAMETERS = (
    "publish_map_transform",
    "publish_rate",
    "publish_clock",
    "clock_rate",
    "velocity_topic",
    "odometry_topic",
    "ground_truth_topic",
    "contact_topic",
    "stalled_topic",
    "cmd_vel_stamped",
    "map_service",
    "map_topic",
    "drive",
    "ackermann_topic",
    "joint_states_topic",
)
"""Changing one of these restarts the node."""

WHEEL_PARAMETERS = (
    "drive",
    "wheelbase",
    "track",
    "wheel_radius",
    "wheel_speed_limit",
    "steering_limit",
    "steering_rate",
)
"""Parameters of the wheels. After a change, the robot goes on as after a change of `CONSTRAINT_PARAMETERS`."""

ENCODER_PARAMETERS = (
    *WHEEL_PARAMETERS,
    "left_wheel_radius_multiplier",
    "right_wheel_radius_multiplier",
    "track_multiplier",
    "encoder_ticks",
)
"""Parameters of the odometry from the wheels. After a change, it goes on from the pose that it reports."""

CONSTRAINT_PARAMETERS = (
    *WHEEL_PARAMETERS,
    "robot_radius",
    "footprint",
    "contact",
    "velocity_limits",
    "acceleration_limits",
    "deceleration_limits",
)
"""Parameters that constrain the motion. After a change, the robot goes on from its pose with its velocity and command."""


@dataclass(frozen=True)
class RobotSnapshot:
    """Saved state of a `MobileRobotSimulator`.

    Attributes:
        parameters: Parameters.
        running: Publishers, subscriptions, services and timers, None while the node is stopped.
        footprint: Outline of the robot, None if it has none.
        slip_share: Share of the commanded motion that is lost, see `MobileRobotSimulator.slip`.
        push: Velocity that is added to that of the robot, see `MobileRobotSimulator.push`.
        motion: The motion and its saved state.
        odometry: State of the odometry.
        maps: State of the map listener, with the map.
        output: State of the output.
    """

    parameters: RobotParameters
    running: Handles | None
    footprint: Shape | None
    slip_share: float | None
    push: Push | None
    motion: tuple[Motion, MotionSnapshot]
    odometry: RobotOdometrySnapshot
    maps: MapListenerSnapshot
    output: RobotOutputSnapshot


class MobileRobotSimulator(Handle):
    """A simulated robot that executes velocity commands and publishes its odometry.

    Commands:
        The robot keeps the velocity of a Twist or TwistStamped until the next one arrives or `velocity_timeout` has passed.
        Its motion is integrated exactly, so the pose does not depend on the publishing rate.
    Drive:
        With `drive` the robot has wheels and does of a command what they can: see `Drive.command`. An Ackermann drive also
        takes an AckermannDriveStamped on `ackermann_topic`. The node publishes the wheels and the steering on
        `joint_states_topic`. With a wrong calibration or with encoders that count, the odometry comes from the wheels.
    Output:
        The node publishes odometry and the transform odom -> base_link at `publish_rate`. A scanner on the robot has it
        publish the transforms also at the stamps of its scans. With
        `publish_clock` it publishes the clock at `clock_rate`, or at `publish_rate` if `clock_rate` is 0. With
        `publish_map_transform` it also publishes map -> odom, and each message on `initialpose` moves the robot to that
        pose.
    Services:
        `reset` returns the robot to its start pose. `set_pose` moves it to any pose. The odometry does not notice that
        (a kidnapped robot).
    Ground truth:
        With `ground_truth_topic` the node publishes the true pose and velocity with each odometry message, and with
        `ground_truth_frame` the true pose as a transform. Scanners measure from the true pose.
    Constraints:
        With velocity and acceleration limits the robot follows a command only within these limits. With a footprint it
        collides with walls, obstacles and other robots. Without both, it follows commands exactly.
    Map:
        A robot with a footprint needs the map. If its world has none, the node requests the map from `map_service` and
        retries until it arrives; a map on `map_topic` replaces the current one. The robot ignores commands until it has a
        map. After 2 s without one the node logs that it waits, and again every 10 s.
    Odometry:
        The odometry is exact by default. With `odometry_alphas` it drifts, and its covariance reports the drift. The
        transform map -> odom then corrects the drift, so that map -> base_link stays the true pose.
    Time:
        The robot moves on the time of the world. Stamps come from the node's clock, which can show another time, for
        example after a clock jump.

    Args:
        node: Node to publish and subscribe through.
        parameters: Parameters. Default: `RobotParameters()`.
        start_pose: Pose at the start and after a reset, in the map frame. Default: `initial_pose`.
        world: World that the robot moves in. If None, the robot is alone in a world without a map, on the time of the node's
            clock.
        name: Name of the robot in contact events.
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
        self._node, self._clock = node, node.get_clock()
        self.body_name = name
        self._parameters = parameters or RobotParameters()
        self._world = world or World(SteadyTime(self._clock))
        self._waiting = WaitingLog(node, "the robot", self._find_missing)
        self._is_map_given = self._world.grid is not None
        self._maps = MapListener(node, self._use_map, self._parameters.unknown, self._world.grid)
        self._start_pose = start_pose
        self._running: Handles | None = None
        self._footprint = self._parameters.shape
        self._slip_share: float | None = None
        self._push: Push | None = None
        self._odometry = RobotOdometry(self)
        self._output = RobotOutput(node, self._world, self, self._odometry)
        self._begin()
        self._world.join(self)

    def __repr__(self) -> str:
        return f"MobileRobotSimulator({self.body_name!r}, {self.pose!r})"

    @property
    def parameters(self) -> RobotParameters:
        """Current parameters."""
        return self._parameters

    @property
    def motion(self) -> Motion:
        """Motion of the robot: its trajectory so far and its current velocity."""
        return self._motion

    @property
    def footprint(self) -> Shape | None:
        """Outline of the robot, None if it has none."""
        return self._footprint

    @property
    def surroundings(self) -> list[Placed]:
        """Obstacles and other robots that a scanner on this robot sees now, with their poses in the map frame."""
        return [placed for other, placed in self._world.everybody() if other is not self]

    @property
    def seen(self) -> Obstacles:
        """The same as `surroundings`, for functions that take obstacles."""
        return self._world.seen_by(self)

    def poses_at(self, offsets_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Returns the true poses in the map frame at times [ns] relative to now, (N, 3) float64; see `Carrier.poses_at`."""
        return self._motion.map_poses_at(self._world.now_ns() + offsets_ns)

    def surroundings_at(self, offsets_ns: NDArray[np.int64]) -> list[Passing]:
        """Returns what a scanner on this robot saw at times [ns] relative to now; see `Carrier.surroundings_at`."""
        return self._world.around_during(self, self._world.now_ns() + offsets_ns)

    @property
    def start_pose(self) -> Pose:
        """Pose at the start and after a reset, in the map frame."""
        return Pose(*self._parameters.initial_pose) if self._start_pose is None else self._start_pose

    @property
    def believed_pose(self) -> Pose:
        """Pose that the odometry last reported, in the odometry frame."""
        return self._output.believed_pose

    @property
    def pose(self) -> Pose:
        """True pose of the robot now, in the map frame."""
        return self._motion.map_pose(self._world.now_ns())

    @property
    def velocity(self) -> Velocity:
        """True velocity (vx, vy, wz) now, in the robot's frame: forward and left [m/s], counter-clockwise [rad/s]."""
        return self._motion.velocity(self._world.now_ns())

    @property
    def distance(self) -> float:
        """Length of the path driven so far [m]."""
        return self._motion.distance(self._world.now_ns())

    def reset(self) -> None:
        """Moves the robot to its start pose and stops it. The odometry and the driven distance start again.

        Slip, push and drift that are set (`slip`, `push`, `drift`) stay in effect.
        """
        self._begin()
        self._world.changed()

    def _begin(self) -> None:
        """Puts the robot at its start pose, and sets up its motion and its odometry."""
        now_ns, parameters, start = self._world.now_ns(), self._parameters, self.start_pose
        map_from_odom, odom_from_base = (start, Pose()) if parameters.publish_map_transform else (Pose(), start)
        self._motion = self._create_motion(now_ns, map_from_odom, odom_from_base)
        if self._lost_share():
            self._motion.slip(self._lost_share(), now_ns)
        if self._push is not None:
            self._motion.push(self._push, now_ns)
        self._odometry.begin(odom_from_base, now_ns)
        self._output.begin(odom_from_base)

    def set_parameters(self, **values: Any) -> None:
        """Changes parameters by name, with immediate effect.

        A new `velocity_timeout` also applies to the current command, counted from now.

        Args:
            **values: New values, by the names of `RobotParameters`.

        Raises:
            ValueError: A value is invalid. The message names the parameter, its value and what is allowed. Nothing changes.
            TypeError: A new topic name belongs to a topic of another message type. Nothing changes.
        """
        before, after = self._parameters, self._parameters.changed(values)
        if after == before:
            return
        self._parameters = after
        needs_map_as_before = (before.shape is None) == (after.shape is None)
        as_before = all(getattr(before, name) == getattr(after, name) for name in RESTART_PARAMETERS)
        if self._running is not None and not (needs_map_as_before and as_before):
            footprint, self._footprint = self._footprint, after.shape
            try:
                self._restart()
            except Exception:
                self._parameters, self._footprint = before, footprint
                self._restart()
                raise
        self._change_motion(before, after)
        if self._running is not None and after.speed_factor != before.speed_factor:
            self._node.set_speed(after.speed_factor)

    def set_pose(self, pose: Pose) -> None:
        """Moves the robot to a pose in the map frame. The current command continues from there.

        The odometry stays as it is, because wheels do not notice it if a robot is carried. With `publish_map_transform`,
        map -> odom changes. Otherwise it is up to a localizer to find out.

        Raises:
            ValueError: The robot's origin would be inside a wall of the map, or its footprint would touch a wall, an
                obstacle or another robot. Nothing changes.
            TypeError: It is not a `Pose`. Nothing changes.
        """
        if not isinstance(pose, Pose):
            raise TypeError(f"the pose must be a Pose, got {quoted(pose)}; Simulation.set_pose also takes (x, y, yaw)")
        self._world.check_place("the pose", pose, self._footprint, self)
        now_ns = self._world.now_ns()
        self._motion.move_frame((pose * self._motion.pose(now_ns).inverse()).wrapped(), now_ns)
        self._world.changed()

    def slip(self, share: float | None) -> None:
        """Makes the wheels slip from now on. The odometry does not notice it.

        Args:
            share: Share of the commanded motion that is lost, in 0..1; None for that of the parameters.

        Raises:
            ValueError: The share is not in 0..1. Nothing changes.
            TypeError: The share is not a number. Nothing changes.
        """
        if not isinstance(share, SupportsFloat | None):
            raise TypeError(f"the share must be a number or None, got {quoted(share)}")
        if share is not None and not 0.0 <= share <= 1.0:
            raise ValueError(f"the share must be in 0..1, got {quoted(share)}")
        self._slip_share = share
        self._motion.slip(self._lost_share(), self._world.now_ns())
        self._output.choose()

    def push(self, push: Push | None) -> None:
        """Pushes the robot from now on. Neither its wheels nor its odometry notice it.

        Args:
            push: Velocity (vx, vy) in the map frame that is added to that of the robot [m/s]; None ends the push.

        Raises:
            ValueError: The push is not two numbers whose absolute values are at most `MAX_COMMAND`. Nothing changes.
        """
        if push is not None and not (len(push) == 2 and all(abs(speed) <= MAX_COMMAND for speed in push)):
            raise ValueError(f"a push must be two finite speeds of at most {MAX_COMMAND:g} m/s, got {quoted(push)}")
        self._push = push
        self._motion.push(push, self._world.now_ns())
        self._output.choose()

    def drift(self, noise: MotionNoise | None, seed: int) -> None:
        """Changes the noise of the odometry from now on. The error and the covariance so far stay.

        Args:
            noise: Noise of the odometry; None for that of the parameters.
            seed: Seed of the noise.

        Raises:
            TypeError: The noise or the seed has the wrong type. Nothing changes.
        """
        if not isinstance(noise, MotionNoise | None):
            raise TypeError(f"the noise must be a MotionNoise or None, got {quoted(noise)}")
        if not isinstance(seed, SupportsIndex):
            raise TypeError(f"the seed must be an integer, got {quoted(seed)}")
        self._odometry.drift(noise, seed, self._world.now_ns())
        self._output.choose()

    def start(self) -> None:
        """Starts to follow commands and to publish, first after one period. Has no effect if the node is running."""
        if self._running is not None:
            return
        with Handles() as handles:
            self._output.start(handles)
            self._create_subscriptions(handles)
            self._create_services(handles)
            if not self._is_map_given:
                self._waiting.start(handles)
                if self._footprint is not None:
                    self._maps.start(topic=self._parameters.map_topic, service=self._parameters.map_service, handles=handles)
            self._node.set_speed(self._parameters.speed_factor)
            self._output.start_timers(handles)
            self._running = handles

    def stop(self) -> None:
        """Stops the robot. It then ignores commands and publishes nothing. `start` resumes at its pose."""
        if self._running is not None:
            self._running.close()
            self._running = None
            self._motion.stop(self._world.now_ns())

    def publish_transforms(self, stamp_ns: int) -> None:
        """Publishes the transforms of now, unless they have been published at this stamp. Has no effect while it is stopped.

        A scanner calls this before it publishes a scan. So each scan has a transform at its stamp, at any rate.

        Args:
            stamp_ns: Stamp of the scan [ns].
        """
        if self._running is not None:
            self._output.publish_transforms(stamp_ns)

    def save(self) -> RobotSnapshot:
        """Returns the state that `restore` takes. The state of the node interface and of the world is not part of it."""
        return RobotSnapshot(
            parameters=self._parameters,
            running=self._running,
            footprint=self._footprint,
            slip_share=self._slip_share,
            push=self._push,
            motion=(self._motion, self._motion.save()),
            odometry=self._odometry.save(),
            maps=self._maps.save(),
            output=self._output.save(),
        )

    def restore(self, state: RobotSnapshot) -> None:
        """Puts the robot back into a saved state."""
        self._parameters, self._running = state.parameters, state.running
        self._footprint, self._slip_share, self._push = state.footprint, state.slip_share, state.push
        self._motion, motion_state = state.motion
        self._motion.restore(motion_state)
        self._odometry.restore(state.odometry)
        self._maps.restore(state.maps)
        self._output.restore(state.output)

    def _create_motion(self, time_ns: int, map_from_odom: Pose, odom_from_base: Pose) -> Motion:
        parameters = self._parameters
        if self._footprint is None:
            limits, wheels = parameters.limits, parameters.wheels
            return Motion(time_ns, parameters.velocity_timeout, map_from_odom, odom_from_base, limits, wheels)
        return ConstrainedMotion(
            time_ns,
            parameters.velocity_timeout,
            map_from_odom,
            odom_from_base,
            world=self._world,
            body=self,
            limits=parameters.limits,
            mode=parameters.contact,
            drive=parameters.wheels,
        )

    def _change_motion(self, before: RobotParameters, after: RobotParameters) -> None:
        """Applies changed parameters to the motion."""
        now_ns = self._world.now_ns()
        self._maps.set_unknown(after.unknown)
        if after.velocity_timeout != before.velocity_timeout:
            self._motion.set_timeout(after.velocity_timeout, now_ns)
        changed = {name for name in RobotParameters.model_fields if getattr(before, name) != getattr(after, name)}
        believed = None if changed.isdisjoint(ENCODER_PARAMETERS) else self._odometry.read_wheels(now_ns)[0]
        if not changed.isdisjoint(CONSTRAINT_PARAMETERS):
            self._footprint = after.shape
            motion = self._create_motion(now_ns, self._motion.map_from_own, self._motion.pose(now_ns))
            self._motion = motion.continuing(self._motion)
            self._world.changed()
        if believed is not None:
            self._odometry.begin_wheels(believed, now_ns)
        if after.wheel_slip != before.wheel_slip:
            self.slip(self._slip_share)
        if (after.odometry_alphas, after.odometry_seed) != (before.odometry_alphas, before.odometry_seed):
            self._odometry.update_noise(now_ns)
        self._output.choose()

    def _lost_share(self) -> float:
        """Returns the share of the commanded motion that is lost: that of `slip`, or else that of the parameters."""
        return self._parameters.wheel_slip if self._slip_share is None else self._slip_share

    def _find_missing(self) -> dict[str, str]:
        """Returns what is missing for driving, and how the node gets it."""
        missing = {} if self._footprint is None else self._maps.find_missing()
        return {thing: f"{how}; a robot with a footprint ignores commands without it" for thing, how in missing.items()}

    def _use_map(self, grid: OccupancyGrid) -> None:
        """Moves in another map from now on. Warns if the robot is inside one of its walls, or in another robot."""
        self._world.use_map(grid)
        if self._footprint is not None and touches(grid, self._footprint, self.pose):
            x, y, yaw = self.pose
            self._node.get_logger().warning(
                f"the robot at ({x:.2f}, {y:.2f}, {yaw:.2f}) touches a wall of the map; move it with set_pose or initialpose"
            )
            return
        try:
            self._world.check_place("the robot's place", self.pose, self._footprint, self)
        except ValueError as error:
            self._node.get_logger().warning(f"{error}; give each robot an initial_pose, or move it with set_pose")

    def _restart(self) -> None:
        """Restarts the node without stopping the robot."""
        if self._running is not None:
            self._running.close()
            self._running = None
        self.start()

    # --- topics, services ---

    def _create_subscriptions(self, handles: Handles) -> None:
        """Subscribes to commands and, with `publish_map_transform`, to initialpose."""
        node, topic = self._node, self._parameters.velocity_topic
        types: dict[type[Message], Callable[[Any], None]] = {TwistMessage: self._take_command}
        stamped: dict[type[Message], Callable[[Any], None]] = {messages.TwistStamped: self._take_stamped_command}
        callbacks = {**stamped, **types} if self._parameters.cmd_vel_stamped else {**types, **stamped}
        handles.add(node.destroy_subscription, node.create_subscription_of_either(callbacks, topic, QoS.DEFAULT))
        if self._parameters.drive == "ackermann" and self._parameters.ackermann_topic:
            self._subscribe_to_steering(handles)
        if self._parameters.publish_map_transform:
            poses = node.create_subscription(PoseWithCovarianceStamped, "initialpose", self._take_pose, QoS.DEFAULT)
            handles.add(node.destroy_subscription, poses)

    def _subscribe_to_steering(self, handles: Handles) -> None:
        node, topic = self._node, self._parameters.ackermann_topic
        try:
            steering = node.create_subscription(AckermannDriveStamped, topic, self._take_steering, QoS.DEFAULT)
        except ImportError:
            node.get_logger().info(f"no commands on {topic}, because ackermann_msgs is not installed")
            return
        handles.add(node.destroy_subscription, steering)

    def _create_services(self, handles: Handles) -> None:
        node = self._node
        handles.add(node.destroy_service, node.create_service(Trigger, "reset", self._answer_reset))
        handles.add(node.destroy_service, node.create_service(SetPose, "set_pose", self._answer_set_pose))

    def _take_stamped_command(self, message: messages.TwistStamped) -> None:
        self._take_command(message.twist)

    def _take_command(self, twist: TwistMessage) -> None:
        vx, vy, wz = velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        if not (abs(vx) <= MAX_COMMAND and abs(vy) <= MAX_COMMAND and abs(wz) <= MAX_COMMAND):  # False for NaN too
            self._node.get_logger().warning(
                f"velocity command refused: |vx|, |vy| and |wz| must be finite and at most {MAX_COMMAND:g}, got {velocity}"
            )
            return
        if self._footprint is not None and self._world.grid is None:
            return
        self._motion.command(velocity, self._world.now_ns())

    def _take_steering(self, message: AckermannDriveStamped) -> None:
        drive = message.drive
        given = (drive.speed, drive.steering_angle, drive.steering_angle_velocity)
        if not all(math.isfinite(value) and abs(value) <= MAX_COMMAND for value in given):
            self._node.get_logger().warning(
                "steering command refused: |speed|, |steering_angle| and |steering_angle_velocity| must be finite and "
                f"at most {MAX_COMMAND:g}, got {given}"
            )
            return
        if self._footprint is not None and self._world.grid is None:
            return
        rate = abs(drive.steering_angle_velocity) or math.inf
        self._motion.command_steering(drive.speed, drive.steering_angle, rate, self._world.now_ns())

    def _answer_reset(
        self, request: messages.TriggerRequest, response: messages.TriggerResponse
    ) -> messages.TriggerResponse:
        self.reset()
        response.success, response.message = True, f"the robot is back at {self.start_pose}"
        return response

    def _answer_set_pose(
        self, request: messages.SetPoseRequest, response: messages.SetPoseResponse
    ) -> messages.SetPoseResponse:
        self._take_pose(request.pose)
        return response

    def _take_pose(self, message: PoseWithCovarianceStamped) -> None:
        try:
            check_frame(message.header, self._parameters.map_frame_id)
            self.set_pose(message.pose.pose.to_planar())
        except ValueError as error:
            self._node.get_logger().warning(f"pose refused: {error}")
