"""Playback: robots, scans and maps at any time are those that the simulation had."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

from logs.bags import Recorded, changed, drive, messages, mounted, record
from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.logs.playback import Playback
from mobile_robot_simulator.recording.recorder import Format
from recordings import FORMATS
from simulations import hall, mrs, pair, twist

SECOND = 10**9


def recorded_of(simulation: mrs.Simulation, run: Callable[[mrs.Simulation], object]) -> list[Recorded]:
    recorded: list[Recorded] = []
    simulation.record(lambda topic, message, time_ns: recorded.append((topic, ros.copied(message), time_ns)))
    run(simulation)
    return recorded


def without(*topics: str) -> list[Recorded]:
    return [each for each in messages() if each[0] not in topics]


@pytest.mark.parametrize("format", FORMATS)
def test_a_drive_is_played_as_it_was(tmp_path: Path, format: Format) -> None:
    simulation = drive()[1]
    playback = Playback(record(tmp_path / "bag", messages(), format))
    assert (playback.frame, playback.robots, playback.scanners) == ("map", [""], {"/scan": ""})
    assert (playback.begin_ns, playback.end_ns, playback.notes) == (SECOND // 10, 3 * SECOND, [])
    for time_ns in (SECOND // 10, SECOND, 3 * SECOND):
        robot = playback.robot_at("", time_ns)
        assert robot is not None
        assert tuple(robot.pose) == pytest.approx(tuple(simulation.truth.pose_at(time_ns / SECOND)), abs=1e-9)
        assert tuple(robot.believed) == pytest.approx(tuple(robot.pose), abs=1e-9)
        assert robot.velocity == (0.6, 0.0, 0.4)
    grid = playback.map_at(0)
    assert grid is not None and grid is playback.map_at(2 * SECOND)
    assert np.array_equal(grid.cells, simulation.grid.cells) and grid.resolution == simulation.grid.resolution


def test_every_scan_is_there_in_any_order_of_times(tmp_path: Path) -> None:
    scans = [message for topic, message, _ in messages() if topic == "/scan"]
    playback = Playback(record(tmp_path / "bag", messages()))
    order = np.random.default_rng(1).permutation(len(scans))
    for index in order:
        played = playback.scan_at("/scan", scans[index].header.stamp.nanoseconds)
        assert played is not None and played.stamp_ns == scans[index].header.stamp.nanoseconds
        assert played.ranges.tobytes() == scans[index].ranges.tobytes()
        truth = drive()[1].truth.pose_at(played.stamp_ns / SECOND)
        assert tuple(played.base) == pytest.approx(tuple(truth), abs=1e-9)
    assert playback.scan_at("/scan", scans[0].header.stamp.nanoseconds - 1) is None
    between = playback.scan_at("/scan", scans[3].header.stamp.nanoseconds + 1)
    assert between is not None and between.stamp_ns == scans[3].header.stamp.nanoseconds


def test_the_end_points_of_a_scan_are_on_the_walls(tmp_path: Path) -> None:
    """The inner faces of the walls of the hall are at 0.1 m and 19.9 m."""
    playback = Playback(record(tmp_path / "bag", messages()))
    scan = playback.scan_at("/scan", 2 * SECOND)
    assert scan is not None
    points = scan.scanner.end_points(scan.base, scan.ranges)
    assert len(points) == 31
    np.testing.assert_allclose(np.abs(points - 10.0).max(axis=1), 9.9, atol=1e-5)


def test_scans_are_read_a_part_at_a_time(tmp_path: Path) -> None:
    simulation = mrs.Simulation(hall(), parameters={"laser_beam_count": 5}, start=(5.0, 5.0, 0.0))
    playback = Playback(record(tmp_path / "bag", recorded_of(simulation, lambda sim: sim.run_for(60.0))))
    for time_ns in (50 * SECOND, 10 * SECOND, 11 * SECOND):
        scan = playback.scan_at("/scan", time_ns)
        assert scan is not None and scan.stamp_ns == time_ns
        assert 0 < len(playback._kept) <= 26  # 10 per second, from half a second before to two after


def test_odometry_that_drifts_leads_away_from_the_true_pose(tmp_path: Path) -> None:
    parameters = {"odometry_alphas": (0.2,) * 6, "velocity_timeout": 0}
    simulation = mrs.Simulation(hall(), parameters=parameters, seed=3, start=(5.0, 6.0, 0.5))
    simulation.publish("/cmd_vel", twist(0.6, 0.0, 0.4))
    recorded = recorded_of(simulation, lambda sim: sim.run_for(5.0))
    playback = Playback(record(tmp_path / "bag", recorded))
    odometry = [message for topic, message, _ in recorded if topic == "/odom"][-1]
    reported, robot = odometry.pose.pose.to_planar(), playback.robot_at("", 5 * SECOND)
    assert robot is not None
    started = next(message for topic, message, _ in recorded if topic == "/tf").transforms
    map_from_odom = next(each for each in started if each.child_frame_id == "odom").transform
    start = mrs.Pose(map_from_odom.translation.x, map_from_odom.translation.y, 2 * math.asin(map_from_odom.rotation.z))
    assert tuple(robot.believed) == pytest.approx(tuple(start * reported), abs=1e-9)
    assert math.hypot(robot.believed.x - robot.pose.x, robot.believed.y - robot.pose.y) > 0.01


def test_several_robots_with_several_scanners(tmp_path: Path) -> None:
    simulation = pair(scanners=("front", "rear"), laser_mount=(0.1, 0.2, 0.3), laser_frame_id="laser")
    simulation.publish("/robot2/cmd_vel", twist(0.5))
    playback = Playback(record(tmp_path / "bag", recorded_of(simulation, lambda sim: sim.run_for(2.0))))
    assert playback.robots == ["robot1", "robot2"]
    assert playback.scanners == {
        f"/{robot}/{scanner}/scan": robot for robot in playback.robots for scanner in ("front", "rear")
    }
    for name in playback.robots:
        robot = playback.robot_at(name, 2 * SECOND)
        assert robot is not None
        assert tuple(robot.pose) == pytest.approx(tuple(simulation.named(name).pose), abs=1e-9)
        scan = playback.scan_at(f"/{name}/rear/scan", 2 * SECOND)
        assert scan is not None and tuple(scan.scanner.mount) == pytest.approx((0.1, 0.2, 0.3), abs=1e-12)


def test_a_bag_without_transforms_is_placed_by_its_odometry(tmp_path: Path) -> None:
    recorded = without("/tf", "/tf_static", "/map")
    for topic, message, _ in recorded:
        if topic == "/scan":
            message.header.frame_id = "laser"
    playback = Playback(record(tmp_path / "bag", recorded))
    assert (playback.frame, playback.robots, playback.map_at(SECOND)) == ("odom", [""], None)
    assert playback.notes == ["no transform says where the scanner 'laser' is, so it is at the robot's origin"]
    odometry = next(message for topic, message, time_ns in recorded if topic == "/odom" and time_ns == SECOND)
    robot, scan = playback.robot_at("", SECOND), playback.scan_at("/scan", SECOND)
    assert robot is not None and scan is not None
    assert robot.pose == robot.believed == scan.base == odometry.pose.pose.to_planar()


def test_a_bag_without_odometry_is_placed_by_its_transforms(tmp_path: Path) -> None:
    recorded = [*without("/odom"), ("/tf_static", mounted(0.1, 0.2, 0.3), 0)]
    for topic, message, _ in recorded:
        if topic == "/scan":
            message.header.frame_id = "laser"
    playback = Playback(record(tmp_path / "bag", recorded))
    robot, scan = playback.robot_at("", SECOND), playback.scan_at("/scan", SECOND)
    assert robot is not None and scan is not None and robot.velocity is None
    assert tuple(robot.pose) == pytest.approx(tuple(drive()[1].truth.pose_at(1.0)), abs=1e-9)
    assert tuple(scan.scanner.mount) == pytest.approx((0.1, 0.2, 0.3), abs=1e-12)


def test_after_its_last_pose_a_robot_stays_and_before_its_first_it_is_not_there(tmp_path: Path) -> None:
    recorded = [each for each in messages() if each[0] in ("/scan", "/map") or SECOND <= each[2] <= 2 * SECOND]
    playback = Playback(record(tmp_path / "bag", recorded))
    assert playback.robot_at("", SECOND - 1) is None
    last, later = playback.robot_at("", 2 * SECOND), playback.robot_at("", 3 * SECOND)
    assert last is not None and later is not None and later.pose == last.pose
    assert playback.scan_at("/scan", SECOND - 1) is None  # there is one, but nobody knows where it was taken
    assert playback.scan_at("/scan", 3 * SECOND) is None


def test_the_map_changes_when_it_did(tmp_path: Path) -> None:
    def run(simulation: mrs.Simulation) -> None:
        simulation.run_for(1.0)
        simulation.set_cells(50, 60, np.full((2, 3), 100, np.int8))
        simulation.run_for(1.0)

    simulation = mrs.Simulation(hall(), start=(5.0, 5.0, 0.0))
    playback = Playback(record(tmp_path / "bag", recorded_of(simulation, run)))
    before, after = playback.map_at(SECOND - 1), playback.map_at(SECOND)
    assert before is not None and after is not None
    assert np.array_equal(before.cells, hall().cells) and np.array_equal(after.cells, simulation.grid.cells)
    again = playback.map_at(0)
    assert again is not None and np.array_equal(again.cells, hall().cells)


def test_the_first_map_holds_from_the_beginning(tmp_path: Path) -> None:
    recorded = [(topic, message, 2 * SECOND if topic == "/map" else time_ns) for topic, message, time_ns in messages()]
    playback = Playback(record(tmp_path / "bag", sorted(recorded, key=lambda each: each[2])))
    grid = playback.map_at(playback.begin_ns)
    assert grid is not None and np.array_equal(grid.cells, hall().cells)


def test_transforms_count_more_than_odometry(tmp_path: Path) -> None:
    recorded = messages()
    for topic, message, _ in recorded:
        if topic == "/odom":
            message.pose.pose.position.x += 5.0
    robot = Playback(record(tmp_path / "bag", recorded)).robot_at("", SECOND)
    assert robot is not None
    assert tuple(robot.pose) == pytest.approx(tuple(drive()[1].truth.pose_at(1.0)), abs=1e-9)


def test_a_velocity_that_is_no_number_is_not_known(tmp_path: Path) -> None:
    recorded = changed("/odom", lambda odometry: setattr(odometry.twist.twist.angular, "z", math.nan), 9)
    playback = Playback(record(tmp_path / "bag", recorded))
    velocities = [getattr(playback.robot_at("", time_ns), "velocity", "nothing") for time_ns in (SECOND - 1, SECOND)]
    assert velocities == [(0.6, 0.0, 0.4), None]


def test_a_bag_without_an_end_is_played_and_noted(tmp_path: Path) -> None:
    path = record(tmp_path / "bag", messages()) / "recording.mcap"
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:-100])
    playback = Playback(cut)
    assert len(playback.notes) == 1 and "has no end" in playback.notes[0]
    for time_ns in (3 * SECOND, SECOND):
        scan = playback.scan_at("/scan", time_ns)
        assert scan is not None and scan.stamp_ns == time_ns
    assert len(playback._kept) == len([each for each in messages() if each[0] == "/scan"])  # it has no index


def test_a_scanner_that_stands_still(tmp_path: Path) -> None:
    fixed = ros.TFMessage([ros.TransformStamped(ros.Header(frame_id="map"), "tower")])
    fixed.transforms[0].transform.translation.x = 2.0
    scan = ros.LaserScan(ros.Header(ros.Time(1), "tower"), angle_increment=0.1, range_max=5.0)
    scan.ranges = np.array([1.0, 2.0], np.float32)
    playback = Playback(record(tmp_path / "bag", [("/tf_static", fixed, 0), ("/scan", scan, SECOND)]))
    played = playback.scan_at("/scan", SECOND)
    assert played is not None and playback.frame == "map"
    np.testing.assert_allclose(played.scanner.end_points(played.base, played.ranges)[0], (3.0, 0.0), atol=1e-7)


def test_a_bag_with_nothing_to_show_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must have scans, odometry or transforms, got none"):
        Playback(record(tmp_path / "bag", [("/clock", ros.Clock(), 0)]))
    file = tmp_path / "notes.txt"
    file.write_text("hello", encoding="utf-8")
    with pytest.raises(ValueError, match=r"notes\.txt: must be a ROS 1 bag"):
        Playback(file)


@pytest.mark.parametrize(
    ("topic", "change", "reason"),
    [
        (
            "/tf",
            lambda tf: setattr(tf.transforms[0].transform.translation, "x", math.nan),
            "/tf, message 7: a transform",
        ),
        ("/tf", lambda tf: setattr(tf.transforms[-1].header, "frame_id", "elsewhere"), "a frame must have one parent"),
    ],
)
def test_a_wrong_transform_is_refused_with_its_place(
    tmp_path: Path, topic: str, change: Callable[[Any], object], reason: str
) -> None:
    with pytest.raises(ValueError, match=reason):
        Playback(record(tmp_path / "bag", changed(topic, change)))


def test_a_scan_of_no_scanner_is_refused_when_it_is_shown(tmp_path: Path) -> None:
    recorded = changed("/scan", lambda scan: setattr(scan, "range_max", -1.0), 9)
    playback = Playback(record(tmp_path / "bag", recorded))
    assert playback.scan_at("/scan", SECOND - 1) is not None
    with pytest.raises(ValueError, match=r"/scan, stamp 1\.000000000 s: .*max_range"):
        playback.scan_at("/scan", SECOND)
