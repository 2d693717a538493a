"""Playback: what a bag knows at any time: where its robots were, their last scans, and the map."""

from __future__ import annotations

import math
import os
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import messages
from .._core import LaserScanner, OccupancyGrid, Pose
from ..instant import NANOSECONDS
from ..messages import LaserScan, Odometry, TFMessage
from ..nodes.map_messages import from_message
from ..nodes.rigid_transform import RigidTransform
from ..ros.conversion import ROSBAGS
from ..user_files import to_path
from .frames import Frames, name_of, stamp_of

if TYPE_CHECKING:
    from ..recording.bag import BagMessage

TARGETS = ("map", "odom")
"""Frames in which things are shown, if the bag has them. Otherwise they are shown in the topmost frame of a robot."""

BEFORE_NS, AFTER_NS = NANOSECONDS // 2, 2 * NANOSECONDS
"""Times before and after a wanted scan from which scans are read and kept [ns]."""

_TYPES = tuple(kind.ros_type for kind in (LaserScan, Odometry, TFMessage, messages.OccupancyGrid))


@dataclass(frozen=True)
class PlayedRobot:
    """A robot at one time.

    Attributes:
        pose: Its pose in the frame of the playback.
        believed: Where its odometry alone believes it to be, in the same frame. Both agree at the beginning.
        velocity: vx, vy [m/s], wz [rad/s], from its odometry; None if it has none, or one that is not finite.
    """

    pose: Pose
    believed: Pose
    velocity: tuple[float, float, float] | None


@dataclass(frozen=True)
class PlayedScan:
    """A scan.

    Attributes:
        stamp_ns: Its time [ns].
        base: Pose of the robot then, in the frame of the playback.
        scanner: The scanner, with its mount on the robot.
        ranges: (beam_count,) float32 [m].
    """

    stamp_ns: int
    base: Pose
    scanner: LaserScanner
    ranges: NDArray[np.float32]


@dataclass
class _Times:
    """Stamps of messages in ascending order, and for each what is known without the message."""

    stamps: list[int]
    values: list[Any]

    @classmethod
    def of(cls, pairs: list[tuple[int, Any]]) -> _Times:
        ordered = sorted(pairs, key=lambda pair: pair[0])
        return cls([stamp for stamp, _ in ordered], [value for _, value in ordered])

    def last(self, time_ns: int) -> int | None:
        """Returns the index of the last message at or before a time, or None."""
        index = bisect_right(self.stamps, time_ns) - 1
        return index if index >= 0 else None


