"""Recorder: writes messages to ROS 2 bags (MCAP, SQLite) and ROS 1 bags that the standard tools open. It needs no ROS.

The same messages in the same order give the same files, byte for byte, with the same version of rosbags.
"""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Collection, Iterator
from contextlib import suppress
from functools import partial
from operator import index
from pathlib import Path
from types import TracebackType
from typing import Any, NoReturn, get_args

from ..bus.topic import absolute
from ..message_recipe import MessageRecipe
from ..messages import Message
from ..quoting import quoted
from ..user_files import to_path
from .format import Format
from .writer_thread import WriterThread

try:
    from rosbags.interfaces import Connection

    from .folder import RECOVER, RecordingFolder
    from .mcap_storage import Written
    from .recovery import recover
    from .ros1_bag import Ros1Bag
    from .ros2_bag import Ros2Bag
except ImportError as error:
    raise ImportError("recordings need rosbags: pip install 'mobile-robot-simulator[recording]'") from error

__all__ = ["Format", "Recorder", "recover"]

_BATCH = 1024
"""Number of messages passed to the writer thread at once. Passing work to it costs about as much as writing ten messages."""


class Recorder:
    """Writes messages to a recording in a folder. Use it as a context manager, which closes the recording.

    Each message is copied when it is written, so it may change afterwards. If an error or Ctrl-C ends the ``with`` block
    early, the recording can still be opened and contains all messages written so far. But after a call of `companion` it
    stays in ``recording.unfinished``, because a companion may be missing.

    Until the recorder is closed, the messages are in the folder ``recording.unfinished``, which is locked. If the process is
    killed or the disk is full, this folder stays, and `recover` makes a recording of it. It lacks at most the last 1,024
    messages and, for "mcap" and "bag", the last megabyte.

    Args:
        path: Folder of the recording, created if needed. A later change of the working directory does not matter. The
            recording in it is ``recording/`` (rosbag2: metadata.yaml and recording.mcap or recording.db3) or
            ``recording.bag`` (ROS 1).
        format: "mcap" or "sqlite3" for ROS 2 Humble and later, "bag" for ROS 1.
        overwrite: Replace an older recording of any format. The older one is deleted when the new one is complete. What is
            left of a recording that was broken off is deleted at the beginning. If it was complete and had only to be moved,
            it becomes the older recording.
        companions: Names of files in the folder that belong to a recording, such as a picture of it. Older ones are deleted
            together with the older recording, so that they never lie beside the new one. Write new ones to the paths that
            `companion` returns: they come to their places together with the recording.

    Raises:
        FileExistsError: There is a recording or a companion and `overwrite` is False, or something else of that name.
        BlockingIOError: Another process records into the folder.
        ValueError: The format is unknown.
        OSError: The folder cannot be written.
        TypeError: The path is neither a text nor a path.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        format: Format = "mcap",
        overwrite: bool = False,
        companions: Collection[str] = (),
    ) -> None:
        if format not in get_args(Format):
            raise ValueError(f"format must be one of {', '.join(get_args(Format))}, got {quoted(format)}")
        self._types: dict[str, str] = {}
        self._classes: dict[str, type[Message]] = {}
        """Class of the last message of each topic, whose type is that of the topic."""
        self._connections: dict[str, Connection] = {}
        self._pending: list[Any] = []
        """Topic, time [ns] and bytes of each pending message, one after another. Tuples would cost garbage collections."""
        self._companions = tuple(companions)
        self._complete = self._closed = False
        self._thread = WriterThread()
        try:
            self._folder = RecordingFolder(to_path(path, "a recording"), overwrite=overwrite, companions=companions)
            try:
                self._thread.run(lambda: self._begin(format))
            except BaseException as error:
                self._folder.discard()
                if isinstance(error, (OSError, sqlite3.Error)):
                    raise self._folder.error(error, "No recording was begun; an older one is kept") from error
                raise
        except BaseException:
            self._thread.stop()
            raise
        self._encode, self._end_of_time = self._bag.encode, self._bag.end_of_time

    @property
    def path(self) -> Path:
        """The recording itself: a rosbag2 folder or a ROS 1 file. It is there once the recorder is closed."""
        return self._folder.shown(self._folder.unfinished.parent / self._bag.path.name)

    def write(self, topic: str, message: Message | partial[Message], time_ns: int) -> None:
        """Adds a message that was published on a topic.

        Args:
            topic: Name of the topic; "scan" is /scan, as in a simulation. All its messages must have the same type.
            message: Message to write, or a call that builds it, which is made now. So this function is a tap for
                `Simulation.record`, and for `Simulation.record_lazily`, which costs less.
            time_ns: Time of publication [ns]. A ROS 1 bag stores time 0 as 1 ns, because ROS 1 has no time 0 and
                `rosbag play` skips such messages.

        Raises:
            ValueError: The time is out of range, the topic has no name or carries another type, the ROS message cannot hold
                a value, or the recording is closed.
            TypeError: An argument has a wrong type, or an array has another element type than the ROS message.
            OSError: The disk is full, or the folder was removed. The message says where the written messages are.
        """
        if self._closed or self._complete:
            raise ValueError(f"the recording {self.path} is closed")
        time_ns = time_ns if type(time_ns) is int else _integer(time_ns)
        if not 0 <= time_ns < self._end_of_time:
            raise ValueError(f"time_ns must be at least 0 and below {self._end_of_time}, got {quoted(time_ns)}")
        if isinstance(message, partial):
            recipe: Any = message.func
            if type(recipe) is MessageRecipe:
                kind = recipe.kind
            else:
                message = message()
                kind = type(message)
        else:
            kind = type(message)
        if self._classes.get(topic) is not kind:
            topic = self._checked_topic(topic, kind, message)
        self._pending += (topic, time_ns, self._encode(message))
        if len(self._pending) >= 3 * _BATCH:
            self._thread.run(self._write_batch)

    def _checked_topic(self, topic: str, kind: type[Message], message: object) -> str:
        """Returns the full name of a topic, after checks that it can carry messages of a class."""
        if not issubclass(kind, Message):
            raise TypeError(f"the message must be one of mobile_robot_simulator.messages, got {quoted(message)}")
        topic = absolute(topic)
        ros_type = self._types.setdefault(topic, kind.ros_type)
        if ros_type != kind.ros_type:
            raise ValueError(f"topic {topic} carries {ros_type}, got {kind.ros_type}")
        self._classes[topic] = kind
        return topic

    def companion(self, name: str) -> Path:
        """Ends the recording, and returns the path to write a new companion to.

        `close` moves the companion to its place, together with the recording. If the process is killed before, neither of
        them replaces an older one. No message can be written after this call.

        Args:
            name: One of the names in `companions`.

        Raises:
            ValueError: `companions` does not have the name, or the recording is closed.
            OSError: The disk is full, or the folder was removed. The message says where the written messages are.
        """
        if name not in self._companions:
            raise ValueError(f"name must be one of the companions {quoted(self._companions)}, got {quoted(name)}")
        if self._closed:
            raise ValueError(f"the recording {self.path} is closed")
        self._thread.run(self._end)
        return self._folder.complete / name

    def close(self) -> None:
        """Writes the remaining messages and the index, and moves the recording to its place. Closing twice does no harm.

        Raises:
            OSError: The disk is full, or the folder was removed. The message says where the written messages are.
        """
        if self._closed:
            return
        try:
            self._thread.run(self._finish)
        finally:
            self._thread.stop()

    def discard(self) -> None:
        """Deletes what was written, and keeps an older recording. Does nothing after `close` or a full disk."""
        if self._closed:
            return
        try:
            self._thread.run(self._discard)
        finally:
            self._thread.stop()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if error is None or not self._complete or self._closed:
            self.close()
            return
        try:
            self._thread.run(lambda: self._break_off(error))
        finally:
            self._thread.stop()

    def _begin(self, format: Format) -> None:
        unfinished = self._folder.unfinished
        self._bag = Ros1Bag(unfinished) if format == "bag" else Ros2Bag(unfinished, format)

    def _write_batch(self) -> None:
        try:
            self._write_pending()
            self._bag.flush()
            self._bag.path.stat()  # A file of a removed folder can still be written, in vain.
        except BaseException as error:
            self._break_off(error)

    def _write_pending(self) -> None:
        self._bag.write_all(self._taken())

    def _taken(self) -> Iterator[Written]:
        """Takes the messages that are pending. Each topic gets a connection before its first message."""
        pending, self._pending = self._pending, []
        topics, times, data = pending[::3], pending[1::3], pending[2::3]
        return zip(map(self._connection, topics), times, data, strict=True)

    def _connection(self, topic: str) -> Connection:
        connection = self._connections.get(topic)
        if connection is None:
            connection = self._connections[topic] = self._bag.connect(topic, self._types[topic])
        return connection

    def _end(self) -> None:
        """Completes the recording where it is."""
        if self._complete:
            return
        try:
            self._write_pending()
            self._bag.close()
            self._folder.complete.mkdir()
        except BaseException as error:
            self._break_off(error)
        self._complete = True

    def _discard(self) -> None:
        self._closed = True
        self._pending.clear()
        with suppress(OSError, sqlite3.Error):
            self._bag.abort()
        self._folder.discard()

    def _finish(self) -> None:
        self._end()
        try:
            self._folder.finish(self._bag.path)
        except BaseException as error:
            self._break_off(error)
        self._closed = True

    def _break_off(self, error: BaseException) -> NoReturn:
        """Closes the recording without an index, keeps what is on the disk, and raises the error with its path."""
        self._closed = True
        self._pending.clear()
        with suppress(OSError, sqlite3.Error):
            self._bag.abort()
        self._folder.keep()
        if not isinstance(error, (OSError, sqlite3.Error)):
            raise error
        unfinished = self._folder.unfinished
        if unfinished.is_dir():
            folder = self._folder.shown(unfinished.parent)
            kept = f"messages written before are kept, `{RECOVER} {folder}` recovers them"
        else:
            kept = "the folder is gone, nothing is kept"
        raise self._folder.error(error, f"The recording was broken off; {kept}") from error


def _integer(time_ns: object) -> int:
    try:
        return index(time_ns)  # type: ignore[arg-type]
    except TypeError:
        raise TypeError(f"time_ns must be an integer, got {quoted(time_ns)}") from None
