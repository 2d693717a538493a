"""auditor: a clean bag has no finding, and a bag that breaks one rule has a finding of that rule at that message."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

import mobile_robot_simulator as mrs
from logs.bags import Recorded, changed, messages, mounted, record
from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.audit import RULES, Finding, audit_bag
from mobile_robot_simulator.recording.recorder import Format
from recordings import FORMATS
from simulations import hall

NANOSECONDS = 1_000_000_000


def audit(tmp_path: Path, recorded: list[Recorded]) -> list[Finding]:
    return audit_bag(record(tmp_path / "bag", recorded)).findings


def shown(findings: list[Finding]) -> list[tuple[str, str, list[int]]]:
    return [(each.rule, each.topic, each.indices) for each in findings]


@pytest.mark.parametrize("format", FORMATS)
def test_a_recording_of_the_simulator_has_no_finding(tmp_path: Path, format: Format) -> None:
    result = audit_bag(record(tmp_path, messages(), format))
    assert result.counts == {"/odom": 30, "/scan": 30, "/tf": 30}
    assert result.findings == []


@pytest.mark.parametrize(
    "parameters",
    [
        {"laser_fov": 2 * math.pi, "laser_beam_count": 90},
        {"laser_beam_count": 1},
        {"laser_clockwise": True},
        {"laser_max_range": 3.0, "z_rand": 0.1, "z_short": 0.1},
        {"odometry_alphas": [0.1, 0.1, 0.1, 0.1, 0.1, 0.1]},
        {"publish_rate": 50.0, "laser_frequency": 7.0},
        {"velocity_timeout": 0.3},
    ],
    ids=str,
)
def test_other_settings_of_the_simulator_have_no_finding(tmp_path: Path, parameters: dict[str, Any]) -> None:
    sim = mrs.Simulation(hall(), parameters=parameters, seed=3, start=(10.0, 10.0, 1.0))
    recorded: list[Recorded] = []
    sim.record(lambda topic, message, time_ns: recorded.append((topic, copy.deepcopy(message), time_ns)))
    for step in range(8):
        sim.publish("/cmd_vel", ros.Twist(ros.Vector3(0.5), ros.Vector3(z=0.5 - 0.1 * step)))
        sim.run_for(0.5)
    assert audit(tmp_path, recorded) == []


def set_to(name: str, value: object) -> Callable[[Any], None]:
    """Returns a function that sets a field of a message, given by its path."""

    def change(message: Any) -> None:
        *path, last = name.split(".")
        for part in path:
            message = message[int(part)] if part.isdigit() else getattr(message, part)
        if isinstance(message, np.ndarray):
            message[int(last)] = value
        else:
            setattr(message, last, value)

    return change


TOO_LARGE = (np.eye(6) + 2.0 * np.eye(6)[[1, 0, 2, 3, 4, 5]] * [[1], [1], [0], [0], [0], [0]]).ravel()
"""A covariance whose first two numbers have the correlation 2."""

NEGATIVE = np.diag([1.0, -1.0, 1.0, 1.0, 1.0, 1.0]).ravel()

BROKEN: list[tuple[str, str, str, object, str]] = [
    ("scan-angles", "/scan", "angle_max", math.nan, "angle_max nan"),
    ("scan-count", "/scan", "angle_max", 2.355 + 0.157, "31 ranges for the 32 angles of"),
    ("scan-ranges", "/scan", "ranges.4", 31.0, "1 readings outside 0.05..30; beam 4 has 31"),
    ("scan-ranges", "/scan", "ranges.4", 0.0, "beam 4 has 0"),
    ("scan-ranges", "/scan", "ranges.4", -1.0, "beam 4 has -1"),
    ("scan-intensities", "/scan", "intensities", np.zeros(3, np.float32), "3 intensities for 31 ranges"),
    ("scan-time", "/scan", "time_increment", 0.01, "31 beams, 0.01 s apart, in a scan_time of 0.1 s"),
    ("scan-time", "/scan", "scan_time", -0.1, "scan_time -0.1"),
    ("stamp-zero", "/scan", "header.stamp", ros.Time(), "stamp 0"),
    ("stamp-repeat", "/odom", "header.stamp", ros.Time.from_nanoseconds(7 * NANOSECONDS // 10), "0.7 s again"),
    ("frame-name", "/scan", "header.frame_id", "", "frame_id ''"),
    ("frame-name", "/odom", "child_frame_id", "odom", "frame_id 'odom', child_frame_id 'odom'"),
    ("frame-name", "/tf", "transforms.1.child_frame_id", "/base_link", "child_frame_id '/base_link'"),
    (
        "frame-change",
        "/odom",
        "child_frame_id",
        "base_footprint",
        "child_frame_id 'base_footprint', 'base_link' in message 0",
    ),
    ("quaternion", "/tf", "transforms.1.transform.rotation", ros.Quaternion(w=1.1), "length 1.1"),
    ("quaternion", "/odom", "pose.pose.orientation", ros.Quaternion(w=0.0), "length 0"),
    ("not-finite", "/odom", "pose.pose.position.x", math.nan, "x y z qx qy qz qw nan"),
    ("not-finite", "/odom", "twist.twist.angular.z", math.inf, "twist 0.6 0 0 0 0 inf"),
    ("not-finite", "/tf", "transforms.0.transform.translation.z", math.nan, "nan"),
    ("covariance", "/odom", "pose.covariance", np.zeros(36), "pose.covariance: all 0"),
    ("covariance", "/odom", "twist.covariance", NEGATIVE, "twist.covariance: a variance of -1"),
    ("covariance", "/odom", "pose.covariance.1", 1e-10, "pose.covariance: correlations that differ by 0.1 across"),
    ("covariance", "/odom", "pose.covariance", TOO_LARGE, "pose.covariance: correlations with an eigenvalue of -1"),
    ("covariance", "/odom", "pose.covariance.3", math.nan, "pose.covariance: numbers that are not finite"),
    (
        "odometry-tf",
        "/odom",
        "pose.pose.position.x",
        0.5,
        "base_link at 0.47185 0.0761469 0.32, the odometry at 0.5",
    ),
    ("tf-parents", "/tf", "transforms.1.header.frame_id", "map", "map and odom are parents of base_link"),
]


@pytest.mark.parametrize(("rule", "topic", "field", "value", "got"), BROKEN, ids=lambda value: str(value)[:30])
def test_one_broken_message(tmp_path: Path, rule: str, topic: str, field: str, value: object, got: str) -> None:
    findings = audit(tmp_path, changed(topic, set_to(field, value)))
    found = next(each for each in findings if each.rule == rule)
    assert (found.topic, found.indices, found.count) == (topic, [7], 1)
    assert got in found.got and found.expected == RULES[rule]
    # A wrong angle, frame or quaternion can break another rule too, at the same message or the one after it.
    assert all({*each.indices} <= {7, 8} for each in findings)


def test_limits_that_are_none(tmp_path: Path) -> None:
    findings = audit(tmp_path, changed("/scan", set_to("range_min", 40.0)))
    assert shown(findings) == [("scan-change", "/scan", [7]), ("scan-limits", "/scan", [7])]
    assert findings[1].got == "range_min 40, range_max 30" and findings[0].got == "range_min 40, 0.05 in message 0"


def test_beams_that_change(tmp_path: Path) -> None:
    def shorten(scan: ros.LaserScan) -> None:
        scan.ranges, scan.angle_max = scan.ranges[:-1], scan.angle_max - scan.angle_increment

    findings = audit(tmp_path, changed("/scan", shorten))
    assert shown(findings) == [("scan-change", "/scan", [7])] and findings[0].got == "30 ranges, 31 in message 0"


@pytest.mark.parametrize("value", [30.0, 29.999, 29.9])
def test_no_returns_at_the_largest_range(tmp_path: Path, value: float) -> None:
    def cap(count: int) -> Callable[[ros.LaserScan], None]:
        return lambda scan: scan.ranges.__setitem__(slice(3, 3 + count), value)

    findings = audit(tmp_path, changed("/scan", cap(3)))
    assert shown(findings) == [("scan-no-return", "/scan", [7])]
    assert findings[0].got == f"3 readings of exactly {value:g} with range_max 30, the first is that of beam 3"
    assert audit_bag(record(tmp_path / "two", changed("/scan", cap(2)))).findings == []


@pytest.mark.parametrize("no_return", ["max", "below_max"])
def test_no_returns_of_the_simulator_that_are_numbers(tmp_path: Path, no_return: str) -> None:
    sim = mrs.Simulation(
        hall(), parameters={"no_return": no_return, "laser_max_range": 3.0}, seed=3, start=(10.0, 10.0, 1.0)
    )
    recorded: list[Recorded] = []
    sim.record(lambda topic, message, time_ns: recorded.append((topic, copy.deepcopy(message), time_ns)))
    sim.run_for(1.0)
    assert shown(audit(tmp_path, recorded)) == [("scan-no-return", "/scan", list(range(10)))]


@pytest.mark.parametrize("topic", ["/scan", "/odom"])
def test_stamps_that_go_back_or_are_in_the_future(tmp_path: Path, topic: str) -> None:
    back = audit(tmp_path, changed(topic, set_to("header.stamp", ros.Time(0, 450_000_000))))
    assert ("stamp-back", topic, [7]) in shown(back)
    assert next(each for each in back if each.rule == "stamp-back").got == "0.45 s, 0.25 s before the message before"
    future = audit_bag(record(tmp_path / "b", changed(topic, set_to("header.stamp", ros.Time(2)), index=29))).findings
    assert not {each.rule for each in future} & {"stamp-future"}
    future = audit_bag(record(tmp_path / "c", changed(topic, set_to("header.stamp", ros.Time(9)), index=29))).findings
    assert {("stamp-future", topic, (29,)), ("stamp-jump", topic, (29,))} <= {(r, t, (*i,)) for r, t, i in shown(future)}


def test_a_transform_whose_stamp_goes_back(tmp_path: Path) -> None:
    findings = audit(tmp_path, changed("/tf", set_to("transforms.1.header.stamp", ros.Time(0, 450_000_000))))
    assert shown(findings) == [("stamp-back", "/tf", [7])]
    assert findings[0].got == "odom -> base_link: 0.45 s, 0.25 s before the message before"


@pytest.mark.parametrize("topic", ["/scan", "/odom"])
def test_stamps_that_jump(tmp_path: Path, topic: str) -> None:
    recorded = [each for each in messages() if each[0] != topic or not 10.5e8 < each[2] < 17.5e8]
    findings = audit(tmp_path, recorded)
    assert shown(findings) == [("stamp-jump", topic, [10])]
    assert findings[0].got == "0.8 s after the message before; the usual period is 0.1 s"


@pytest.mark.parametrize(("length", "rules"), [(0.7, ["tf-gap"]), (1.3, ["tf-gap", "tf-scan"])])
def test_transforms_with_a_gap(tmp_path: Path, length: float, rules: list[str]) -> None:
    recorded = [each for each in messages() if each[0] != "/tf" or not 10.5e8 < each[2] < 10.5e8 + length * 1e9]
    findings = audit(tmp_path, recorded)
    assert sorted(each.rule for each in findings) == rules
    gap = next(each for each in findings if each.rule == "tf-gap")
    assert (gap.topic, gap.indices) == ("/tf", [10]) and gap.got.startswith("odom -> base_link: ")
    for each in findings:
        if each.rule == "tf-scan":
            assert (each.topic, each.indices) == ("/scan", list(range(10, 23)))


def test_scans_whose_frame_is_not_in_the_tree(tmp_path: Path) -> None:
    findings = audit(tmp_path, changed("/scan", set_to("header.frame_id", "laser")))
    assert shown(findings) == [("frame-change", "/scan", [7]), ("tf-scan", "/scan", [7])]
    assert findings[1].got == "no transform has the child 'laser'"
    static = [("/tf_static", mounted(0.1, 0.0, 0.0), 1), *(each for each in messages() if each[0] != "/tf")]
    for topic, message, _ in static:
        if topic == "/scan":
            message.header.frame_id = "laser"
    findings = audit_bag(record(tmp_path / "static", static)).findings
    assert shown(findings) == [("tf-scan", "/scan", list(range(30)))]
    assert findings[0].got == "no transform on /tf has the child 'base_link'"


def test_frames_in_a_loop(tmp_path: Path) -> None:
    loop = mounted(0.0, 0.0, 0.0)
    loop.transforms[0].header.frame_id, loop.transforms[0].child_frame_id = "base_link", "map"
    findings = audit(tmp_path, [*messages(), ("/tf_static", loop, 3 * NANOSECONDS)])
    assert shown(findings) == [("tf-loop", "/tf_static", [0])]


@pytest.mark.parametrize(
    ("change", "got"),
    [
        (lambda twist: setattr(twist.angular, "z", -twist.angular.z), "yaw rate -0.4 rad/s where the poses move with 0.4"),
        (lambda twist: setattr(twist.linear, "x", -twist.linear.x), "velocity -0.6 0 m/s where the poses move with 0.6"),
        (lambda twist: setattr(twist, "linear", ros.Vector3(0.0, -0.6)), "velocity 0 -0.6 m/s where"),
        (lambda twist: setattr(twist.angular, "z", math.degrees(twist.angular.z)), "yaw rate 22.9 rad/s where"),
        (lambda twist: setattr(twist.linear, "x", 0.0), "velocity 0 0 m/s where"),
    ],
)
def test_twists_that_are_not_the_motion_of_the_poses(tmp_path: Path, change: Callable[[Any], None], got: str) -> None:
    recorded = messages()
    for topic, message, _ in recorded:
        if topic == "/odom":
            change(message.twist.twist)
    findings = audit(tmp_path, recorded)
    assert shown(findings) == [("odometry-twist", "/odom", list(range(1, 30)))] and got in findings[0].got


def test_poses_of_other_topics(tmp_path: Path) -> None:
    recorded = messages()
    for index in range(12):
        header = ros.Header(ros.Time.from_nanoseconds((index + 1) * NANOSECONDS // 10), "map")
        pose = ros.Pose(ros.Point(1.0), ros.Quaternion(w=1.0 if index != 7 else 0.5))
        covariance = np.eye(6).ravel() * (index != 5)
        wide = ros.PoseWithCovarianceStamped(header, ros.PoseWithCovariance(pose, covariance))
        recorded += [("/goal", ros.PoseStamped(header, pose), header.stamp.nanoseconds)]
        recorded += [("/amcl_pose", wide, header.stamp.nanoseconds)]
    found = shown(audit(tmp_path, sorted(recorded, key=lambda each: each[2])))
    assert found == [("covariance", "/amcl_pose", [5]), ("quaternion", "/amcl_pose", [7]), ("quaternion", "/goal", [7])]


def test_a_bag_without_scans_or_without_an_end(tmp_path: Path) -> None:
    findings = audit(tmp_path, [each for each in messages() if each[0] != "/scan"])
    assert shown(findings) == [("scan-missing", "(bag)", [0])]
    file = record(tmp_path / "cut", messages()) / "recording.mcap"
    file.write_bytes(file.read_bytes()[:-10])
    findings = audit_bag(file).findings
    assert shown(findings) == [("bag-end", "(bag)", [0])] and "complete messages were read" in findings[0].got


def test_every_rule_is_broken_here() -> None:
    text = Path(__file__).read_text(encoding="utf-8")
    assert [rule for rule in RULES if f'"{rule}"' not in text] == []


def test_the_guide_lists_every_rule() -> None:
    guide = (Path(__file__).parents[3] / "docs" / "guides" / "audit.md").read_text(encoding="utf-8")
    rows = [line for line in guide.splitlines() if line.startswith("| `")]
    assert [row.split("`")[1] for row in rows] == list(RULES)
    assert [row.split(" | ")[1].removesuffix(" |").replace("`", "") for row in rows] == list(RULES.values())
