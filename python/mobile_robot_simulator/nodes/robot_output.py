"""RobotOutput: what a robot publishes periodically: odometry, transforms, the clock, contacts, joints and the true pose."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import takewhile

from .. import messages
from .._core import Pose
from ..handle import Handle, Handles
from ..instant import NANOSECONDS
from ..messages import Clock, Header, JointState, Odometry, TFMessage, Time
from ..physics.motion import Motion
from ..physics.wheel_course import WheelCourse
from ..physics.world import World
from .interface import Node, Publisher, QoS
from .robot_messages import (
    clock_message,
    exact_odometry_message,
    exact_transforms_message,
    joint_states_message,
    odometry_message,
    transforms_message,
)
from .robot_odometry import Robot, RobotOdometry


@dataclass(frozen=True)
class RobotPublishers:
    """Publishers of a `MobileRobotSimulator`.

    Attributes:
        odometry: Publisher of the odometry.
        transforms: Publisher of /tf.
        clock: Publisher of /clock, None unless `publish_clock` is set.
        truth: Publisher of the ground truth, None unless `ground_truth_topic` is set.
        contacts: Publisher of contacts, None without a footprint or `contact_topic`.
        stalled: Publisher of whether the robot is stalled, None without a footprint or `stalled_topic`.
        joints: Publisher of the wheels and the steering, None without a drive that has wheels or `joint_states_topic`.
    """

    odometry: Publisher[Odometry]
    transforms: Publisher[TFMessage]
    clock: Publisher[Clock] | None
    truth: Publisher[Odometry] | None
    contacts: Publisher[messages.PointStamped] | None
    stalled: Publisher[messages.Bool] | None
    joints: Publisher[JointState] | None


@dataclass(frozen=True, slots=True)
class ExactOutput:
    """What a robot publishes periodically while its odometry is exact. Chosen once, because it is published often.

    Attributes:
        clock: Publisher of the clock, None if it has a timer of its own.
        odometry: Publisher of the odometry.
        transforms: Publisher of /tf.
        motion: Motion of the robot.
        frames: Frame of the odometry, and the robot's frame.
        map_frame: Name of the map frame, None if its transform is not published.
        has_others: True if other topics are published too.
    """

    clock: Publisher[Clock] | None
    odometry: Publisher[Odometry]
    transforms: Publisher[TFMessage]
    motion: Motion
    frames: tuple[str, str]
    map_frame: str | None
    has_others: bool


@dataclass(frozen=True)
class RobotOutputSnapshot:
    """Saved state of a `RobotOutput`.

    Attributes:
        publishers: Publishers, None before the first start.
        believed_pose: Pose that the odometry last reported, in the odometry frame.
        transforms_ns: Stamp of the last transforms [ns], None before the first ones.
        contacts: Time of the last contact that was published [s], and whether the robot was stalled then.
    """

    publishers: RobotPublishers | None
    believed_pose: Pose
    transforms_ns: int | None
    contacts: tuple[float, bool]


class RobotOutput(Handle):
    """Publishes odometry, transforms, the clock, contacts, joints and the ground truth of a robot.

    Exact odometry is published most often, so it has a short path of its own: `choose` decides on it ahead of time.

    Args:
        node: Node to publish through.
        world: World that the robot moves in.
        robot: The robot.
        odometry: Odometry of the robot.
    """

    def __init__(self, node: Node, world: World, robot: Robot, odometry: RobotOdometry) -> None:
        self._node, self._clock = node, node.get_clock()
        self._world, self._robot, self._odometry = world, robot, odometry
        self._publishers: RobotPublishers | None = None
        self._exact: ExactOutput | None = None
        """What is published periodically, None while the odometry is not exact. See `choose`."""
        self._believed: Pose | WheelCourse = Pose()
        self._transforms_ns: int | None = None
        self._contact_time = -math.inf
        self._is_stalled = False

    @property
    def believed_pose(self) -> Pose:
        """Pose that the odometry last reported, in the odometry frame."""
        return self._believed if isinstance(self._believed, Pose) else self._believed.pose

    def begin(self, odom_from_base: Pose) -> None:
        """Begins again at a pose in the odometry frame."""
        self._believed = odom_from_base
        self.choose()

    def start(self, handles: Handles) -> None:
        """Creates the publishers that the parameters ask for."""
        self._publishers = self._create_publishers(handles)
        self.choose()

    def start_timers(self, handles: Handles) -> None:
        """Publishes periodically from now on, first after one period."""
        node, parameters = self._node, self._robot.parameters
        handles.add(node.destroy_timer, node.create_timer(1.0 / parameters.publish_rate, self._publish))
        if parameters.publish_clock and parameters.clock_rate > 0.0:
            handles.add(node.destroy_timer, node.create_timer(1.0 / parameters.clock_rate, self._publish_clock))

    def choose(self) -> None:
        """Chooses what is published periodically.

        Must be called after a change of the parameters, the motion, its slip or push, or the noise of the odometry.
        """
        publishers, parameters, motion = self._publishers, self._robot.parameters, self._robot.motion
        self._exact = None
        if publishers is None or parameters.ground_truth_frame or motion.slipped or not self._odometry.is_exact:
            return
        others = publishers.contacts, publishers.stalled, publishers.joints, publishers.truth
        has_others = any(publisher is not None for publisher in others)
        frames = parameters.frames["odom_frame_id"], parameters.frames["base_link_frame"]
        clock = publishers.clock if parameters.clock_rate == 0.0 else None
        map_frame = parameters.map_frame_id if parameters.publish_map_transform else None
        self._exact = ExactOutput(clock, publishers.odometry, publishers.transforms, motion, frames, map_frame, has_others)

    def publish_transforms(self, stamp_ns: int) -> None:
        """Publishes the transforms of now, unless they have been published at this stamp [ns]."""
        if stamp_ns != self._transforms_ns:
            now_ns = self._world.now_ns()
            self._send_transforms(now_ns, Time.from_nanoseconds(stamp_ns), self._odometry.pose(now_ns))

    def save(self) -> RobotOutputSnapshot:
        """Returns the state that `restore` takes."""
        contacts = self._contact_time, self._is_stalled
        return RobotOutputSnapshot(self._publishers, self.believed_pose, self._transforms_ns, contacts)

    def restore(self, state: RobotOutputSnapshot) -> None:
        """Returns to a saved state. The robot and its odometry must be restored before."""
        self._publishers, self._believed, self._transforms_ns = state.publishers, state.believed_pose, state.transforms_ns
        self._contact_time, self._is_stalled = state.contacts
        self.choose()

    def _create_publishers(self, handles: Handles) -> RobotPublishers:
        node, parameters, has_footprint = self._node, self._robot.parameters, self._robot.footprint is not None
        odometry = node.create_publisher(Odometry, parameters.odometry_topic, QoS.DEFAULT)
        handles.add(node.destroy_publisher, odometry)
        transforms = node.create_publisher(TFMessage, "/tf", QoS.DEFAULT)
        handles.add(node.destroy_publisher, transforms)
        clock = node.create_publisher(Clock, "/clock", QoS.CLOCK) if parameters.publish_clock else None
        if clock is not None:
            handles.add(node.destroy_publisher, clock)
        truth = contacts = stalled = joints = None
        if parameters.ground_truth_topic:
            truth = node.create_publisher(Odometry, parameters.ground_truth_topic, QoS.DEFAULT)
            handles.add(node.destroy_publisher, truth)
        if has_footprint and parameters.contact_topic:
            contacts = node.create_publisher(messages.PointStamped, parameters.contact_topic, QoS.DEFAULT)
            handles.add(node.destroy_publisher, contacts)
        if has_footprint and parameters.stalled_topic:
            stalled = node.create_publisher(messages.Bool, parameters.stalled_topic, QoS.LATCHED)
            handles.add(node.destroy_publisher, stalled)
            self._is_stalled = self._robot.motion.is_blocked
            stalled.publish(messages.Bool(self._is_stalled))
        if parameters.drive != "planar" and parameters.joint_states_topic:
            joints = node.create_publisher(JointState, parameters.joint_states_topic, QoS.DEFAULT)
            handles.add(node.destroy_publisher, joints)
        return RobotPublishers(odometry, transforms, clock, truth, contacts, stalled, joints)

    def _publish(self) -> None:
        """Publishes odometry and transforms, and also the clock if it has no timer of its own."""
        now_ns, stamp_ns, exact = self._world.now_ns(), self._clock.now().nanoseconds, self._exact
        if exact is None:
            if self._robot.parameters.clock_rate == 0.0:
                self._send_clock(stamp_ns)
            stamp = Time.from_nanoseconds(stamp_ns)
            self._send_odometry(now_ns, stamp)
            if stamp_ns != self._transforms_ns:
                self._send_transforms(now_ns, stamp, self.believed_pose)
            self._publish_others(now_ns, stamp_ns)
            return
        self._publish_exactly(exact, now_ns, stamp_ns)
        if exact.has_others:
            self._publish_others(now_ns, stamp_ns)

    def _publish_exactly(self, output: ExactOutput, now_ns: int, stamp_ns: int) -> None:
        """Publishes odometry that is exact, and its transforms: to be computed when they are needed, which may be never."""
        if output.clock is not None:
            output.clock.publish_lazily(clock_message, stamp_ns)
        motion = output.motion
        self._believed = course = motion.wheel_course(now_ns)
        output.odometry.publish_lazily(exact_odometry_message, stamp_ns, output.frames, course)
        if stamp_ns != self._transforms_ns:
            self._transforms_ns = stamp_ns
            map_frame = None if output.map_frame is None else (output.map_frame, motion.map_from_own)
            output.transforms.publish_lazily(exact_transforms_message, stamp_ns, map_frame, output.frames, course)

    def _publish_others(self, now_ns: int, stamp_ns: int) -> None:
        """Publishes contacts, joints and the ground truth, as far as they are wanted."""
        publishers, parameters, motion = self._publishers, self._robot.parameters, self._robot.motion
        assert publishers is not None
        if publishers.contacts is not None or publishers.stalled is not None:
            self._publish_contacts(now_ns, stamp_ns)
        if publishers.joints is not None:
            joints, stamp = motion.joints(now_ns), Time.from_nanoseconds(stamp_ns)
            publishers.joints.publish_lazily(joint_states_message, stamp, parameters.joints, joints)
        if publishers.truth is not None:
            frames = parameters.map_frame_id, parameters.frames["base_link_frame"]
            pose, velocity = motion.map_pose(now_ns), motion.velocity(now_ns)
            publishers.truth.publish_lazily(odometry_message, Time.from_nanoseconds(stamp_ns), frames, pose, velocity)

    def _send_odometry(self, now_ns: int, stamp: Time) -> None:
        """Reads the odometry and publishes what it says."""
        assert self._publishers is not None
        names = self._robot.parameters.frames
        frames = names["odom_frame_id"], names["base_link_frame"]
        reading, velocity = self._odometry.read(now_ns)
        self._believed = reading.pose
        self._publishers.odometry.publish_lazily(
            odometry_message, stamp, frames, reading.pose, velocity, reading.covariance, reading.twist_covariance
        )

    def _publish_contacts(self, now_ns: int, stamp_ns: int) -> None:
        """Publishes the contacts that have begun since the last call, and a change of whether the robot is stalled."""
        assert self._publishers is not None
        motion = self._robot.motion
        begun = takewhile(lambda contact: contact.time > self._contact_time, reversed(motion.contacts_until(now_ns)))
        for contact in reversed(list(begun)):
            self._contact_time = contact.time
            x, y = contact.point
            self._node.get_logger().info(f"contact with {contact.what} at ({x:.2f}, {y:.2f}), at {contact.speed:.2f} m/s")
            if self._publishers.contacts is not None:
                began = stamp_ns - (now_ns - round(contact.time * NANOSECONDS))
                header = Header(Time.from_nanoseconds(began), self._robot.parameters.map_frame_id)
                self._publishers.contacts.publish(messages.PointStamped(header, messages.Point(x, y)))
        if self._publishers.stalled is not None and motion.is_blocked != self._is_stalled:
            self._is_stalled = motion.is_blocked
            self._publishers.stalled.publish(messages.Bool(self._is_stalled))

    def _send_transforms(self, now_ns: int, stamp: Time, odom_from_base: Pose) -> None:
        """Publishes odom -> base_link, and map -> odom and the true pose if they are wanted.

        Must be called at most once for each stamp, because tf2 warns about repeated stamps.

        Args:
            now_ns: Simulated time [ns].
            stamp: Stamp of the odometry at that time.
            odom_from_base: Pose of the robot that the odometry reports.
        """
        assert self._publishers is not None
        parameters, motion = self._robot.parameters, self._robot.motion
        frames, map_frame = parameters.frames, parameters.map_frame_id
        self._transforms_ns = stamp.nanoseconds
        links = [(frames["odom_frame_id"], frames["base_link_frame"], odom_from_base)]
        if parameters.publish_map_transform:
            links.insert(0, (map_frame, frames["odom_frame_id"], self._map_from_odom(now_ns, odom_from_base)))
        if parameters.ground_truth_frame:
            links.append((map_frame, frames["ground_truth_frame"], motion.map_pose(now_ns)))
        self._publishers.transforms.publish_lazily(transforms_message, stamp, links)

    def _map_from_odom(self, now_ns: int, odom_from_base: Pose) -> Pose:
        """Returns the pose of the odometry frame in the map that makes map -> odom -> base_link the robot's true pose."""
        motion = self._robot.motion
        if motion.slipped or not self._odometry.is_exact:
            return (motion.map_pose(now_ns) * odom_from_base.inverse()).wrapped()
        return motion.map_from_own

    def _publish_clock(self) -> None:
        self._send_clock(self._clock.now().nanoseconds)

    def _send_clock(self, stamp_ns: int) -> None:
        if self._publishers is not None and self._publishers.clock is not None:
            self._publishers.clock.publish_lazily(clock_message, stamp_ns)
