"""bag_scans: scans of recordings of the simulator, with the poses that the simulation had."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

from logs.bags import Recorded, changed, drive, messages, mounted, record
from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.logs import read_log
from mobile_robot_simulator.recording.recorder import Format
from recordings import FORMATS


def true_poses(stamps: np.ndarray) -> np.ndarray:
    truth = drive()[1].truth
    return np.array([tuple(truth.pose_at(stamp / 1e9)) for stamp in stamps])


def on_laser(recorded: list[Recorded]) -> list[Recorded]:
    for topic, message, _ in recorded:
        if topic == "/scan":
            message.header.frame_id = "laser"
    return recorded


@pytest.mark.parametrize("format", FORMATS)
def test_scans_and_poses_are_those_of_the_simulation(tmp_path: Path, format: Format) -> None:
    log = read_log(record(tmp_path / "bag", messages(), format))
    scans = [message for topic, message, _ in messages() if topic == "/scan"]
    assert log.ranges.tobytes() == np.array([scan.ranges for scan in scans]).tobytes()
    assert log.stamps.tolist() == [scan.header.stamp.nanoseconds for scan in scans]
    assert log.places.tolist() == list(range(len(scans)))
    np.testing.assert_allclose(log.poses, true_poses(log.stamps), atol=1e-9)
    np.testing.assert_allclose(log.angles, drive()[1].laser.scanner.angles, atol=1e-6)
    assert (log.frame, log.max_range, log.notes) == ("map", 30.0, ())


def test_scans_cast_from_the_log_are_those_in_it(tmp_path: Path) -> None:
    log = read_log(record(tmp_path / "bag", messages()))
    scanner, grid = drive()[1].laser.scanner, drive()[1].grid
    simulated = scanner.mark_invalid(scanner.scan_batch(grid, log.poses))
    np.testing.assert_allclose(simulated, log.ranges, atol=1e-5)


def test_the_pose_between_two_transforms_is_interpolated(tmp_path: Path) -> None:
    recorded = messages()
    for message in [message for topic, message, _ in recorded if topic == "/tf"][1::2]:
        message.transforms = [each for each in message.transforms if each.child_frame_id != "base_link"]
    log = read_log(record(tmp_path / "bag", recorded))
    assert len(log.poses) >= 29
    np.testing.assert_allclose(log.poses, true_poses(log.stamps), atol=1.3e-3)  # the way between is an arc
    assert np.abs(log.poses - true_poses(log.stamps)).max() > 1e-6


def test_a_static_mount_is_part_of_the_pose(tmp_path: Path) -> None:
    recorded = [("/tf_static", mounted(0.3, 0.1, 1.0), 1), *on_laser(messages())]
    log = read_log(record(tmp_path / "bag", recorded))
    place = drive()[1].truth.pose_at(log.stamps[4] / 1e9) * (0.3, 0.1, 1.0)
    np.testing.assert_allclose(log.poses[4], tuple(place), atol=1e-9)


def test_a_scanner_upside_down_turns_the_other_way(tmp_path: Path) -> None:
    mount = mounted(0.0, 0.0, 0.0)
    mount.transforms[0].transform.rotation = ros.Quaternion(1.0, 0.0, 0.0, 0.0)
    log = read_log(record(tmp_path / "bag", [("/tf_static", mount, 1), *on_laser(messages())]))
    np.testing.assert_allclose(log.angles, -drive()[1].laser.scanner.angles, atol=1e-6)
    np.testing.assert_allclose(log.poses, true_poses(log.stamps), atol=1e-9)


def test_a_tilted_scanner_is_refused(tmp_path: Path) -> None:
    mount = mounted(0.0, 0.0, 0.0)
    mount.transforms[0].transform.rotation = ros.Quaternion(0.1, 0.0, 0.0, 1.0)
    with pytest.raises(ValueError, match="/scan, message 0: the scanner must be level or upside down"):
        read_log(record(tmp_path / "bag", [("/tf_static", mount, 1), *on_laser(messages())]))


def test_poses_of_the_odometry_without_transforms(tmp_path: Path) -> None:
    recorded = [each for each in messages() if each[0] != "/tf"]
    log = read_log(record(tmp_path / "bag", recorded))
    odometry = [message.pose.pose.to_planar() for topic, message, _ in recorded if topic == "/odom"]
    assert log.frame == "odom" and log.notes == ()
    np.testing.assert_allclose(log.poses, [tuple(pose) for pose in odometry], atol=1e-9)


@pytest.mark.parametrize("kind", [ros.PoseStamped, ros.PoseWithCovarianceStamped])
def test_poses_of_a_topic_with_the_mount_of_the_transforms(tmp_path: Path, kind: type) -> None:
    recorded: list[Recorded] = [("/tf_static", mounted(0.3, 0.0, 0.0), 1)]
    for topic, message, time_ns in on_laser(messages()):
        recorded.append((topic, message, time_ns))
        if topic == "/scan":
            pose = ros.Pose(ros.Point(7.0, 8.0), ros.Quaternion(z=math.sin(0.5), w=math.cos(0.5)))
            header = ros.Header(message.header.stamp, "world")
            recorded.append(
                ("/pose", kind(header, pose if kind is ros.PoseStamped else ros.PoseWithCovariance(pose)), time_ns)
            )
    log = read_log(record(tmp_path / "bag", recorded), pose_topic="/pose")
    expected = [7.0 + 0.3 * math.cos(1.0), 8.0 + 0.3 * math.sin(1.0), 1.0]
    np.testing.assert_allclose(log.poses, np.tile(expected, (len(log.poses), 1)), atol=1e-12)
    assert log.frame == "world" and log.notes == ()


def test_an_unknown_mount_is_said(tmp_path: Path) -> None:
    recorded = on_laser([each for each in messages() if each[0] != "/tf"])
    note = "no transform says where the scanner 'laser' is on the robot, so it is at the robot's origin"
    assert read_log(record(tmp_path / "bag", recorded)).notes == (note,)


def test_scans_without_a_pose_and_with_other_beams_are_said(tmp_path: Path) -> None:
    def shorten(scan: ros.LaserScan) -> None:
        scan.ranges = scan.ranges[:-1]

    recorded = [each for each in changed("/scan", shorten) if each[0] != "/tf" or not 10 < each[2] / 1e8 < 25]
    log = read_log(record(tmp_path / "bag", recorded))
    assert len(log.ranges) + 1 + 14 == 30 and not {7, 10, 20} & set(log.places.tolist())
    assert log.notes == (
        "/scan: 1 scans with other beams were passed over, the first is message 7",
        "/scan: 14 scans without a pose were passed over, the first is message 10",
    )


def test_topics_that_are_missing(tmp_path: Path) -> None:
    bag = record(tmp_path / "bag", messages())
    with pytest.raises(ValueError, match=r"must have the topic /lidar with scans \(LaserScan\), got /scan"):
        read_log(bag, scanner="/lidar")
    with pytest.raises(ValueError, match=r"must have the topic /amcl_pose with poses.*got /odom"):
        read_log(bag, pose_topic="/amcl_pose")
    assert len(read_log(bag, scanner="scan").ranges) == 30
    without = record(tmp_path / "without", [each for each in messages() if each[0] != "/scan"])
    with pytest.raises(ValueError, match=r"must have one topic of scans \(LaserScan\), got none"):
        read_log(without)


def test_a_second_parent_is_an_error(tmp_path: Path) -> None:
    def rename(message: ros.TFMessage) -> None:
        message.transforms[0].header.frame_id = "elsewhere"

    with pytest.raises(ValueError, match="/tf, message 7: a frame must have one parent, got elsewhere"):
        read_log(record(tmp_path / "bag", changed("/tf", rename)))
