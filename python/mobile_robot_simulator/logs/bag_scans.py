"""Scans of a bag, with poses from its transforms, its odometry or a topic of poses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .._core import Pose
from ..messages import LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped, TFMessage
from ..nodes.rigid_transform import RigidTransform
from .frames import Frames, name_of, stamp_of
from .scan_log import ScanLog, ScanRow

if TYPE_CHECKING:
    from ..recording.bag import BagMessage

TARGETS = ("map", "odom")
"""Frames in which poses are wanted, if the bag has them. Otherwise they are in the topmost frame."""

LARGEST_TILT = 0.02
"""Largest tilt of a scanner that counts as level or upside down, as the sine of the angle."""


def read_bag(path: Path, *, scan_topic: str | None = None, pose_topic: str | None = None) -> ScanLog:
    """Returns the scans of a bag.

    The poses are those of the scans' frame in `map`, or else in `odom`, from the transforms. If no transform leads up from
    that frame, they are those of /odom or of the only topic of poses. With `pose_topic`, they are those of this topic. Then
    transforms say where the scanner is on the robot; without them, it is at the robot's origin.

    Between two poses, the pose is interpolated. Scans without a pose are passed over, and so are scans with other beams than
    the first one. A scanner that is mounted upside down turns the other way, so its angles are negated.

    Args:
        path: The bag, as for `Bag`.
        scan_topic: Topic of the scans. Without it, /scan or the only one.
        pose_topic: Topic of Odometry, PoseStamped or PoseWithCovarianceStamped. Without it, the transforms.

    Raises:
        OSError: The bag cannot be read.
        ValueError: A topic is missing, a message is damaged, no scan has a pose, or the scanner is tilted.
    """
    from ..recording.bag import Bag

    bag = Bag(path)
    frames = Frames()
    scans: dict[str, list[BagMessage]] = {}
    poses: dict[str, list[BagMessage]] = {}
    try:
        for message in bag.messages(_TYPES):
            if message.ros_type == TFMessage.ros_type:
                frames.add(message)
            else:
                (scans if message.ros_type == LaserScan.ros_type else poses).setdefault(message.topic, []).append(message)
    except ValueError as error:
        raise (error if f"{error}".startswith(f"{bag.path}") else ValueError(f"{bag.path}: {error}")) from None
    chosen = scans[_chosen(bag.path, scans, scan_topic, "/scan", "scans (LaserScan)")]
    notes = bag.notes
    frame = name_of(chosen[0].content.header.frame_id)
    if pose_topic is None and frame in frames.parents:
        target = next((each for each in TARGETS if frames.has_above(frame, each)), frames.root_of(frame))
        return _log(bag.path, chosen, target, lambda stamp: frames.pose(target, frame, stamp), notes)
    topic = _chosen(bag.path, poses, pose_topic, "/odom", f"poses, since no transform leads up from frame {frame!r}")
    target, robot = _add_poses(bag.path, frames, poses[topic])
    base = robot if frames.has_above(frame, robot) else frames.base_of(frame)
    mount = frames.pose(base, frame, stamp_of(chosen[0].content.header))
    if mount is None or (frame == base and frame != robot):
        mount = RigidTransform()
        notes.append(f"no transform says where the scanner {frame!r} is on the robot, so it is at the robot's origin")
    fixed = mount

    def pose_at(stamp: int) -> RigidTransform | None:
        pose = frames.pose(target, _ROBOT, stamp)
        return None if pose is None else pose * fixed

    return _log(bag.path, chosen, target, pose_at, notes)


_TYPES = tuple(kind.ros_type for kind in (LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped, TFMessage))
_ROBOT = "the robot of the topic of poses"


def _add_poses(path: Path, frames: Frames, messages: list[BagMessage]) -> tuple[str, str]:
    """Adds a topic of poses. Returns the frame of the poses, and the robot's frame if the topic says it."""
    for message in messages:
        content = message.content
        pose = content.pose if message.ros_type == PoseStamped.ros_type else content.pose.pose
        try:
            placed = RigidTransform.from_message(pose.position, pose.orientation)
            frames.add_pose(name_of(content.header.frame_id), _ROBOT, stamp_of(content.header), placed)
        except ValueError as error:
            raise ValueError(f"{path}: {message.topic}, message {message.index}: {error}") from None
    first = messages[0].content
    return name_of(first.header.frame_id), name_of(getattr(first, "child_frame_id", ""))


def _chosen(path: Path, topics: dict[str, list[BagMessage]], wanted: str | None, usual: str, what: str) -> str:
    if wanted is not None and wanted not in topics and f"/{wanted}" in topics:
        wanted = f"/{wanted}"
    name = wanted if wanted is not None else usual if usual in topics else next(iter(topics), None)
    if name not in topics or (wanted is None and name != usual and len(topics) > 1):
        needed = f"the topic {wanted} with {what}" if wanted is not None else f"one topic of {what}"
        raise ValueError(f"{path}: must have {needed}, got {', '.join(sorted(topics)) or 'none'}")
    return name


def _log(
    path: Path,
    scans: list[BagMessage],
    target: str,
    pose_at: Callable[[int], RigidTransform | None],
    notes: list[str],
) -> ScanLog:
    first = scans[0].content
    shape = _shape(scans[0])
    rows, others, without = [], [], []
    is_upside_down = False
    for scan in scans:
        where = f"{path}: {scan.topic}, message {scan.index}"
        if _shape(scan) != shape:
            others.append(scan.index)
            continue
        pose = pose_at(stamp_of(scan.content.header))
        if pose is None:
            without.append(scan.index)
            continue
        upward = pose.rotate((0.0, 0.0, 1.0))
        if max(abs(upward[0]), abs(upward[1])) > LARGEST_TILT:
            raise ValueError(f"{where}: the scanner must be level or upside down, got one whose z axis is {upward}")
        is_upside_down = upward[2] < 0.0
        (x, y, _), (qx, qy, qz) = pose.translation, pose.vector
        planar = Pose.from_quaternion(x, y, qx=qx, qy=qy, qz=qz, qw=pose.w)
        rows.append(
            ScanRow(scan.index, stamp_of(scan.content.header), tuple(planar), np.array(scan.content.ranges, np.float32))
        )
    topic = scans[0].topic
    if others:
        notes.append(f"{topic}: {len(others)} scans with other beams were passed over, the first is message {others[0]}")
    if without:
        notes.append(f"{topic}: {len(without)} scans without a pose were passed over, the first is message {without[0]}")
    if not rows:
        raise ValueError(f"{path}: no scan of {topic} has a pose in {target}: there must be transforms around its stamp")
    angles = first.angle_min + first.angle_increment * np.arange(len(first.ranges))
    limits = (float(first.range_min), float(first.range_max))
    return ScanLog.from_rows(
        path, rows, angles=-angles if is_upside_down else angles, limits=limits, frame=target, notes=notes
    )


def _shape(scan: BagMessage) -> tuple[object, ...]:
    content = scan.content
    return len(content.ranges), content.angle_min, content.angle_increment, name_of(content.header.frame_id)
