"""audit_bag: whether the scans, odometry, poses and transforms of a bag keep the conventions of ROS."""

from __future__ import annotations

import math
import os
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..logs.frames import name_of, stamp_of
from ..messages import LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped, TFMessage
from .findings import Finding, Findings
from .odometry import OdometryRules
from .poses import check_covariance, check_frames, check_pose
from .scans import check_scan
from .stamps import Stamps
from .transforms import TransformRules

_TYPES = tuple(kind.ros_type for kind in (LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped, TFMessage))


@dataclass(frozen=True)
class Audit:
    """Result of an audit.

    Attributes:
        path: The bag.
        counts: Number of messages that were checked, by topic.
        findings: What breaks a rule, by topic and first index.
    """

    path: Path
    counts: dict[str, int]
    findings: list[Finding]


def audit_bag(path: str | os.PathLike[str]) -> Audit:
    """Checks whether the scans, odometry, poses and transforms of a bag keep the conventions of ROS. See `RULES`.

    Args:
        path: A ROS 1 bag, an MCAP or SQLite file of ROS 2, the folder of a ROS 2 bag, or the folder given to `run --out`.

    Raises:
        ImportError: rosbags is not installed.
        OSError: The bag cannot be read.
        ValueError: The file is not a bag, or a message is damaged. The message of the error gives the topic and the index.
    """
    from ..recording.bag import Bag

    bag = Bag(Path(path))
    audit = _Auditor()
    for message in bag.messages(_TYPES):
        audit.take(message.topic, message.ros_type, message.index, message.time_ns, message.content)
    for note in bag.notes:
        audit.findings.add("bag-end", "(bag)", 0, note)
    audit.finish()
    return Audit(bag.path, dict(sorted(audit.counts.items())), audit.findings.sorted())


class _Auditor:
    """Checks messages one after another, and what needs all of them at the end."""

    def __init__(self) -> None:
        self.findings, self.counts = Findings(), Counter[str]()
        self._transforms = TransformRules()
        self._stamps: dict[str, Stamps] = {}
        self._frames: dict[str, dict[str, str]] = {}
        self._first_scans: dict[str, Any] = {}
        self._scans: list[tuple[str, int, str, int]] = []
        self._odometry: dict[str, OdometryRules] = {}
        self._odometry_messages: list[tuple[str, int, Any]] = []

    def take(self, topic: str, ros_type: str, index: int, time_ns: int, content: Any) -> None:
        """Checks a message."""
        self.counts[topic] += 1
        if ros_type == TFMessage.ros_type:
            self._transforms.add(self.findings, topic, index, content)
            return
        stamp = stamp_of(content.header)
        self._stamps.setdefault(topic, Stamps(topic)).add(self.findings, index, stamp, time_ns)
        names = {"frame_id": str(content.header.frame_id)}
        if ros_type == Odometry.ros_type:
            names["child_frame_id"] = str(content.child_frame_id)
        check_frames(self.findings, topic, index, names)
        before = self._frames.setdefault(topic, names)
        if names != before:
            shown = " and ".join(f"{name} {names[name]!r}, {before[name]!r} in message 0" for name in names)
            self.findings.add("frame-change", topic, index, shown)
        if ros_type == LaserScan.ros_type:
            first = self._first_scans.setdefault(topic, content)
            check_scan(self.findings, topic, index, content, first)
            self._scans.append((topic, index, name_of(names["frame_id"]), stamp))
        elif ros_type == PoseStamped.ros_type:
            check_pose(self.findings, topic, index, content.pose.position, content.pose.orientation)
        else:
            self._take_covariance(topic, ros_type, index, stamp, content)

    def _take_covariance(self, topic: str, ros_type: str, index: int, stamp: int, content: Any) -> None:
        pose = content.pose.pose
        is_pose = check_pose(self.findings, topic, index, pose.position, pose.orientation)
        check_covariance(self.findings, topic, index, "pose.covariance", content.pose.covariance)
        if ros_type != Odometry.ros_type:
            return
        check_covariance(self.findings, topic, index, "twist.covariance", content.twist.covariance)
        linear, angular = content.twist.twist.linear, content.twist.twist.angular
        numbers = [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
        if not all(map(math.isfinite, numbers)):
            self.findings.add("not-finite", topic, index, f"twist {' '.join(f'{number:g}' for number in numbers)}")
        if is_pose:
            self._odometry.setdefault(topic, OdometryRules(topic)).add(index, stamp, content)
            self._odometry_messages.append((topic, index, content))

    def finish(self) -> None:
        """Checks what needs all messages."""
        if not self._scans:
            self.findings.add("scan-missing", "(bag)", 0, "none")
        for stamps in self._stamps.values():
            stamps.finish(self.findings)
        for scan in self._scans:
            self._transforms.check_scan(self.findings, *scan)
        for message in self._odometry_messages:
            self._transforms.check_odometry(self.findings, *message)
        for rules in self._odometry.values():
            rules.finish(self.findings)
        robots = {frame for _, _, frame, _ in self._scans}
        robots |= {name_of(odometry.child_frame_id) for _, _, odometry in self._odometry_messages}
        self._transforms.finish(self.findings, robots)
