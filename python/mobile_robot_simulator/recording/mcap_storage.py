"""McapStorage: an MCAP file being written, with the bytes that rosbags gives it, in a fraction of the time."""

from __future__ import annotations

import struct
from collections import defaultdict
from collections.abc import Iterable
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import TypeAlias

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinitionFormat

MAGIC = b"\x89MCAP0\r\n"

CHUNK_SIZE = 2**20
"""A chunk ends after the message with which it has more bytes than this."""

HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = range(0x0B, 0x10)
"""Kinds of records (https://mcap.dev/spec)."""

NO_TIMES = 2**63 - 1, 0
"""First and last time of no messages, as rosbags writes them [ns]."""

Written: TypeAlias = tuple[Connection, int, bytes | memoryview]
"""Connection, time [ns] and bytes of a message."""

_message_head = struct.Struct("<BQHIQQ").pack
_MESSAGE_HEAD_SIZE = struct.calcsize("<BQHIQQ")
_MESSAGE_FIELDS_SIZE = struct.calcsize("<HIQQ")


class McapStorage:
    """An MCAP file with chunks of about 1 MiB and an index, without compression. A storage of `rosbags.rosbag2.Writer`.

    Args:
        path: Folder of the bag.
        compression: Not used: `rosbags.rosbag2.Writer` gives it to each storage.

    Attributes:
        path: The file.
        counts: Number of messages of each connection in all chunks that have ended, by its identifier.
        times: Time of the first and of the last of these messages [ns].
    """

    def __init__(self, path: Path, compression: object = None) -> None:
        self.path = path / f"{path.name}.mcap"
        self.counts: dict[int, int] = {}
        self.times = NO_TIMES
        self._file = self.path.open("xb")
        self._position = 0
        self._schemas: dict[str, bytes] = {}
        self._channels: list[bytes] = []
        self._chunk_indexes: list[bytes] = []
        self._begin_chunk()
        self._write(MAGIC, _record(HEADER, _text("ros2") + _text(f"rosbags-{version('rosbags')}")))

    def add_msgtype(self, connection: Connection) -> None:
        """Adds the type of a connection."""
        definition = connection.msgdef
        encoding = "ros2msg" if definition.format == MessageDefinitionFormat.MSG else "ros2idl"
        texts = b"".join(map(_text, (connection.msgtype, encoding, definition.data)))
        schema = _record(SCHEMA, struct.pack("<H", len(self._schemas) + 1) + texts)
        self._schemas[connection.msgtype] = schema
        self._add(schema)

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        """Adds a connection, whose type was added before.

        Args:
            connection: The connection.
            offered_qos_profiles: Its QoS profiles, as a text.
        """
        assert isinstance(connection.ext, ConnectionExtRosbag2)
        schema = list(self._schemas).index(connection.msgtype) + 1
        texts = _text(connection.topic) + _text(connection.ext.serialization_format)
        profiles = _text("offered_qos_profiles") + _text(offered_qos_profiles)
        channel = _record(CHANNEL, struct.pack("<HH", connection.id, schema) + texts + _sized(profiles))
        self._channels.append(channel)
        self.counts[connection.id] = 0
        self._add(channel)

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Writes a message of a connection at a time [ns]."""
        self.write_all([(connection, timestamp, data)])

    def write_all(self, messages: Iterable[Written]) -> None:
        """Writes messages."""
        for connection, time_ns, data in messages:
            channel, length = connection.id, len(data)
            self._entries[channel] += (time_ns, self._size)
            self._parts += (_message_head(MESSAGE, _MESSAGE_FIELDS_SIZE + length, channel, 0, time_ns, time_ns), data)
            self._size += _MESSAGE_HEAD_SIZE + length
            if self._size > CHUNK_SIZE:
                self.end_chunk()

    def end_chunk(self) -> None:
        """Writes the chunk and its index, unless it is empty."""
        if not self._parts:
            return
        parts, size, entries = self._parts, self._size, self._entries
        self._begin_chunk()
        first = min((min(each[::2]) for each in entries.values()), default=NO_TIMES[0])
        last = max((max(each[::2]) for each in entries.values()), default=NO_TIMES[1])
        self.times = min(first, self.times[0]), max(last, self.times[1])
        for channel, each in entries.items():
            self.counts[channel] += len(each) // 2
        start = self._position
        fields = struct.pack("<QQQI", first, last, size, 0) + _text("") + struct.pack("<Q", size)
        self._write(struct.pack("<BQ", CHUNK, len(fields) + size) + fields, b"".join(parts))
        end, offsets = self._position, []
        for channel, each in entries.items():
            offsets.append(struct.pack("<HQ", channel, self._position))
            self._write(_record(MESSAGE_INDEX, struct.pack("<H", channel) + _sized(struct.pack(f"<{len(each)}Q", *each))))
        lengths = struct.pack("<Q", self._position - end) + _text("") + struct.pack("<QQ", size, size)
        index = struct.pack("<QQQQ", first, last, start, end - start) + _sized(b"".join(offsets)) + lengths
        self._chunk_indexes.append(index)

    def flush(self) -> None:
        """Passes all complete chunks to the operating system, so that they outlive the process."""
        self._file.flush()

    def close(self, version: int, metadata: str) -> None:
        """Writes the last chunk and the index, and closes the file.

        Args:
            version: Version of the bag, which the metadata have too.
            metadata: The text of metadata.yaml.
        """
        self.end_chunk()
        serialized = _sized(_text("serialized_metadata") + _text(metadata))
        start, record = self._position, _record(METADATA, _text("rosbag2") + serialized)
        self._write(record, _record(DATA_END, bytes(4)))
        metadata_index = _record(METADATA_INDEX, struct.pack("<QQ", start, len(record)) + _text("rosbag2"))
        sizes = len(self._schemas), len(self._channels), 0, 1, len(self._chunk_indexes)
        counts = b"".join(struct.pack("<HQ", *count) for count in sorted(self.counts.items()))
        statistics = struct.pack("<QHIIII2Q", sum(self.counts.values()), *sizes, *self.times) + _sized(counts)
        groups = {
            SCHEMA: [*self._schemas.values()],
            CHANNEL: self._channels,
            CHUNK_INDEX: [_record(CHUNK_INDEX, content) for content in self._chunk_indexes],
            METADATA_INDEX: [metadata_index],
            STATISTICS: [_record(STATISTICS, statistics)],
        }
        starts = []
        for records in groups.values():
            starts.append(self._position)
            self._write(*records)
        summary_end = self._position
        for kind, (first, end) in zip(groups, pairwise([*starts, summary_end]), strict=True):
            if first != end:
                self._write(_record(SUMMARY_OFFSET, struct.pack("<BQQ", kind, first, end - first)))
        self._write(_record(FOOTER, struct.pack("<QQI", starts[0], summary_end, 0)), MAGIC)
        self._file.close()

    def abort(self) -> None:
        """Closes the file without the last chunk and the index."""
        self._file.close()

    def _begin_chunk(self) -> None:
        self._parts: list[bytes | memoryview] = []
        self._size = 0
        self._entries: defaultdict[int, list[int]] = defaultdict(list)
        """Time [ns] and offset of each message in the chunk, one after the other, of each connection."""

    def _add(self, record: bytes) -> None:
        """Adds a record to the chunk."""
        self._parts.append(record)
        self._size += len(record)

    def _write(self, *parts: bytes) -> None:
        for part in parts:
            self._file.write(part)
            self._position += len(part)


def _record(kind: int, content: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(content)) + content


def _sized(data: bytes) -> bytes:
    """Returns bytes after their number."""
    return struct.pack("<I", len(data)) + data


def _text(text: str) -> bytes:
    return _sized(text.encode())
