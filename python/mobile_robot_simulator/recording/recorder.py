"""Recordings: messages to ROS 2 bags (MCAP, SQLite) and ROS 1 bags that the standard tools open, with no ROS.

The same messages in the same order make the same files, byte for byte, under the same version of rosbags.
"""

from __future__ import annotations

import errno
import os
import shutil
import struct
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from functools import cache
from operator import attrgetter, index
from pathlib import Path
from queue import SimpleQueue
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ..messages import Message

try:
    from rosbags.interfaces import Connection, Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
    from rosbags.rosbag1 import Writer as Ros1Writer
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Ros2Writer
    from rosbags.serde import SerdeError
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    from rosbags.typesys.store import Typestore
except ImportError as error:
    raise ImportError("recordings need rosbags: pip install 'mobile-robot-simulator[recording]'") from error

__all__ = ["Format", "Recorder"]

Format: TypeAlias = Literal["mcap", "bag", "sqlite3"]
_Job: TypeAlias = tuple[Callable[[], None], list[BaseException | None], threading.Lock]

# What a recording is called in its folder: a rosbag2 folder of this name, or a ROS 1 file with the suffix .bag.
_NAME = "recording"
_ROS2_FILES = {"metadata.yaml", "metadata.yaml.tmp", f"{_NAME}.mcap", f"{_NAME}.db3", f"{_NAME}.db3-journal"}
_ROS1_START = b"#ROSBAG V2.0\n"

# Messages that wait before they are handed to the writer's thread, which costs about as much as writing ten.
_BATCH = 1024

# Whoever subscribes late still gets the last message of these topics.
_LATCHED = ("map", "tf_static")


