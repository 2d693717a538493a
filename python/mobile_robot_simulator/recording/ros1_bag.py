"""Ros1Bag: a ROS 1 bag file being written."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer

from .folder import NAME
from .latching import is_latched
from .mcap_storage import Written
from .serialization import ros1_types, to_ros1_bytes


class Ros1Bag:
    """A ROS 1 bag file being written.

    Args:
        folder: Folder in which the file is created.

    Attributes:
        path: The file.
        end_of_time: The format can store times below this one [ns].
    """

    end_of_time = 2**32 * 1_000_000_000

    def __init__(self, folder: Path) -> None:
        self.path = folder / f"{NAME}.bag"
        self._writer = Writer(self.path)
        try:
            self._writer.open()
        except BaseException:
            with suppress(OSError):
                self._writer.abort()
            raise
        self.close, self.abort = self._writer.close, self._writer.abort

    def flush(self) -> None:
        """Passes all complete chunks to the operating system, so that they outlive the process."""
        if self._writer.bio is not None:
            self._writer.bio.flush()

    encode = staticmethod(to_ros1_bytes)
    """Returns the bytes of a message."""

    def connect(self, topic: str, ros_type: str) -> Connection:
        """Adds a topic."""
        latching = 1 if is_latched(topic) else None
        return self._writer.add_connection(topic, ros_type, typestore=ros1_types(), latching=latching)

    def write_all(self, messages: Iterable[Written]) -> None:
        """Writes messages, each with its connection and its time [ns]. ROS 1 has no time 0, so time 0 becomes 1 ns."""
        for connection, time_ns, data in messages:
            self._writer.write(connection, max(time_ns, 1), data)
