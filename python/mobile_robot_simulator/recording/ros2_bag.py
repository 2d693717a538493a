"""Ros2Bag: a rosbag2 folder being written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection, Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from .folder import NAME
from .latching import is_latched
from .mcap_storage import McapStorage, Written
from .serialization import ros2_types, to_ros2_bytes


class _Writer(Writer):
    STORAGE_PLUGINS: Mapping[StoragePlugin, type[Any]] = {**Writer.STORAGE_PLUGINS, StoragePlugin.MCAP: McapStorage}


class Ros2Bag:
    """A rosbag2 folder being written.

    Args:
        folder: Folder in which the rosbag2 folder is created.
        format: "mcap" or "sqlite3".

    Attributes:
        path: The rosbag2 folder.
        end_of_time: The format can store times below this one [ns].
    """

    end_of_time = 2**63

    def __init__(self, folder: Path, format: str) -> None:
        self.path = folder / NAME
        # Jazzy and later write version 9, which Humble cannot read. All of them can read version 8.
        self._writer = _Writer(self.path, version=8, storage_plugin=StoragePlugin[format.upper()])
        self._writer.open()
        self._storage = self._writer.storage
        if isinstance(self._storage, Sqlite3Writer):
            # Waiting for the disk at each commit would guard against power failure only, and is slow.
            self._storage.conn.execute("PRAGMA synchronous = OFF")
        self.abort = self._writer.abort

    def flush(self) -> None:
        """Passes rows and complete chunks to the operating system, so that they outlive the process."""
        if isinstance(self._storage, Sqlite3Writer):
            self._storage.conn.commit()
        elif isinstance(self._storage, McapStorage):
            self._storage.flush()

    def write_all(self, messages: Iterable[Written]) -> None:
        """Writes messages, each with its connection and its time [ns]."""
        if isinstance(self._storage, McapStorage):
            # Not through the writer of rosbags, which only counts them, in the time that it takes to write them.
            self._storage.write_all(messages)
        else:
            for message in messages:
                self._writer.write(*message)

    def close(self) -> None:
        """Writes the index and the metadata."""
        if isinstance(self._storage, McapStorage):
            self._storage.end_chunk()
            self._writer.counts.update(self._storage.counts)
            self._writer.min_timestamp, self._writer.max_timestamp = self._storage.times
        self._writer.close()

    encode = staticmethod(to_ros2_bytes)
    """Returns the bytes of a message."""

    def connect(self, topic: str, ros_type: str) -> Connection:
        """Adds a topic."""
        qos = [offered_qos(topic)]
        return self._writer.add_connection(topic, ros_type, typestore=ros2_types(), offered_qos_profiles=qos)


def offered_qos(topic: str) -> Qos:
    """Returns the QoS of a publisher of the topic. It is reliable, which best-effort subscribers accept too."""
    latched = is_latched(topic)
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
