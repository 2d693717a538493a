"""WorldServer: markers add, move and remove obstacles, and show the world."""

from __future__ import annotations

import logging
import math
import re
from typing import Any

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages
from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import NoCopyNode
from mobile_robot_simulator.marker_messages import Marker, MarkerArray
from mobile_robot_simulator.nodes.interface import QoS
from mobile_robot_simulator.nodes.world_server import WorldServer
from mobile_robot_simulator.parameters import RobotParameters, WorldParameters
from mobile_robot_simulator.physics.world import World

SECOND = 1_000_000_000


class Rig:
    """A world with a robot, its server, and whatever they publish."""

    def __init__(self, room: mrs.OccupancyGrid) -> None:
        self.bus = Bus()
        self.world = World(lambda: self.bus.time_ns, room)
        parameters = RobotParameters.checked({"robot_radius": 0.3, "velocity_timeout": 0.0, "cmd_vel_stamped": False})
        self.robot = mrs.nodes.MobileRobotSimulator(
            NoCopyNode(self.bus, "robot"), parameters, world=self.world, name="robot1"
        )
        self.server = WorldServer(NoCopyNode(self.bus, "world"), WorldParameters(), self.world)
        self.node = NoCopyNode(self.bus, "tester")
        self.shown: list[MarkerArray] = []
        self.contacts: list[messages.PointStamped] = []
        self.stalled: list[bool] = []
        self.robot.start()
        self.server.start()
        self.node.create_subscription(MarkerArray, "markers", self.shown.append, QoS.DEFAULT)
        self.node.create_subscription(messages.PointStamped, "contacts", self.contacts.append, QoS.DEFAULT)
        self.node.create_subscription(messages.Bool, "stalled", lambda it: self.stalled.append(it.data), QoS.LATCHED)

    def run_for(self, seconds: float) -> None:
        self.bus.run_until(self.bus.time_ns + round(seconds * SECOND))

    def send(self, message: messages.Message, topic: str) -> None:
        self.node.create_publisher(type(message), topic).publish(message)
        self.run_for(0.001)

    def mark(self, *markers: Marker) -> None:
        self.send(MarkerArray(list(markers)), "obstacles")

    def drive(self, vx: float, seconds: float) -> None:
        self.send(messages.Twist(messages.Vector3(vx)), "cmd_vel")
        self.run_for(seconds)


def marker(ns: str = "box", kind: int = Marker.CUBE, x: float = 3.0, **fields: Any) -> Marker:
    pose = messages.Pose.from_planar(mrs.Pose(x, 0.0, fields.pop("yaw", 0.0)))
    return Marker(ns=ns, type=kind, pose=pose, scale=messages.Vector3(1.0, 1.0, 1.0), **fields)


