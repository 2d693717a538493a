"""TransformRules: rules for the transforms of a bag, and for what scans and odometry need of them."""

from __future__ import annotations

from typing import Any

from .._core import Pose
from ..logs.frames import STATIC_TOPIC, Frames, name_of, stamp_of
from ..nodes.rigid_transform import RigidTransform
from .findings import Findings
from .poses import check_frames, check_pose
from .stamps import Stamps

LARGEST_DISTANCE = 1e-3
"""Largest distance between an odometry message and its transform [m and rad]."""


class TransformRules:
    """Checks transforms as they come, and scans and odometry against them at the end."""

    def __init__(self) -> None:
        self._frames = Frames()
        self._stamps: dict[tuple[str, str], Stamps] = {}
        self._poses: dict[tuple[str, str, int], RigidTransform] = {}
        self._span: dict[str, tuple[int, int]] = {}

    def add(self, findings: Findings, topic: str, index: int, message: Any) -> None:
        """Checks the transforms of a message, and keeps them.

        Args:
            findings: Where findings go.
            topic: Topic of the message.
            index: Its position among the messages of the topic.
            message: A TFMessage.
        """
        is_static = topic == STATIC_TOPIC
        for transform in message.transforms:
            names = {"frame_id": str(transform.header.frame_id), "child_frame_id": str(transform.child_frame_id)}
            check_frames(findings, topic, index, names)
            moved, turned = transform.transform.translation, transform.transform.rotation
            parent, child, stamp = name_of(names["frame_id"]), name_of(names["child_frame_id"]), stamp_of(transform.header)
            if not check_pose(findings, topic, index, moved, turned) or not parent or not child or parent == child:
                continue
            known = self._frames.parents.get(child, parent)
            if known != parent:
                findings.add("tf-parents", topic, index, f"{parent} and {known} are parents of {child}")
                continue
            if child not in self._frames.parents and self._frames.has_above(parent, child):
                findings.add("tf-loop", topic, index, f"{parent} is above {child}, and below it")
                continue
            pose = RigidTransform.from_message(moved, turned)
            self._frames.add_pose(parent, child, stamp, pose, static=is_static)
            if not is_static:
                self._stamps.setdefault((topic, child), Stamps(topic, f"{parent} -> {child}")).add(findings, index, stamp)
                self._poses[parent, child, stamp] = pose
                first, last = self._span.get(child, (stamp, stamp))
                self._span[child] = min(first, stamp), max(last, stamp)

    def check_scan(self, findings: Findings, topic: str, index: int, frame: str, stamp: int) -> None:
        """Checks, once all transforms are known, that they lead up from a scan's frame at its stamp.

        A scan before the first transform or after the last one is none to speak of: recordings begin and end somewhere.

        Args:
            findings: Where findings go.
            topic: Topic of the scan.
            index: Its position among the messages of the topic.
            frame: The scan's frame.
            stamp: Its stamp [ns].
        """
        if frame not in self._frames.parents:
            findings.add("tf-scan", topic, index, f"no transform has the child {frame!r}")
            return
        robot = self._frames.base_of(frame)
        if robot not in self._span:
            findings.add("tf-scan", topic, index, f"no transform on /tf has the child {robot!r}")
            return
        first, last = self._span[robot]
        if first <= stamp <= last and self._frames.pose(self._frames.parents[robot], frame, stamp) is None:
            findings.add("tf-scan", topic, index, f"no transforms of {robot!r} within 1 s around the stamp")

    def check_odometry(self, findings: Findings, topic: str, index: int, odometry: Any) -> None:
        """Checks, once all transforms are known, that the transform of an odometry message's stamp is its pose.

        Args:
            findings: Where findings go.
            topic: Topic of the message.
            index: Its position among the messages of the topic.
            odometry: The message, with a finite pose.
        """
        names = name_of(odometry.header.frame_id), name_of(odometry.child_frame_id)
        pose = self._poses.get((*names, stamp_of(odometry.header)))
        if pose is None:
            return
        at, turned = odometry.pose.pose.position, odometry.pose.pose.orientation
        (x, y, _), (qx, qy, qz) = pose.translation, pose.vector
        transformed = Pose.from_quaternion(x, y, qx=qx, qy=qy, qz=qz, qw=pose.w)
        said = Pose.from_quaternion(at.x, at.y, qx=turned.x, qy=turned.y, qz=turned.z, qw=turned.w)
        if max(map(abs, transformed.inverse() * said)) > LARGEST_DISTANCE:
            shown = [" ".join(f"{number:.6g}" for number in each) for each in (transformed, said)]
            findings.add("odometry-tf", topic, index, f"{' -> '.join(names)} at {shown[0]}, the odometry at {shown[1]}")

    def finish(self, findings: Findings, robots: set[str]) -> None:
        """Checks for gaps, once all transforms are known.

        Args:
            findings: Where findings go.
            robots: Frames of scans and of odometry. The first one above each that moves is the robot's.
        """
        moving = {self._frames.base_of(frame) for frame in robots}
        for (_, child), stamps in self._stamps.items():
            if child in moving:
                stamps.finish(findings, "tf-gap")