class Recorder:
    """A recording being made in a folder; a context manager that closes it.

    Messages are taken as they are when written, and may change after. However the ``with`` block ends, Ctrl-C included,
    what was written until then is a recording that opens.

    path: the folder, made if need be. The recording in it is ``recording/`` (rosbag2: metadata.yaml and recording.mcap
    or recording.db3) or ``recording.bag`` (ROS 1).
    format: "mcap" or "sqlite3" for ROS 2 Humble and later, "bag" for ROS 1.
    overwrite: replace the recording that is there, of whichever format, once the new one is begun.
    raises: FileExistsError if there is a recording and overwrite is False, or something else of its name; ValueError
    for an unknown format; OSError if the folder cannot be written.
    """

    def __init__(self, path: str | os.PathLike[str], *, format: Format = "mcap", overwrite: bool = False) -> None:
        if format not in get_args(Format):
            raise ValueError(f"format must be one of {', '.join(get_args(Format))}, got {format!r}")
        self._types: dict[str, str] = {}
        self._connections: dict[str, Connection] = {}
        self._pending: deque[tuple[str, int, memoryview]] = deque()
        self._closed = False
        self._thread = _WriterThread()
        try:
            with _place(Path(path), overwrite=overwrite) as folder:
                self._thread.run(lambda: self._begin(folder, format))
        except BaseException:
            self._thread.stop()
            raise

    @property
    def path(self) -> Path:
        """The recording itself: a rosbag2 folder or a ROS 1 file."""
        return self._bag.path

    def write(self, topic: str, message: Message, time_ns: int) -> None:
        """Add a message that went over a topic at a time [ns].

        ROS 1 has no time 0, and rosbag play passes over what has it: there, such a message is kept at 1 ns.

        raises: ValueError for a time out of range, a second type on a topic, a value that the ROS type cannot hold, or
        a closed recording; TypeError for an array of another element type; OSError if the disk is full.
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
        """Write what is left, and the index. The second time, nothing happens."""
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
        self._bag = _Ros1Bag(folder) if format == "bag" else _Ros2Bag(folder, format)

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


class _WriterThread:
    """A thread that does one piece of work after another, each to its end.

    Ctrl-C is raised in the main thread only, so that work done elsewhere never leaves half a record. Interrupted at a bad
    moment, a wait by concurrent.futures or threading.Event keeps its lock for ever; hence bare locks and queues.
    """

    def __init__(self) -> None:
        self._queue: SimpleQueue[_Job | None] = SimpleQueue()
        threading.Thread(target=_work_off, args=[self._queue], name="recorder", daemon=True).start()

    def run(self, work: Callable[[], None]) -> None:
        """Do work there and wait; who is interrupted meanwhile waits all the same."""
        ended = threading.Lock()
        ended.acquire()
        outcome: list[BaseException | None] = []
        self._queue.put((work, outcome, ended))
        try:
            ended.acquire()
        finally:
            while not outcome:
                time.sleep(0.001)
        if outcome[0] is not None:
            raise outcome[0]

    def stop(self) -> None:
        """End the thread when all is done."""
        self._queue.put(None)


def _work_off(queue: SimpleQueue[_Job | None]) -> None:
    for work, outcome, ended in iter(queue.get, None):
        try:
            work()
            outcome.append(None)
        except BaseException as error:
            outcome.append(error)
        ended.release()


# --- The two kinds of bag ---


class _Ros2Bag:
    end_of_time = 2**63

    def __init__(self, folder: Path, format: str) -> None:
        self.path = folder / _NAME
        # Humble cannot read version 9, which Jazzy and later write; all of them read version 8.
        self._writer = Ros2Writer(self.path, version=8, storage_plugin=StoragePlugin[format.upper()])
        self._writer.open()
        self.write, self.close, self.abort = self._writer.write, self._writer.close, self._writer.abort

    def encode(self, message: Message) -> memoryview:
        return _cdr(message)

    def connect(self, topic: str, ros_type: str) -> Connection:
        qos = [_offered_qos(topic)]
        return self._writer.add_connection(topic, ros_type, typestore=_ros2_types(), offered_qos_profiles=qos)


class _Ros1Bag:
    end_of_time = 2**32 * 1_000_000_000

    def __init__(self, folder: Path) -> None:
        self.path = folder / f"{_NAME}.bag"
        self._writer = Ros1Writer(self.path)
        self._writer.open()
        self.close, self.abort = self._writer.close, self._writer.abort

    def encode(self, message: Message) -> memoryview:
        return _ros2_types().cdr_to_ros1(_cdr(message), message.ros_type)

    def connect(self, topic: str, ros_type: str) -> Connection:
        return self._writer.add_connection(
            topic, ros_type, typestore=_ros1_types(), latching=1 if _is_latched(topic) else None
        )

    def write(self, connection: Connection, time_ns: int, data: memoryview) -> None:
        self._writer.write(connection, max(time_ns, 1), data)


def _is_latched(topic: str) -> bool:
    return topic.rpartition("/")[2] in _LATCHED


def _offered_qos(topic: str) -> Qos:
    """What a publisher of the topic offers: reliable, which subscribers to sensor data accept too."""
    latched = _is_latched(topic)
    forever = QosTime(9223372036, 854775807)
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if latched else 10,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=forever,
        lifespan=forever,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=forever,
        avoid_ros_namespace_conventions=False,
    )


# --- Messages to bytes ---


@cache
def _ros2_types() -> Typestore:
    return get_typestore(Stores.ROS2_HUMBLE)


@cache
def _ros1_types() -> Typestore:
    types = get_typestore(Stores.ROS1_NOETIC)
    types.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    return types


def _cdr(message: Message) -> memoryview:
    """Bytes of a message as ROS 2 has them."""
    try:
        # mypy takes a class for unhashable when its instances are.
        for name, array_of, dtype in _arrays(type(message)):  # type: ignore[arg-type]
            if array_of(message).dtype != dtype:
                raise TypeError(f"{name} must have dtype {dtype}, got {array_of(message).dtype}")
        return _ros2_types().serialize_cdr(message, message.ros_type, little_endian=True)
    except KeyError as error:
        raise ValueError(f"{message.ros_type} is not a known ROS type") from error
    except (AttributeError, OverflowError, SerdeError, ValueError, struct.error) as error:
        raise ValueError(f"cannot record this {message.ros_type}: {error}") from error


@cache
def _arrays(kind: type[Message]) -> list[tuple[str, Callable[[Message], Any], np.dtype[Any]]]:
    """Fields of a kind of message that are arrays, with their element types: serialization would reinterpret others."""
    return [(name, attrgetter(name), array.dtype) for name, array in _walk(kind()) if isinstance(array, np.ndarray)]


def _walk(message: Message) -> Iterator[tuple[str, Any]]:
    for item in fields(message):
        value = getattr(message, item.name)
        if isinstance(value, Message):
            yield from ((f"{item.name}.{name}", inner) for name, inner in _walk(value))
        else:
            yield item.name, value


# --- A place in the folder ---


@contextmanager
def _place(folder: Path, *, overwrite: bool) -> Iterator[Path]:
    """The folder, with room for a new recording; older ones are gone once that is begun, and back if it cannot be."""
    older = [path for path in (folder / _NAME, folder / f"{_NAME}.bag") if os.path.lexists(path)]
    for path in older:
        if not _is_recording(path):
            raise FileExistsError(errno.EEXIST, "In the way of a recording, and not one itself", str(path))
        if not overwrite:
            kept = "There is a recording already, which is kept; --overwrite (overwrite=True) replaces it"
            raise FileExistsError(errno.EEXIST, kept, str(path))
    folder.mkdir(parents=True, exist_ok=True)
    if not older:
        yield folder
        return
    aside = Path(tempfile.mkdtemp(prefix=f".{_NAME}-", dir=folder))
    try:
        for path in older:
            path.rename(aside / path.name)
        yield folder
    except BaseException:
        for path in aside.iterdir():
            _remove(folder / path.name)
            path.rename(folder / path.name)
        aside.rmdir()
        raise
    shutil.rmtree(aside)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _is_recording(path: Path) -> bool:
    """Whether there is nothing at a path but what this module leaves there."""
    if path.is_symlink():
        return False
    if path.is_dir():
        return all(item.name in _ROS2_FILES and item.is_file() and not item.is_symlink() for item in path.iterdir())
    with path.open("rb") as file:
        return file.read(len(_ROS1_START)) == _ROS1_START
