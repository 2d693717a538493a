"""Frames: where the frames of a bag are in one another over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..instant import NANOSECONDS
from ..nodes.rigid_transform import RigidTransform
from .track import Track

if TYPE_CHECKING:
    from ..recording.bag import BagMessage

STATIC_TOPIC = "/tf_static"
"""Topic of the transforms that hold at all times."""


class Frames:
    """Where the frames of a bag are in one another over time.

    Attributes:
        parents: Parent of each frame that has one.
    """

    def __init__(self) -> None:
        self.parents: dict[str, str] = {}
        self._tracks: dict[str, Track] = {}
        self._static: dict[str, RigidTransform] = {}

    def add(self, message: BagMessage) -> None:
        """Adds the transforms of a message.

        Args:
            message: A message of the type TFMessage.

        Raises:
            ValueError: A transform is not finite, or it gives a frame a second parent.
        """
        for transform in message.content.transforms:
            try:
                pose = RigidTransform.from_message(transform.transform.translation, transform.transform.rotation)
                child, parent = name_of(transform.child_frame_id), name_of(transform.header.frame_id)
                self.add_pose(parent, child, stamp_of(transform.header), pose, static=message.topic == STATIC_TOPIC)
            except ValueError as error:
                raise ValueError(f"{message.topic}, message {message.index}: {error}") from None

    def add_pose(self, parent: str, child: str, stamp: int, pose: RigidTransform, *, static: bool = False) -> None:
        """Adds the pose of a frame in its parent.

        Args:
            parent: The parent.
            child: The frame.
            stamp: Time of the pose [ns].
            pose: The pose.
            static: It holds at all times.

        Raises:
            ValueError: The frame has another parent.
        """
        if self.parents.setdefault(child, parent) != parent:
            raise ValueError(f"a frame must have one parent, got {parent} and {self.parents[child]} for {child}")
        if static:
            self._static[child] = pose
        else:
            self._tracks.setdefault(child, Track()).add(stamp, pose)

    def root_of(self, frame: str) -> str:
        """Returns the topmost frame above a frame, or a frame of the loop that its parents form."""
        seen = {frame}
        while (parent := self.parents.get(frame)) is not None and parent not in seen:
            seen.add(parent)
            frame = parent
        return frame

    def base_of(self, frame: str) -> str:
        """Returns the topmost frame that static transforms lead to from a frame."""
        seen = {frame}
        while frame in self._static and self.parents[frame] not in seen:
            frame = self.parents[frame]
            seen.add(frame)
        return frame

    def has_above(self, frame: str, target: str) -> bool:
        """Returns True if a frame is the target, or below it."""
        seen: set[str] = set()
        while frame != target and frame in self.parents and frame not in seen:
            seen.add(frame)
            frame = self.parents[frame]
        return frame == target

    def stamps_of(self, frame: str) -> list[int]:
        """Returns the times at which the pose of a frame in its parent is known, in ascending order [ns]. None if static."""
        track = None if frame in self._static else self._tracks.get(frame)
        return [] if track is None else track.stamps

    def pose(self, target: str, frame: str, stamp: int, *, holds: bool = False) -> RigidTransform | None:
        """Returns the pose of a frame in one above it at a time, or None if a transform is missing then.

        The first frame on the way up that is not static is the robot's: it moves. See `Track.at`.

        Args:
            target: A frame above the frame.
            frame: The frame.
            stamp: The time [ns].
            holds: The robot's pose is interpolated over any gap, and its last one stays.
        """
        pose, moving = RigidTransform(), not holds
        seen: set[str] = set()
        while frame != target and frame not in seen:
            seen.add(frame)
            step = self._static.get(frame)
            if step is None and (track := self._tracks.get(frame)) is not None:
                step = track.at(stamp, moving=moving)
                moving = False
            if step is None:
                return None
            pose, frame = step * pose, self.parents[frame]
        return pose if frame == target else None


def name_of(frame: Any) -> str:
    """Returns a frame's name without the leading slash that ROS 1 allowed."""
    return str(frame).removeprefix("/")


def stamp_of(header: Any) -> int:
    """Returns the stamp of a message's header [ns]."""
    return int(header.stamp.sec) * NANOSECONDS + int(header.stamp.nanosec)
