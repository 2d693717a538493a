"""Recovery: a complete recording from one that was broken off."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from pathlib import Path

from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection

from ..user_files import to_path
from .complete_messages import Stored, mcap_messages, ros1_messages
from .folder import NAME, REBUILT, RecordingFolder
from .mcap_storage import Written
from .ros1_bag import Ros1Bag
from .ros2_bag import Ros2Bag


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
        TypeError: The path is neither a text nor a path.
    """
    folder = RecordingFolder(to_path(path, "a recording"), overwrite=overwrite, companions=companions, recover=True)
    try:
        if (complete := folder.complete_recording) is not None:
            with AnyReader([complete]) as reader:
                count = reader.message_count
            return folder.finish_complete(complete), count
        source, rebuilt = folder.unfinished / NAME, folder.unfinished / REBUILT
        rebuilt.mkdir()
        bag: Ros1Bag | Ros2Bag
        if (mcap := source / f"{NAME}.mcap").is_file():
            messages, bag = mcap_messages(mcap, rebuilt / "copy.mcap"), Ros2Bag(rebuilt, "mcap")
        elif (database := source / f"{NAME}.db3").is_file():
            messages, bag = _sqlite3_messages(database), Ros2Bag(rebuilt, "sqlite3")
        elif (file := folder.unfinished / f"{NAME}.bag").is_file():
            messages, bag = ros1_messages(file), Ros1Bag(rebuilt)
        else:
            raise ValueError(f"{folder.shown(folder.unfinished)} has no complete message")
        count = _copy(messages, bag)
        if not count:
            raise ValueError(f"{folder.shown(folder.unfinished)} has no complete message")
        return folder.finish(bag.path), count
    except BaseException as error:
        folder.keep()
        if isinstance(error, (OSError, sqlite3.Error)):
            raise folder.error(error, "Nothing was recovered; what was written is kept") from error
        raise


def _copy(messages: Iterator[Stored], bag: Ros1Bag | Ros2Bag) -> int:
    count = 0
    connections: dict[str, Connection] = {}

    def connected() -> Iterator[Written]:
        nonlocal count
        for topic, ros_type, time_ns, data in messages:
            if topic not in connections:
                connections[topic] = bag.connect(topic, ros_type)
            yield connections[topic], time_ns, data
            count += 1

    try:
        bag.write_all(connected())
        bag.close()
    except BaseException:
        bag.abort()
        raise
    return count


def _sqlite3_messages(file: Path) -> Iterator[Stored]:
    """Yields all committed messages. SQLite removes the others when it opens the file."""
    try:
        with closing(sqlite3.connect(file)) as database:
            yield from database.execute(
                "SELECT topics.name, topics.type, messages.timestamp, messages.data"
                " FROM messages JOIN topics ON messages.topic_id = topics.id ORDER BY messages.id"
            )
    except sqlite3.Error as error:
        raise ValueError(f"{file} cannot be read: {error}") from error