def test_a_marker_adds_an_obstacle_that_stops_the_robot(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.mark(marker())
    rig.drive(0.5, 8.0)
    assert rig.robot.pose.x == pytest.approx(2.2, abs=1e-5)
    (contact,) = rig.contacts
    assert (contact.header.frame_id, contact.point.x, contact.point.y) == ("map", pytest.approx(2.5, abs=1e-5), 0.0)
    assert contact.header.stamp.nanoseconds == pytest.approx(4.401 * SECOND, abs=1e-4 * SECOND)
    assert rig.stalled == [False, True]
    rig.drive(-0.5, 1.0)
    assert rig.stalled == [False, True, False] and rig.robot.pose.x < 2.0


@pytest.mark.parametrize(
    ("kind", "points", "shape"),
    [
        (Marker.CUBE, [], mrs.Shape.rectangle(1.0, 1.0)),
        (Marker.SPHERE, [], mrs.Shape.disc(0.5)),
        (Marker.CYLINDER, [], mrs.Shape.disc(0.5)),
        (Marker.LINE_STRIP, [(0, 0), (1, 0), (0, 1)], mrs.Shape.polygon([(0, 0), (1, 0), (0, 1)])),
        (Marker.LINE_STRIP, [(0, 0), (1, 0), (0, 1), (0, 0)], mrs.Shape.polygon([(0, 0), (1, 0), (0, 1)])),
    ],
)
def test_markers_are_shapes(room: mrs.OccupancyGrid, kind: int, points: list[Any], shape: mrs.Shape) -> None:
    rig = Rig(room)
    rig.mark(marker(kind=kind, points=[messages.Point(x, y) for x, y in points], yaw=0.5, id=7))
    (obstacle,) = rig.world.obstacles
    assert obstacle.shape == shape and obstacle.name == "box_7"
    assert tuple(obstacle.pose(rig.bus.time_ns)) == pytest.approx((3.0, 0.0, 0.5))


def test_a_known_obstacle_moves_changes_drives_and_goes(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.mark(marker(), marker("other", x=-5.0))
    box, other = rig.world.obstacles
    rig.mark(marker(x=4.0))
    assert rig.world.obstacles == [box, other] and box.pose(rig.bus.time_ns).x == 4.0
    rig.send(messages.PoseStamped(pose=messages.Pose.from_planar(mrs.Pose(5.0, 1.0, math.pi / 2))), "obstacles/box/pose")
    rig.send(messages.Twist(messages.Vector3(0.5)), "obstacles/box/cmd_vel")
    rig.run_for(1.999)
    assert tuple(box.pose(rig.bus.time_ns)) == pytest.approx((5.0, 2.0, math.pi / 2), abs=1e-3)
    rig.mark(marker(kind=Marker.CYLINDER))
    assert [obstacle.name for obstacle in rig.world.obstacles] == ["other", "box"]
    assert rig.world.obstacles[1].shape == mrs.Shape.disc(0.5)
    rig.mark(marker(action=Marker.DELETE))
    assert rig.world.obstacles == [other] and "/obstacles/box/pose" in rig.bus.topic_names()
    rig.mark(marker(), marker(action=Marker.DELETEALL))
    assert rig.world.obstacles == []


def test_the_service_removes_what_markers_have_added_and_nothing_else(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    own = mrs.physics.Obstacle("own", mrs.Shape.disc(0.2), (7.0, 7.0, 0.0))
    rig.world.place(own)
    rig.mark(marker(), marker("other", x=-5.0))
    client = rig.node.create_client(messages.Trigger, "remove_obstacles")
    future = client.call_async(messages.TriggerRequest())
    rig.run_for(0.1)
    assert future.result().message == "2 obstacles removed" and rig.world.obstacles == [own]


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (marker(kind=9), r"the type must be CUBE \(1\), SPHERE \(2\), CYLINDER \(3\) or LINE_STRIP \(4\), got 9"),
        (marker(action=1), "the action must be ADD"),
        (marker(header=messages.Header(frame_id="odom")), "it must be in frame map, got odom"),
        (
            Marker(
                ns="box", type=Marker.CUBE, scale=messages.Vector3(1.0, 1.0), pose=messages.Pose(messages.Point(math.nan))
            ),
            "obstacle box refused: .*finite",
        ),
        (marker("no name"), "the name must have at most 100 letters"),
        (marker("a" * 101), "the name must have at most 100 letters"),
        (marker(action=Marker.DELETE), "there is no such obstacle"),
        (Marker(ns="box", type=Marker.CUBE), "obstacle box refused: "),
        (Marker(ns="box", type=Marker.CYLINDER, scale=messages.Vector3(1.0, 2.0)), "the same scale along x and y"),
    ],
)
def test_what_is_wrong_is_logged_and_the_rest_is_done(
    room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture, wrong: Marker, reason: str
) -> None:
    rig = Rig(room)
    with caplog.at_level(logging.WARNING):
        rig.mark(wrong, marker("good"))
    assert re.search(reason, caplog.text), caplog.text
    assert [obstacle.name for obstacle in rig.world.obstacles] == ["good"]


def test_poses_and_velocities_of_obstacles_are_checked(room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture) -> None:
    rig = Rig(room)
    rig.mark(marker())
    with caplog.at_level(logging.WARNING):
        rig.send(messages.PoseStamped(messages.Header(frame_id="odom")), "obstacles/box/pose")
        rig.send(messages.PoseStamped(pose=messages.Pose(messages.Point(math.nan))), "obstacles/box/pose")
        rig.send(messages.Twist(messages.Vector3(math.nan)), "obstacles/box/cmd_vel")
        rig.send(messages.Twist(messages.Vector3(1e300)), "obstacles/box/cmd_vel")
    assert caplog.text.count("of obstacle box refused") == 4
    rig.run_for(1.0)
    assert tuple(rig.world.obstacles[0].pose(rig.bus.time_ns)) == (3.0, 0.0, 0.0)


def test_markers_show_robots_obstacles_and_contacts(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.mark(marker(), marker("pole", Marker.CYLINDER, x=-5.0))
    rig.drive(0.5, 5.0)
    markers = {(each.ns, each.id): each for each in rig.shown[-1].markers}
    assert set(markers) == {("robots", 0), ("obstacles", 0), ("obstacles", 1), ("contacts", 0)}
    robot, box, pole, contact = (
        markers[key] for key in (("robots", 0), ("obstacles", 0), ("obstacles", 1), ("contacts", 0))
    )
    assert (robot.type, robot.scale.x, robot.text) == (Marker.CYLINDER, 0.6, "robot1")
    assert robot.pose.position.x == pytest.approx(2.2, abs=1e-5)
    assert box.type == Marker.LINE_STRIP and len(box.points) == 5 and box.points[0] == box.points[-1]
    assert (pole.type, pole.scale.x, pole.pose.position.x) == (Marker.CYLINDER, 1.0, -5.0)
    assert contact.pose.position.x == pytest.approx(2.5, abs=1e-5)
    assert all(each.header.frame_id == "map" and each.lifetime.nanoseconds == 0.5 * SECOND for each in markers.values())
    rig.run_for(3.0)
    assert ("contacts", 0) not in {(each.ns, each.id) for each in rig.shown[-1].markers}


def test_parameters_restart_the_server_and_the_obstacles_stay(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.mark(marker())
    rig.server.set_parameters(markers_rate=20.0)
    count = len(rig.shown)
    rig.run_for(1.0)
    assert len(rig.shown) - count == 20 and len(rig.world.obstacles) == 1
    with pytest.raises(ValueError, match="robots can only be set at startup"):
        rig.server.set_parameters(robots=("a",))
    rig.server.stop()
    rig.run_for(1.0)
    assert len(rig.shown) - count == 20


def test_what_cannot_be_listened_to_is_not_in_the_world(room: mrs.OccupancyGrid, caplog: pytest.LogCaptureFixture) -> None:
    rig = Rig(room)
    rig.node.create_publisher(messages.TwistStamped, "obstacles/box/cmd_vel")
    with caplog.at_level(logging.WARNING):
        rig.mark(marker())
    assert "obstacle box refused" in caplog.text and rig.world.obstacles == []


def test_a_wrong_topic_changes_nothing(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.mark(marker())
    with pytest.raises(TypeError, match="cmd_vel carries"):
        rig.server.set_parameters(obstacles_topic="cmd_vel")
    assert rig.server.parameters.obstacles_topic == "obstacles"
    rig.send(messages.Twist(messages.Vector3(0.5)), "obstacles/box/cmd_vel")
    rig.run_for(0.999)
    assert rig.world.obstacles[0].pose(rig.bus.time_ns).x == pytest.approx(3.5, abs=2e-3)


def test_obstacles_follow_the_server_to_another_topic_and_stop_listening_with_it(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.mark(marker())
    (box,) = rig.world.obstacles
    rig.server.set_parameters(obstacles_topic="things")
    moved = messages.PoseStamped(pose=messages.Pose.from_planar(mrs.Pose(5.0, 0.0, 0.0)))
    rig.send(moved, "obstacles/box/pose")
    assert box.pose(rig.bus.time_ns).x == 3.0
    rig.send(moved, "things/box/pose")
    assert box.pose(rig.bus.time_ns).x == 5.0
    rig.server.stop()
    rig.send(messages.Twist(messages.Vector3(0.5)), "things/box/cmd_vel")
    rig.run_for(1.0)
    assert box.pose(rig.bus.time_ns).x == 5.0


def test_a_restart_of_a_stalled_robot_says_that_it_is_stalled(room: mrs.OccupancyGrid) -> None:
    rig = Rig(room)
    rig.mark(marker())
    rig.drive(0.5, 8.0)
    rig.robot.set_parameters(publish_rate=20.0)
    rig.run_for(1.0)
    assert rig.stalled[:2] == [False, True] and set(rig.stalled[2:]) <= {True}
