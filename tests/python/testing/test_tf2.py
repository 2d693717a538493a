"""tf2 on the bus: lookups between, before and after transforms, across trees, and after a restore."""

from __future__ import annotations

import math

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.instant import Duration, Instant
from mobile_robot_simulator.messages import Header, Quaternion, Time, Transform, TransformStamped, Vector3
from mobile_robot_simulator.testing import stand_in
from mobile_robot_simulator.testing.tf2 import Buffer
from simulations import small_room

with stand_in():
    from geometry_msgs.msg import Point, PointStamped, Pose, PoseStamped, Vector3Stamped
    from rclpy.node import Node
    from tf2_geometry_msgs import do_transform_pose
    from tf2_ros import (
        ConnectivityException,
        ExtrapolationException,
        LookupException,
        StaticTransformBroadcaster,
        TransformBroadcaster,
        TransformListener,
    )
    from tf2_ros.buffer import Buffer as SameBuffer


def link(parent: str, child: str, seconds: float, *pose: float) -> TransformStamped:
    header = Header(Time.from_nanoseconds(round(seconds * 1e9)), parent)
    return TransformStamped(header, child, Transform.from_planar(mrs.Pose(*pose)))


def at(buffer: Buffer, target: str, source: str, seconds: float) -> mrs.Pose:
    return buffer.lookup_transform(target, source, Instant(seconds=seconds)).transform.to_planar()


@pytest.fixture
def buffer() -> Buffer:
    """A robot at (1, 0) at 1 s and at (3, 0) at 2 s, turned left, with a laser 0.5 m ahead of it; `moon` is elsewhere."""
    buffer = Buffer()
    buffer.set_transform(link("odom", "base", 2.0, 3.0, 0.0, math.pi / 2))
    buffer.set_transform(link("odom", "base", 1.0, 1.0, 0.0, math.pi / 2))
    buffer.set_transform_static(link("base", "laser", 0.0, 0.5, 0.0, 0.0))
    buffer.set_transform_static(link("sky", "moon", 0.0, 1.0, 0.0, 0.0))
    return buffer


@pytest.mark.parametrize(("seconds", "x"), [(1.0, 1.0), (1.25, 1.5), (2.0, 3.0), (0.0, 3.0)])
def test_a_pose_is_interpolated_and_time_zero_is_the_latest(buffer, seconds, x):
    pose = at(buffer, "odom", "laser", seconds)
    assert tuple(pose) == pytest.approx((x, 0.5, math.pi / 2))
    assert tuple(at(buffer, "laser", "odom", seconds)) == pytest.approx(tuple(pose.inverse()))


def test_the_result_names_its_frames_and_time(buffer):
    found = buffer.lookup_transform("odom", "base", Instant())
    assert (found.header.frame_id, found.child_frame_id, found.header.stamp) == ("odom", "base", Time(2, 0))


@pytest.mark.parametrize(
    ("target", "source", "seconds", "error", "message"),
    [
        ("map", "base", 1.0, LookupException, '"map" passed to lookupTransform argument target_frame does not exist'),
        ("odom", "arm", 1.0, LookupException, "source_frame does not exist"),
        ("odom", "moon", 1.0, ConnectivityException, "not part of the same tree"),
        ("odom", "base", 0.5, ExtrapolationException, "into the past.*0.500000 but the earliest data is at time 1.000000"),
        ("odom", "laser", 2.5, ExtrapolationException, "into the future.*2.500000 but the latest data is at time 2.000000"),
    ],
)
def test_a_missing_transform_raises_the_exception_of_tf2(buffer, target, source, seconds, error, message):
    with pytest.raises(error, match=message):
        at(buffer, target, source, seconds)
    assert not buffer.can_transform(target, source, Instant(seconds=seconds))


def test_transforms_older_than_the_cache_time_are_dropped():
    buffer = Buffer(cache_time=Duration(seconds=2.0))
    for second in range(1, 6):
        buffer.set_transform(link("odom", "base", second, second))
    assert buffer.can_transform("odom", "base", Instant(seconds=3.0))
    assert not buffer.can_transform("odom", "base", Instant(seconds=2.9))


def test_a_frame_can_change_its_parent(buffer):
    buffer.set_transform(link("map", "base", 3.0, 7.0))
    assert at(buffer, "map", "base", 0.0).x == 7.0 and not buffer.can_transform("odom", "base", Instant())


