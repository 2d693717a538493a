"""Recorder: writes messages to ROS 2 bags (MCAP, SQLite) and ROS 1 bags that the standard tools open. It needs no ROS.

The same messages in the same order give the same files, byte for byte, with the same version of rosbags.
"""

from __future__ import annotations

import os
from collections import deque
from operator import index
from pathlib import Path
from typing import get_args

from ..messages import Message
from .folder import room_for_recording
from .format import Format
from .writer_thread import WriterThread

try:
    from rosbags.interfaces import Connection

    from .ros1_bag import Ros1Bag
    from .ros2_bag import Ros2Bag
except ImportError as error:
    raise ImportError("recordings need rosbags: pip install 'mobile-robot-simulator[recording]'") from error

__all__ = ["Format", "Recorder"]

_BATCH = 1024
"""Number of messages passed to the writer thread at once. Passing work to it costs about as much as writing ten messages."""


class Recorder:
    """Writes messages to a recording in a folder. Use it as a context manager, which closes the recording.

    Each message is copied when it is written, so it may change afterwards. If an error or Ctrl-C ends the ``with`` block
    early, the recording can still be opened and contains all messages written so far.

    Args:
        path: Folder of the recording, created if needed. The recording in it is ``recording/`` (rosbag2: metadata.yaml and
            recording.mcap or recording.db3) or ``recording.bag`` (ROS 1).
        format: "mcap" or "sqlite3" for ROS 2 Humble and later, "bag" for ROS 1.
        overwrite: Replace an older recording of any format. The older recording is deleted once the new one has begun.

    Raises:
        FileExistsError: There is a recording and `overwrite` is False, or there is something else with its name.
        ValueError: The format is unknown.
        OSError: The folder cannot be written.
    """

    def __init__(self, path: str | os.PathLike[str], *, format: Format = "mcap", overwrite: bool = False) -> None:
        if format not in get_args(Format):
            raise ValueError(f"format must be one of {', '.join(get_args(Format))}, got {format!r}")
        self._types: dict[str, str] = {}
        self._connections: dict[str, Connection] = {}
        self._pending: deque[tuple[str, int, memoryview]] = deque()
        self._closed = False
        self._thread = WriterThread()
        try:
            with room_for_recording(Path(path), overwrite=overwrite) as folder:
                self._thread.run(lambda: self._begin(folder, format))
        except BaseException:
            self._thread.stop()
            raise

    @property
    def path(self) -> Path:
        """The recording itself: a rosbag2 folder or a ROS 1 file."""
        return self._bag.path

    def write(self, topic: str, message: Message, time_ns: int) -> None:
        """Adds a message that was published on a topic.

        Args:
            topic: Name of the topic. All its messages must have the same type.
            message: Message to write.
            time_ns: Time of publication [ns]. A ROS 1 bag stores time 0 as 1 ns, because ROS 1 has no time 0 and
                `rosbag play` skips such messages.

        Raises:
            ValueError: The time is out of range, the topic carries another type, the ROS message cannot hold a value, or the
                recording is closed.
            TypeError: An array has another element type than the ROS message.
            OSError: The disk is full.
        """
        if self._closed:
            raise ValueError(f"the recording {self.path} is closed")
        time_ns = index(time_ns)
        if not 0 <= time_ns < self._bag.end_of_time:
            raise ValueError(f"time_ns must be at least 0 and below {self._bag.end_of_time}, got {time_ns}")
        ros_type = self._types.setdefault(topic, message.ros_type)
        if ros_type != message.ros_type:
            raise ValueError(f"topic {topic} carries {ros_type}, got {message.ros_type}")
        self._pending.append((topic, time_ns, self._bag.encode(message)))
        if len(self._pending) >= _BATCH:
            self._thread.run(self._write_pending)

    def close(self) -> None:
        """Writes the remaining messages and the index. Closing twice does no harm."""
        if self._closed:
            return
        try:
            self._thread.run(self._finish)
        finally:
            self._thread.stop()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _begin(self, folder: Path, format: Format) -> None:
        self._bag = Ros1Bag(folder) if format == "bag" else Ros2Bag(folder, format)

    def _write_pending(self) -> None:
        while self._pending:
            topic, time_ns, data = self._pending.popleft()
            if topic not in self._connections:
                self._connections[topic] = self._bag.connect(topic, self._types[topic])
            self._bag.write(self._connections[topic], time_ns, data)

    def _finish(self) -> None:
        self._closed = True
        try:
            self._write_pending()
            self._bag.close()
        except BaseException:
            self._bag.abort()
            raise
