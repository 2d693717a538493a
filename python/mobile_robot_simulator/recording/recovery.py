"""Recovery: a complete recording from one that was broken off."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, TypeAlias

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.rosbag1.reader import Header, ReaderError, RecordType
from rosbags.rosbag2 import ReaderError as McapError
from rosbags.rosbag2.storage_mcap import McapReader

from .folder import NAME, REBUILT, RecordingFolder
from .ros1_bag import Ros1Bag
from .ros2_bag import Ros2Bag

_Stored: TypeAlias = tuple[str, str, int, bytes]
"""Topic, type, time [ns] and bytes of a message."""

_MCAP_MAGIC = b"\x89MCAP0\r\n"
_MCAP_FOOTER = b"\x02" + (20).to_bytes(8, "little") + bytes(20)
_MCAP_DATA_END, _MCAP_FOOTER_CODE = 0x0F, 0x02


def recover(path: str | os.PathLike[str], *, overwrite: bool = False, companions: Collection[str] = ()) -> tuple[Path, int]:
    """Makes a complete recording of one that was broken off, and returns its path and its number of messages.

    Args:
        path: Folder of the recording, as for `Recorder`.
        overwrite: Replace an older recording in the folder.
        companions: Names of files that belong to the older recording and are replaced with it, as for `Recorder`.

    Raises:
        FileNotFoundError: No recording was broken off in this folder.
        FileExistsError: There is an older recording or a companion of it and `overwrite` is False.
        BlockingIOError: The recording is still being written.
        ValueError: What was written has no complete message. It is kept.
        OSError: The folder cannot be written.
    """
    folder = RecordingFolder(Path(path), overwrite=overwrite, companions=companions, recover=True)
    try:
        if (complete := folder.complete_recording) is not None:
            with AnyReader([complete]) as reader:
                count = reader.message_count
            return folder.finish_complete(complete), count
        source, rebuilt = folder.unfinished / NAME, folder.unfinished / REBUILT
        rebuilt.mkdir()
        bag: Ros1Bag | Ros2Bag
        if (mcap := source / f"{NAME}.mcap").is_file():
            messages, bag = _mcap_messages(mcap, rebuilt / "copy.mcap"), Ros2Bag(rebuilt, "mcap")
        elif (database := source / f"{NAME}.db3").is_file():
            messages, bag = _sqlite3_messages(database), Ros2Bag(rebuilt, "sqlite3")
        elif (file := folder.unfinished / f"{NAME}.bag").is_file():
            messages, bag = _ros1_messages(file), Ros1Bag(rebuilt)
        else:
            raise ValueError(f"{folder.unfinished} has no complete message")
        count = _copy(messages, bag)
        if not count:
            raise ValueError(f"{folder.unfinished} has no complete message")
        return folder.finish(bag.path), count
    except BaseException as error:
        folder.keep()
        if isinstance(error, (OSError, sqlite3.Error)):
            raise folder.error(error, "Nothing was recovered; what was written is kept") from error
        raise


def _copy(messages: Iterator[_Stored], bag: Ros1Bag | Ros2Bag) -> int:
    count = 0
    connections: dict[str, Connection] = {}
    try:
        for topic, ros_type, time_ns, data in messages:
            if topic not in connections:
                connections[topic] = bag.connect(topic, ros_type)
            bag.write(connections[topic], time_ns, memoryview(data))
            count += 1
        bag.close()
    except BaseException:
        bag.abort()
        raise
    return count


def _mcap_messages(file: Path, copy: Path) -> Iterator[_Stored]:
    """Yields the messages of all complete records. Rosbags needs an end of the file, not an index, so a copy gets an end."""
    with file.open("rb") as source, copy.open("wb") as target:
        target.write(source.read(len(_MCAP_MAGIC)))
        while len(head := source.read(9)) == 9 and head[0] not in (_MCAP_DATA_END, _MCAP_FOOTER_CODE):
            size = int.from_bytes(head[1:], "little")
            if len(content := source.read(size)) < size:
                break
            target.write(head + content)
        target.write(_MCAP_FOOTER + _MCAP_MAGIC)
    reader = McapReader(copy)
    try:
        reader.open()
    except McapError:
        return  # not even the header is complete
    with closing(reader):
        for connection, time_ns, data in reader.messages_scan(reader.connections):
            yield connection.topic, connection.msgtype, time_ns, data
    copy.unlink()


def _sqlite3_messages(file: Path) -> Iterator[_Stored]:
    """Yields all committed messages. SQLite removes the others when it opens the file."""
    try:
        with closing(sqlite3.connect(file)) as database:
            yield from database.execute(
                "SELECT topics.name, topics.type, messages.timestamp, messages.data"
                " FROM messages JOIN topics ON messages.topic_id = topics.id ORDER BY messages.id"
            )
    except sqlite3.Error as error:
        raise ValueError(f"{file} cannot be read: {error}") from error


def _ros1_messages(file: Path) -> Iterator[_Stored]:
    """Yields the messages of all complete chunks."""
    topics: dict[int, tuple[str, str]] = {}
    with file.open("rb") as source:
        source.readline()
        for header, chunk in _ros1_records(source):
            if header.get_uint8("op") != RecordType.CHUNK:
                continue
            for inner, data in _ros1_records(BytesIO(chunk)):
                number = inner.get_uint32("conn")
                if inner.get_uint8("op") == RecordType.CONNECTION:
                    kind = Header.read(BytesIO(len(data).to_bytes(4, "little") + data)).get_string("type")
                    topics[number] = inner.get_string("topic"), kind.replace("/", "/msg/")
                else:
                    yield *topics[number], inner.get_time("time"), data


def _ros1_records(source: BinaryIO) -> Iterator[tuple[Header, bytes]]:
    """Yields header and data of all complete records."""
    while True:
        try:
            header = Header.read(source)
        except ReaderError:
            return
        size = int.from_bytes(source.read(4), "little")
        if len(data := source.read(size)) < size:
            return
        yield header, data
