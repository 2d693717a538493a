"""RobotOutput: times and contents of odometry, transforms, the clock and the ground truth."""

from __future__ import annotations

import math

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from robot_rigs import SECOND, Rig, close, twist
from simulations import drive, simulation


def test_odometry_field_by_field() -> None:
    rig = Rig()
    rig.command(1.0, 0.5, 0.2)
    rig.run_to(0.1)
    (odometry,) = rig.all("/odom")
    expected = mrs.Pose().integrate((1.0, 0.5, 0.2), 0.1)
    assert odometry.header == mrs.messages.Header(mrs.messages.Time(0, 100_000_000), "odom")
    assert odometry.child_frame_id == "base_link"
    position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
    assert (position.x, position.y, position.z) == (expected.x, expected.y, 0.0)
    assert (orientation.x, orientation.y) == (0.0, 0.0)
    assert (orientation.z, orientation.w) == pytest.approx((math.sin(0.01), math.cos(0.01)), abs=1e-15)
    # The twist is in the child frame.
    assert odometry.twist.twist == twist(1.0, 0.5, 0.2)


def test_covariances_are_small_in_the_plane_and_large_elsewhere() -> None:
    rig = Rig()
    rig.run_to(0.1)
    (odometry,) = rig.all("/odom")
    for covariance in (odometry.pose.covariance, odometry.twist.covariance):
        assert covariance.shape == (36,) and covariance.dtype == np.float64
        matrix = np.asarray(covariance).reshape(6, 6)
        assert np.array_equal(matrix, matrix.T)
        assert (np.linalg.eigvalsh(matrix) > 0.0).all()
        known, unknown = np.diag(matrix)[[0, 1, 5]], np.diag(matrix)[[2, 3, 4]]
        assert known.max() < 1e-6 < 1.0 <= unknown.min()


def test_transforms_field_by_field() -> None:
    rig = Rig()
    rig.command(1.0)
    rig.run_to(0.1)
    (message,) = rig.all("/tf")
    (transform,) = message.transforms
    assert transform.header == mrs.messages.Header(mrs.messages.Time(0, 100_000_000), "odom")
    assert transform.child_frame_id == "base_link"
    translation, rotation = transform.transform.translation, transform.transform.rotation
    assert (translation.x, translation.y, translation.z) == (0.1, 0.0, 0.0)
    assert (rotation.x, rotation.y, rotation.z, rotation.w) == (0.0, 0.0, 0.0, 1.0)


def test_transforms_agree_with_odometry() -> None:
    rig = Rig(publish_map_transform=True)
    rig.drive(5.0, 0.7, -0.1, 0.9)
    for odometry, message in zip(rig.all("/odom"), rig.all("/tf"), strict=True):
        link = {transform.child_frame_id: transform for transform in message.transforms}["base_link"]
        assert link.header == odometry.header
        position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
        assert (link.transform.translation.x, link.transform.translation.y) == (position.x, position.y)
        assert link.transform.rotation == orientation


def test_the_map_transform_is_published_if_the_parameter_is_set() -> None:
    rig = Rig(publish_map_transform=True, start_pose=mrs.Pose(3.0, 4.0, 1.0))
    rig.run_to(0.1)
    (message,) = rig.all("/tf")
    links = {transform.child_frame_id: transform for transform in message.transforms}
    assert set(links) == {"odom", "base_link"}
    assert links["odom"].header == mrs.messages.Header(mrs.messages.Time(0, 100_000_000), "map")
    map_from_odom, odom_from_base = links["odom"].transform.to_planar(), links["base_link"].transform.to_planar()
    close(map_from_odom * odom_from_base, 3.0, 4.0, 1.0)
    close(odom_from_base, 0.0, 0.0, 0.0)


