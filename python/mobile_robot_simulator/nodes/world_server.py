"""WorldServer: the node that lets others add, move and remove obstacles, and shows the world to RViz."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from .. import messages
from .._core import MAX_COMMAND, Pose, Shape
from ..handle import Handles
from ..marker_messages import ColorRGBA, Marker, MarkerArray
from ..messages import Header, Point, Time, Trigger, Twist, Vector3
from ..parameters import WorldParameters
from ..physics.obstacles import Obstacle
from ..physics.velocity_profile import Velocity
from ..physics.world import World
from ..quoting import quoted
from .entity_services import EntityServices
from .interface import Node, Publisher, QoS
from .transforms import check_frame

HEIGHT = 0.5
"""Height of all shapes in RViz [m]. The simulated world is flat."""

ROBOT, OBSTACLE, CONTACT = ColorRGBA(0.1, 0.4, 0.9, 1.0), ColorRGBA(0.9, 0.5, 0.1, 1.0), ColorRGBA(0.9, 0.1, 0.1, 1.0)
"""Colors of the markers."""

CONTACT_NS = 2_000_000_000
"""Time for which a contact is shown [ns]."""

LONGEST_NAME = 100
"""Largest number of characters in the name of an obstacle; it is a part of names of topics."""


class WorldServer:
    """Changes and shows a world, on the topics of ROS.

    Obstacles:
        Each marker on `obstacles_topic` adds, changes or removes an obstacle, as RViz would: with the action ADD, an
        obstacle that exists already moves to the pose of the marker and takes its shape. A CUBE is a rectangle, a CYLINDER
        or a SPHERE a disc; their scale is the full length of each side. A LINE_STRIP is a polygon with the corners `points`.
        The name of an obstacle is `ns`, followed by `_id` if the id is not 0. An obstacle named `box` also moves with
        each pose on `<obstacles_topic>/box/pose`, and drives with each velocity on `<obstacles_topic>/box/cmd_vel`. The
        service `remove_obstacles` removes all obstacles. `EntityServices` has services that add, move and remove one.
    Markers:
        `markers_topic` shows the footprints of the robots, the obstacles, and contacts of the last 2 s.

    Args:
        node: Node to publish and subscribe through.
        parameters: Parameters.
        world: World to change and to show.
    """

    def __init__(self, node: Node, parameters: WorldParameters, world: World) -> None:
        self._node, self._parameters, self._world = node, parameters, world
        self._own: dict[str, Obstacle] = {}
        """Obstacles that came by a marker, by name."""
        self._listening: dict[str, Handles] = {}
        """Subscriptions of these obstacles, by name."""
        self._markers: Publisher[MarkerArray] | None = None
        self._running: Handles | None = None

    @property
    def parameters(self) -> WorldParameters:
        """Current parameters."""
        return self._parameters

    def set_parameters(self, **values: Any) -> None:
        """Changes parameters by name, and restarts the node if one has a new value. The obstacles stay.

        Args:
            **values: New values, by the names of `WorldParameters`.

        Raises:
            ValueError: A value is invalid, or `robots` would change. Nothing changes.
            TypeError: A new topic name belongs to a topic of another message type. Nothing changes.
        """
        before, after = self._parameters, self._parameters.changed(values)
        if after.robots != before.robots:
            raise ValueError(f"robots can only be set at startup and stays {list(before.robots)}")
        if after == before or self._running is None:
            self._parameters = after
            return
        self.stop()
        self._parameters = after
        try:
            self.start()
        except Exception:
            self._parameters = before
            self.start()
            raise

    def start(self) -> None:
        """Starts to listen and to publish. Has no effect if the node is running.

        If the messages of markers are not installed, logs that and does nothing.
        """
        if self._running is not None:
            return
        node, parameters = self._node, self._parameters
        with Handles() as handles:
            try:
                obstacles = node.create_subscription(MarkerArray, parameters.obstacles_topic, self._take, QoS.DEFAULT)
            except ImportError:
                node.get_logger().info("no obstacles and no markers, because visualization_msgs is not installed")
                return
            handles.add(node.destroy_subscription, obstacles)
            removal = node.create_service(Trigger, "remove_obstacles", self._answer_removal)
            handles.add(node.destroy_service, removal)
            EntityServices(node, self, parameters.map_frame_id).start(handles)
            if parameters.markers_topic:
                self._markers = node.create_publisher(MarkerArray, parameters.markers_topic, QoS.DEFAULT)
                handles.add(node.destroy_publisher, self._markers)
                handles.add(node.destroy_timer, node.create_timer(1.0 / parameters.markers_rate, self._show))
            handles.add(self._stop_listening)
            for obstacle in self._own.values():
                self._listen(obstacle)
            self._running = handles

    def stop(self) -> None:
        """Stops listening and publishing. `start` resumes."""
        if self._running is not None:
            self._running.close()
            self._running = None

    # --- obstacles ---

    def has(self, name: str) -> bool:
        """Returns True if there is an obstacle of this name that came by a marker or a service."""
        return name in self._own

    def check_name(self, name: str) -> None:
        """Raises ValueError if an obstacle cannot have this name."""
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) or len(name) > LONGEST_NAME:
            needed = f"at most {LONGEST_NAME} letters, digits and underscores, and not start with a digit"
            raise ValueError(f"the name must have {needed}, got {quoted(name)}")

    def add(self, name: str, shape: Shape, pose: Pose) -> None:
        """Adds an obstacle, whose name is not in use.

        Raises:
            ValueError: The name is invalid.
            TypeError: The topics of the obstacle have messages of another type.
        """
        self.check_name(name)
        obstacle = Obstacle(name, shape, pose)
        self._listen(obstacle)
        self._world.place(obstacle)
        self._own[name] = obstacle

    def move(self, name: str, pose: Pose | None, velocity: Velocity | None) -> None:
        """Moves an obstacle from now on.

        Args:
            name: Name of an obstacle that exists.
            pose: Pose to move to at once. None leaves it where it is.
            velocity: Velocity (vx, vy, wz) from now on, along the axes of the map [m/s, m/s, rad/s]. None leaves it.

        Raises:
            ValueError: A component of the velocity is not in -`MAX_COMMAND`..`MAX_COMMAND`. Nothing changes.
        """
        obstacle = self._own[name]
        if velocity is not None:
            _check_velocity(velocity)
            at = obstacle.pose(self._world.now_ns()) if pose is None else pose
            along = Pose(0.0, 0.0, at.yaw).inverse() * Pose(velocity[0], velocity[1], 0.0)
            velocity = along.x, along.y, velocity[2]
        self._world.move(obstacle, pose, velocity)

    def remove(self, name: str) -> None:
        """Removes an obstacle. Raises ValueError if there is none of this name."""
        if name not in self._own:
            raise ValueError("there is no such obstacle")
        self._listening.pop(name).close()
        self._world.remove(self._own.pop(name))

    def _take(self, message: MarkerArray) -> None:
        """Adds, changes and removes obstacles. What is invalid is logged, and the rest is done."""
        for marker in message.markers:
            name = obstacle_name(marker)
            try:
                self._apply(name, marker)
            except (ValueError, TypeError) as error:
                self._node.get_logger().warning(f"obstacle {name} refused: {error}")

    def _apply(self, name: str, marker: Marker) -> None:
        if marker.action == Marker.DELETEALL:
            self._remove_all()
        elif marker.action == Marker.DELETE:
            self.remove(name)
        elif marker.action == Marker.ADD:
            check_frame(marker.header, self._parameters.map_frame_id)
            self._put(name, shape_of(marker), marker.pose.to_planar())
        else:
            raise ValueError(f"the action must be ADD (0), DELETE (2) or DELETEALL (3), got {marker.action}")

    def _put(self, name: str, shape: Shape, pose: Pose) -> None:
        if name in self._own and self._own[name].shape == shape:
            self._world.move(self._own[name], pose, None)
            return
        self.check_name(name)
        if name in self._own:
            self.remove(name)
        self.add(name, shape, pose)

    def _listen(self, obstacle: Obstacle) -> None:
        """Subscribes to poses and velocities of an obstacle."""
        node, topic = self._node, f"{self._parameters.obstacles_topic}/{obstacle.name}"
        with Handles() as handles:
            take_pose = partial(self._take_pose, obstacle)
            poses = node.create_subscription(messages.PoseStamped, f"{topic}/pose", take_pose, QoS.DEFAULT)
            handles.add(node.destroy_subscription, poses)
            take_velocity = partial(self._take_velocity, obstacle)
            velocities = node.create_subscription(Twist, f"{topic}/cmd_vel", take_velocity, QoS.DEFAULT)
            handles.add(node.destroy_subscription, velocities)
            self._listening[obstacle.name] = handles

    def _stop_listening(self) -> None:
        while self._listening:
            self._listening.popitem()[1].close()

    def _remove_all(self) -> None:
        for name in list(self._own):
            self.remove(name)

    def _answer_removal(
        self, request: messages.TriggerRequest, response: messages.TriggerResponse
    ) -> messages.TriggerResponse:
        count = len(self._own)
        self._remove_all()
        response.success, response.message = True, f"{count} obstacles removed"
        return response

    def _take_pose(self, obstacle: Obstacle, message: messages.PoseStamped) -> None:
        try:
            check_frame(message.header, self._parameters.map_frame_id)
            self._world.move(obstacle, message.pose.to_planar(), None)
        except ValueError as error:
            self._node.get_logger().warning(f"pose of obstacle {obstacle.name} refused: {error}")

    def _take_velocity(self, obstacle: Obstacle, twist: Twist) -> None:
        velocity = (twist.linear.x, twist.linear.y, twist.angular.z)
        try:
            _check_velocity(velocity)
        except ValueError as error:
            self._node.get_logger().warning(f"velocity of obstacle {obstacle.name} refused: {error}")
        else:
            self._world.move(obstacle, None, velocity)

    # --- markers ---

    def _show(self) -> None:
        assert self._markers is not None
        self._markers.publish(MarkerArray(list(self._draw())))

    def _draw(self) -> Iterator[Marker]:
        """Yields the markers of the world now. They vanish by themselves, so that what is removed need not be named."""
        now_ns = self._world.now_ns()
        header = Header(Time.from_nanoseconds(self._node.get_clock().now().nanoseconds), self._parameters.map_frame_id)
        lifetime = Time.from_nanoseconds(round(2.5e9 / self._parameters.markers_rate))
        robots, obstacles, contacts = self._world.bodies, self._world.obstacles, 0
        for index, body in enumerate(robots):
            pose = body.motion.map_pose(now_ns)
            yield _marker(header, "robots", index, ROBOT, lifetime, body.footprint, pose, body.body_name)
            for contact in body.motion.contacts_until(now_ns)[-1:]:
                if now_ns - contact.time * 1e9 <= CONTACT_NS:
                    place = messages.Pose.from_planar(Pose(*contact.point))
                    scale = Vector3(0.1, 0.1, 0.1)
                    yield Marker(header, "contacts", contacts, Marker.SPHERE, 0, place, scale, CONTACT, lifetime)
                    contacts += 1
        for index, obstacle in enumerate(obstacles):
            pose = obstacle.pose(now_ns)
            yield _marker(header, "obstacles", index, OBSTACLE, lifetime, obstacle.shape, pose, obstacle.name)


def _check_velocity(velocity: Velocity) -> None:
    if not all(abs(value) <= MAX_COMMAND for value in velocity):
        raise ValueError(f"|vx|, |vy| and |wz| must be at most {MAX_COMMAND:g}, got {velocity}")


def obstacle_name(marker: Marker) -> str:
    """Returns the name of the obstacle that a marker stands for: `ns`, or `obstacle`, and `_id` if the id is not 0."""
    name = marker.ns or "obstacle"
    return f"{name}_{marker.id}" if marker.id else name


def shape_of(marker: Marker) -> Shape:
    """Returns the outline that a marker has on the floor.

    Raises:
        ValueError: The type is none of CUBE, SPHERE, CYLINDER and LINE_STRIP, or its size is invalid.
    """
    scale = marker.scale
    if marker.type == Marker.CUBE:
        return Shape.rectangle(scale.x, scale.y)
    if marker.type in (Marker.SPHERE, Marker.CYLINDER):
        if scale.x != scale.y:
            raise ValueError(f"a disc must have the same scale along x and y, got {scale.x} and {scale.y}")
        return Shape.disc(scale.x / 2.0)
    if marker.type == Marker.LINE_STRIP:
        corners = [(point.x, point.y) for point in marker.points]
        return Shape.polygon(corners[:-1] if len(corners) > 1 and corners[0] == corners[-1] else corners)
    raise ValueError(f"the type must be CUBE (1), SPHERE (2), CYLINDER (3) or LINE_STRIP (4), got {marker.type}")


def _marker(
    header: Header, ns: str, index: int, color: ColorRGBA, lifetime: Time, shape: Shape | None, pose: Pose, text: str
) -> Marker:
    """Returns the marker of a shape: a cylinder, the outline of a polygon, or an arrow if there is no shape."""
    marker = Marker(header, ns, index, pose=messages.Pose.from_planar(pose), color=color, lifetime=lifetime, text=text)
    if shape is None:
        marker.type, marker.scale = Marker.ARROW, Vector3(0.4, 0.08, 0.08)
    elif shape.radius is not None:
        marker.type, marker.scale = Marker.CYLINDER, Vector3(2.0 * shape.radius, 2.0 * shape.radius, HEIGHT)
        marker.pose.position.z = HEIGHT / 2.0
    else:
        corners = np.asarray(shape.points).tolist()
        marker.type, marker.scale = Marker.LINE_STRIP, Vector3(0.04)
        marker.points = [Point(x, y) for x, y in [*corners, corners[0]]]
    return marker