class Playback:
    """What a bag knows at any time.

    Transforms and odometry are read at once. Scans and maps are read when they are asked for. Times are those of the stamps
    in the messages. A map holds from the time on at which it was recorded, the first one from the beginning.

    Robots are the frames of the odometry, or else what carries the scanners. A robot has the name of its frame's namespace.

    Args:
        path: The bag, as for `Bag`.

    Attributes:
        path: The file or folder that is read.
        frame: Frame in which things are shown.
        begin_ns: First time of a pose or a scan [ns].
        end_ns: Last time of a pose or a scan [ns].
        scanners: Robot of each scanner, by the topic of its scans.
        notes: What was passed over, or assumed because the bag does not say it.

    Raises:
        ImportError: rosbags is not installed.
        OSError: The bag cannot be read.
        ValueError: The file is not a bag, a message is damaged, or there is nothing to show.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        from ..recording.bag import Bag

        self._bag = Bag(to_path(path, "a bag"))
        self._frames = Frames()
        scans: dict[str, list[tuple[int, int]]] = {}
        scan_frames: dict[str, str] = {}
        odometry: dict[str, list[tuple[int, tuple[float, float, float] | None]]] = {}
        poses: list[tuple[BagMessage, str, str]] = []
        maps: list[tuple[int, int]] = []
        now_ns = 0
        for message in self._bag.messages(_TYPES):
            content = message.content
            if message.ros_type == TFMessage.ros_type:
                self._add_transforms(message)
                continue
            if message.ros_type == messages.OccupancyGrid.ros_type:
                maps.append((now_ns, message.time_ns))
                continue
            stamp = now_ns = stamp_of(content.header)
            if message.ros_type == LaserScan.ros_type:
                scans.setdefault(message.topic, []).append((stamp, message.time_ns))
                scan_frames.setdefault(message.topic, name_of(content.header.frame_id))
            else:
                base = name_of(content.child_frame_id)
                twist = content.twist.twist
                velocity = (float(twist.linear.x), float(twist.linear.y), float(twist.angular.z))
                known = velocity if all(map(math.isfinite, velocity)) else None
                odometry.setdefault(base, []).append((stamp, known))
                poses.append((message, name_of(content.header.frame_id), base))
        self.path, self.notes = self._bag.path, list(self._bag.notes)
        self._add_odometry(poses)
        self._scans = {topic: _Times.of(pairs) for topic, pairs in scans.items()}
        self._velocities = {base: _Times.of(pairs) for base, pairs in odometry.items()}
        self._maps = _Times.of([(0 if index == 0 else stamp, time_ns) for index, (stamp, time_ns) in enumerate(maps)])
        self._bases, self._mounts = self._find_robots(scan_frames)
        self.scanners = {topic: robot for topic, (robot, _) in self._mounts.items()}
        bases = list(self._bases.values())
        above = [each for each in TARGETS if any(self._frames.has_above(base, each) for base in bases)]
        self.frame = above[0] if above else self._frames.root_of(bases[0]) if bases else ""
        self._starts = {name: self._start_of(base) for name, base in self._bases.items()}
        times = [stamp for base in bases for stamp in self._frames.stamps_of(base)]
        times += [stamp for each in self._scans.values() for stamp in each.stamps]
        if not times:
            raise ValueError(f"{self.path}: must have scans, odometry or transforms, got none")
        self.begin_ns, self.end_ns = min(times), max(times)
        self._kept: dict[tuple[str, int], Any] = {}
        self._keeps_all = bool(self._bag.notes)
        if self._keeps_all:  # a bag without an end has no index to read a part of it
            self._keep(None, None)
        self._grid: tuple[int | None, OccupancyGrid | None] = (None, None)

    @property
    def robots(self) -> list[str]:
        """Names of the robots."""
        return list(self._bases)

    def robot_at(self, name: str, time_ns: int) -> PlayedRobot | None:
        """Returns a robot at a time, or None if its pose is not known then. After its last pose, it stays there.

        Args:
            name: Name of the robot.
            time_ns: The time [ns].
        """
        base = self._bases[name]
        pose = self._planar(base, time_ns, holds=True)
        if pose is None:
            return None
        start, parent = self._starts[name], self._frames.parents[base]
        odometry = self._frames.pose(parent, base, time_ns, holds=True)
        believed = pose if start is None or odometry is None else start * _planar(odometry)
        velocities = self._velocities.get(base)
        index = None if velocities is None else velocities.last(time_ns)
        velocity = None if velocities is None or index is None else velocities.values[index]
        return PlayedRobot(pose, believed, velocity)

    def scan_at(self, topic: str, time_ns: int) -> PlayedScan | None:
        """Returns the last scan of a topic at or before a time, or None if there is none or its pose is not known.

        Args:
            topic: Topic of the scans.
            time_ns: The time [ns].

        Raises:
            OSError: The bag cannot be read.
            ValueError: The scan is damaged, or its angles or limits are those of no scanner.
        """
        times = self._scans[topic]
        index = times.last(time_ns)
        if index is None:
            return None
        stamp, recorded_ns = times.stamps[index], times.values[index]
        robot, mount = self._mounts[topic]
        base = self._planar(self._bases[robot], stamp)
        if base is None:
            return None
        if (topic, stamp) not in self._kept:
            self._keep(recorded_ns - BEFORE_NS, recorded_ns + AFTER_NS)
        scan = self._kept[topic, stamp]
        try:
            scanner = LaserScanner(
                angle_min=scan.angle_min,
                angle_increment=scan.angle_increment,
                beam_count=len(scan.ranges),
                min_range=scan.range_min,
                max_range=scan.range_max,
                mount=(*mount.translation, *mount.vector, mount.w),
            )
        except ValueError as error:
            raise ValueError(f"{self.path}: {topic}, stamp {stamp / NANOSECONDS:.9f} s: {error}") from None
        return PlayedScan(stamp, base, scanner, np.asarray(scan.ranges, np.float32))

    def map_at(self, time_ns: int) -> OccupancyGrid | None:
        """Returns the map at a time, or None if the bag has none. The same map is the same object.

        Args:
            time_ns: The time [ns].

        Raises:
            OSError: The bag cannot be read.
            ValueError: The map is damaged.
        """
        index = self._maps.last(time_ns)
        if index is not None and index != self._grid[0]:
            time_of_map = self._maps.values[index]
            found = list(self._bag.messages([messages.OccupancyGrid.ros_type], time_of_map, time_of_map + 1))
            self._grid = index, from_message(ROSBAGS.from_ros(found[-1].content, messages.OccupancyGrid))
        return self._grid[1]

    def _keep(self, start_ns: int | None, stop_ns: int | None) -> None:
        """Reads scans from a part of the bag, and forgets others."""
        found = self._bag.messages([LaserScan.ros_type], start_ns, stop_ns)
        self._kept = {(each.topic, stamp_of(each.content.header)): each.content for each in found}

    def _planar(self, base: str, time_ns: int, *, holds: bool = False) -> Pose | None:
        pose = self._frames.pose(self.frame, base, time_ns, holds=holds)
        return None if pose is None else _planar(pose)

    def _add_transforms(self, message: BagMessage) -> None:
        try:
            self._frames.add(message)
        except ValueError as error:
            raise ValueError(f"{self._bag.path}: {error}") from None

    def _add_odometry(self, poses: list[tuple[BagMessage, str, str]]) -> None:
        """Adds the poses of robots that no transform places."""
        unplaced = {base for _, _, base in poses if base not in self._frames.parents}
        for message, parent, base in poses:
            if base in unplaced and parent != base:
                try:
                    pose = message.content.pose.pose
                    placed = RigidTransform.from_message(pose.position, pose.orientation)
                    self._frames.add_pose(parent, base, stamp_of(message.content.header), placed)
                except ValueError as error:
                    raise ValueError(f"{self.path}: {message.topic}, message {message.index}: {error}") from None

    def _find_robots(self, scan_frames: Mapping[str, str]) -> tuple[dict[str, str], dict[str, tuple[str, RigidTransform]]]:
        """Returns the frame of each robot by name, and for each topic of scans its robot and where the scanner is on it."""
        frames = self._frames
        bases = {base for base in self._velocities if base in frames.parents}
        carriers: dict[str, str] = {}
        for topic, frame in scan_frames.items():
            above = [base for base in bases if frames.has_above(frame, base)]
            if above:
                carriers[topic] = above[0]
            elif frame in frames.parents:
                base = frames.base_of(frame)
                carriers[topic] = base if base in frames.parents else frame
            elif len(bases) == 1:
                carriers[topic] = next(iter(bases))
                self.notes.append(f"no transform says where the scanner {frame!r} is, so it is at the robot's origin")
            else:
                self.notes.append(f"{topic} is not shown: no transform leads up from its frame {frame!r}")
        names: dict[str, str] = {}
        for base in sorted(bases | set(carriers.values())):
            namespace = base.rpartition("/")[0]
            names[base] = base if namespace in names.values() else namespace
        mounts = {}
        for topic, base in carriers.items():
            mount = frames.pose(base, scan_frames[topic], self._scans[topic].stamps[0], holds=True)
            mounts[topic] = names[base], RigidTransform() if mount is None else mount
        return {name: base for base, name in names.items()}, mounts

    def _start_of(self, base: str) -> Pose | None:
        """Returns the pose of the odometry's frame when the pose of the robot is first known; None without odometry."""
        parent = self._frames.parents[base]
        if parent == self.frame:
            return None
        for stamp in self._frames.stamps_of(base):
            if (placed := self._frames.pose(self.frame, parent, stamp, holds=True)) is not None:
                return _planar(placed)
        return None


def _planar(pose: RigidTransform) -> Pose:
    (x, y, _), (qx, qy, qz) = pose.translation, pose.vector
    return Pose.from_quaternion(x, y, qx=qx, qy=qy, qz=qz, qw=pose.w)