def test_poses_and_points_move_to_another_frame(buffer):
    header = Header(Time(1, 0), "base")
    pose = buffer.transform(PoseStamped(header=header, pose=Pose(Point(2.0, 0.0, 0.3))), "odom")
    assert (pose.header.frame_id, pose.pose.position.z) == ("odom", 0.3)
    assert tuple(pose.pose.to_planar()) == pytest.approx((1.0, 2.0, math.pi / 2))
    point = buffer.transform(PointStamped(header=header, point=Point(0.0, 1.0)), "odom").point
    assert (point.x, point.y) == pytest.approx((0.0, 0.0))
    assert do_transform_pose(Pose(), link("a", "b", 0.0, 1.0, 2.0)).position == Point(1.0, 2.0)


class Watcher(Node):
    def __init__(self) -> None:
        super().__init__("watcher")
        self.buffer = SameBuffer()
        self.listener = TransformListener(self.buffer, self)


def test_a_node_follows_the_robot_and_its_buffer_is_restored():
    sim = small_room()
    node = sim.spawn(Watcher)
    sim.run_for(1.0)
    saved, before = sim.save(), node.buffer.lookup_transform("odom", "base_link", Instant())
    sim.run_for(20.0)
    assert node.buffer.lookup_transform("odom", "base_link", Instant()).header.stamp.sec >= 20
    sim.restore(saved)
    assert node.buffer.lookup_transform("odom", "base_link", Instant()) == before
    sim.run_for(1.0)
    assert 1 < node.buffer.lookup_transform("odom", "base_link", Instant()).header.stamp.nanoseconds / 1e9 <= 2.0


def test_broadcasters_send_what_a_listener_stores():
    sim = small_room()
    talker, watcher = sim.create_node("talker"), None
    static = StaticTransformBroadcaster(talker)
    static.sendTransform(link("base_link", "camera", 0.0, 0.1))
    static.sendTransform([link("base_link", "arm", 0.0, 0.2)])
    sim.run_for(0.1)
    watcher = sim.spawn(Watcher)
    TransformBroadcaster(talker).sendTransform(link("camera", "ball", 0.1, 2.0))
    sim.run_for(0.1)
    assert tuple(at(watcher.buffer, "base_link", "ball", 0.0)) == pytest.approx((2.1, 0.0, 0.0))
    assert tuple(at(watcher.buffer, "arm", "camera", 0.0)) == pytest.approx((-0.1, 0.0, 0.0))
    watcher.listener.unregister()
    TransformBroadcaster(talker).sendTransform(link("camera", "cup", 0.1, 2.0))
    sim.run_for(0.1)
    assert not watcher.buffer.can_transform("camera", "cup", Instant())


def test_a_late_listener_receives_the_transforms_of_all_static_broadcasters():
    sim = small_room()
    for name in ("camera", "arm", "antenna"):
        StaticTransformBroadcaster(sim.create_node(f"{name}_frame")).sendTransform(link("base_link", name, 0.0, 0.1))
    sim.run_for(1.0)
    watcher = sim.spawn(Watcher)
    sim.run_for(0.1)
    for name in ("camera", "arm", "antenna"):
        assert watcher.buffer.can_transform("base_link", name, Instant()), name


def test_heights_roll_and_pitch_count(buffer):
    """A camera 0.5 m above the base looks straight down: its x axis points to the floor, as after a pitch of 90 degrees."""
    half = math.sqrt(0.5)
    camera = TransformStamped(
        Header(frame_id="base"), "camera", Transform(Vector3(0.2, 0.0, 0.5), Quaternion(y=half, w=half))
    )
    buffer.set_transform_static(camera)
    seen = PointStamped(header=Header(Time(1, 0), "camera"), point=Point(0.5, 0.1, 0.3))
    on_floor = buffer.transform(seen, "base").point
    assert (on_floor.x, on_floor.y, on_floor.z) == pytest.approx((0.5, 0.1, 0.0))
    in_odom = buffer.transform(seen, "odom").point
    assert (in_odom.x, in_odom.y, in_odom.z) == pytest.approx((0.9, 0.5, 0.0))
    pose = buffer.transform(PoseStamped(header=seen.header), "odom").pose
    assert pose.position.z == 0.5 and pose.orientation.x == pytest.approx(-0.5)
    down = buffer.transform(Vector3Stamped(header=seen.header, vector=Vector3(2.0, 0.0, 0.0)), "odom").vector
    assert (down.x, down.y, down.z) == pytest.approx((0.0, 0.0, -2.0))
    with pytest.raises(TypeError, match=r"transforms PointStamped, PoseStamped, Vector3Stamped, got Twist"):
        buffer.transform(mrs.messages.Twist(), "odom")