def test_names_are_parameters() -> None:
    rig = Rig(
        odometry_topic="/robot/odom",
        velocity_topic="/robot/cmd_vel",
        base_link_frame="base_footprint",
        odom_frame_id="robot/odom",
        map_frame_id="world",
        publish_map_transform=True,
    )
    rig.node.create_publisher(mrs.messages.Twist, "/robot/cmd_vel").publish(twist(1.0))
    rig.run_to(0.1)
    (odometry,) = rig.all("/robot/odom")
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("robot/odom", "base_footprint")
    assert odometry.pose.pose.position.x == 0.1
    (message,) = rig.all("/tf")
    pairs = {(transform.header.frame_id, transform.child_frame_id) for transform in message.transforms}
    assert pairs == {("world", "robot/odom"), ("robot/odom", "base_footprint")}


@pytest.mark.parametrize("rate", [1.0, 10.0, 30.0, 7.0, 250.0])
def test_stamps_and_rates(rate: float) -> None:
    rig = Rig(publish_rate=rate)
    rig.run_to(4.0)
    expected = [round(count / rate * SECOND) for count in range(1, round(4 * rate) + 1)]
    assert [message.clock.nanoseconds for message in rig.all("/clock")] == expected
    assert [message.header.stamp.nanoseconds for message in rig.all("/odom")] == expected
    assert [message.transforms[0].header.stamp.nanoseconds for message in rig.all("/tf")] == expected
    assert [time_ns for topic, _, time_ns in rig.sent if topic == "/odom"] == expected


def test_the_ground_truth_is_the_true_pose_and_velocity_in_the_map() -> None:
    rig = Rig(start_pose=mrs.Pose(3.0, 4.0, 1.0), odometry_alphas=(0.1,) * 6, ground_truth_frame="truth", frame_prefix="a/")
    rig.robot.slip(0.5)
    rig.command(1.0, 0.0, 0.5)
    rig.run_to(0.3)
    truth, odometry = rig.all("/ground_truth")[-1], rig.all("/odom")[-1]
    assert (truth.header.stamp, truth.header.frame_id) == (odometry.header.stamp, "map")
    assert truth.child_frame_id == odometry.child_frame_id == "a/base_link"
    expected = mrs.Pose(3.0, 4.0, 1.0).integrate((0.5, 0.0, 0.25), 0.3)
    close(truth.pose.pose.to_planar(), *expected)
    assert (truth.twist.twist.linear.x, truth.twist.twist.angular.z) == (0.5, 0.25)
    assert truth.pose.covariance[0] == truth.twist.covariance[0] == 1e-9
    assert odometry.pose.pose.to_planar() != truth.pose.pose.to_planar()
    (link,) = [link for link in rig.all("/tf")[-1].transforms if link.child_frame_id == "a/truth"]
    assert link.header == truth.header
    close(link.transform.to_planar(), *expected)


def test_without_a_topic_and_a_frame_there_is_no_ground_truth() -> None:
    rig = Rig(ground_truth_topic="")
    rig.run_to(0.3)
    assert "/ground_truth" not in rig.bus.topic_names()
    assert {link.child_frame_id for link in rig.all("/tf")[-1].transforms} == {"base_link"}


def test_all_frames_except_the_maps_get_the_prefix() -> None:
    rig = Rig(frame_prefix="a/", publish_map_transform=True, odom_frame_id="/odom")
    rig.run_to(0.1)
    (odometry,), (transforms,) = rig.all("/odom"), rig.all("/tf")
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("a/odom", "a/base_link")
    links = [(link.header.frame_id, link.child_frame_id) for link in transforms.transforms]
    assert links == [("map", "a/odom"), ("a/odom", "a/base_link")]


def test_a_restored_robot_tells_of_the_same_contact_again() -> None:
    sim = simulation((1.0, 2.0, math.pi), robot_radius=0.3, contact_topic="contacts", stalled_topic="stalled")
    drive(sim, 1.0)
    sim.run_for(0.3)
    told: list[tuple[str, object]] = []
    sim.record(lambda topic, message, _: told.append((topic, message)) if topic in ("/contacts", "/stalled") else None)
    saved, runs = sim.save(), []
    for _ in range(2):
        sim.restore(saved)
        told.clear()
        sim.run_for(1.0)
        runs.append(list(told))
    assert [topic for topic, _ in runs[0]] == ["/contacts", "/stalled"] and runs[0] == runs[1]
