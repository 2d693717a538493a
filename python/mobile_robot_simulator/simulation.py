"""Simulation: a map, the two nodes and the bus in one object."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Mapping
from typing import Any

from ._core import OccupancyGrid, Pose
from .bus import NANOSECONDS, Bus, BusNode, Subscription, Tap, absolute
from .laser_node import LaserScannerSimulator
from .map_node import MapServer, with_unknown
from .messages import Message
from .node_interface import M
from .parameters import LaserParameters, RobotParameters, check_names, for_node
from .robot_node import MobileRobotSimulator


class Simulation:
    """A robot with a laser scanner in a map, on a virtual clock that starts at 0.

    grid: the map. parameters: values of the nodes' parameters by name; unless they say otherwise, the map transform is
    published and commands are plain Twist. seed: seed of the noise, before the parameter of that name.
    start: pose (x, y, yaw) of the robot in the map frame at first.

    The same arguments and the same calls give the same messages, byte by byte.

    raises: ValueError for unknown parameters, values out of range, a start inside a wall.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        *,
        parameters: Mapping[str, Any] | None = None,
        seed: int | None = None,
        start: Pose | tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        values = {"publish_map_transform": True, "cmd_vel_stamped": False, **(parameters or {})}
        if seed is not None:
            values["seed"] = seed
        check_names(values)
        robot, laser = for_node(RobotParameters, values), for_node(LaserParameters, values)
        if any(key.rpartition(":")[2] == "unknown" for key in values) and laser.unknown != grid.unknown:
            grid = with_unknown(grid, laser.unknown)
        pose = start if isinstance(start, Pose) else _pose(start)
        if not grid.is_free_disc(pose.x, pose.y, 0.0):
            raise ValueError(f"start must not be inside a wall, got ({pose.x}, {pose.y}, {pose.yaw})")
        self._grid = grid
        self._bus = Bus()
        self._node = self._bus.create_node("simulation")
        self._map_server = MapServer(
            self._bus.create_node("map_server"), grid, service=laser.map_service, frame_id=laser.map_frame_id
        )
        self._robot = MobileRobotSimulator(self._bus.create_node(robot.node_name), robot, start_pose=pose)
        self._laser = LaserScannerSimulator(self._bus.create_node(laser.node_name), laser, grid=grid)
        for node in (self._map_server, self._robot, self._laser):
            node.start()

    @property
    def grid(self) -> OccupancyGrid:
        """The map."""
        return self._grid

    @property
    def robot(self) -> MobileRobotSimulator:
        """The robot's node."""
        return self._robot

    @property
    def laser(self) -> LaserScannerSimulator:
        """The scanner's node."""
        return self._laser

    @property
    def time(self) -> float:
        """Simulated seconds since the start."""
        return self._bus.time_ns / NANOSECONDS

    @property
    def pose(self) -> Pose:
        """Where the robot is now, in the map frame."""
        return self._robot.pose

    def run_for(self, seconds: float) -> None:
        """Let simulated time go on; no sleeping.

        What a callback raises comes out here with its traceback; the run can go on afterwards.
        raises: ValueError for a duration that is negative or not finite.
        """
        if not 0.0 <= seconds < math.inf:
            raise ValueError(f"the duration must be finite and at least 0 s, got {seconds}")
        self._bus.run_until(self._bus.time_ns + round(seconds * NANOSECONDS))

    def publish(self, topic: str, message: Message) -> None:
        """Send a message; it arrives when time goes on.

        raises: ValueError for a topic that does not exist; TypeError for a message of another type than the topic's.
        """
        self._check_topic(topic)
        self._node.create_publisher(type(message), topic).publish(message)

    def subscribe(self, topic: str, msg_type: type[M], callback: Callable[[M], None]) -> Subscription[M]:
        """Have every message of a topic handed to a callback.

        raises: ValueError for a topic that does not exist; TypeError for another type than the topic's.
        """
        self._check_topic(topic)
        return self._node.create_subscription(msg_type, topic, callback)

    def unsubscribe(self, subscription: Subscription[Any]) -> None:
        """Hand no more messages to a subscription's callback."""
        self._node.destroy_subscription(subscription)

    def latest(self, topic: str) -> Any:
        """The message last published to a topic, None if there was none yet.

        raises: ValueError for a topic that does not exist.
        """
        self._check_topic(topic)
        return self._bus.latest(topic)

    def create_node(self, name: str) -> BusNode:
        """A node of one's own, for topics, timers and services under rclpy's names."""
        return self._bus.create_node(name)

    def record(self, tap: Tap) -> None:
        """Call `tap(topic, message, time_ns)` for every message published, and at once for the latched ones so far."""
        for topic, message, time_ns in self._bus.latched():
            tap(topic, message, time_ns)
        self._bus.taps.append(tap)

    def _check_topic(self, name: str) -> None:
        names = self._bus.topic_names()
        if absolute(name) not in names:
            near = difflib.get_close_matches(absolute(name), names, n=1)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
            raise ValueError(f"unknown topic {name!r}; {hint}")


def _pose(numbers: tuple[float, float, float]) -> Pose:
    try:
        x, y, yaw = map(float, numbers)
    except (TypeError, ValueError):
        raise ValueError(f"start must be three numbers (x, y, yaw), got {numbers!r}") from None
    return Pose(x, y, yaw)
