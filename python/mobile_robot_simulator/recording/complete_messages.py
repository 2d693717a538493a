"""Complete messages of bags without an end: what was written before the process was killed or the file was cut."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, TypeAlias

from rosbags.rosbag1.reader import Header, ReaderError, RecordType, decompressors
from rosbags.rosbag2 import ReaderError as McapError
from rosbags.rosbag2.storage_mcap import McapReader

Stored: TypeAlias = tuple[str, str, int, bytes]
"""Topic, type, time [ns] and bytes of a message."""

_MCAP_MAGIC = b"\x89MCAP0\r\n"
_MCAP_FOOTER = b"\x02" + (20).to_bytes(8, "little") + bytes(20)
_MCAP_DATA_END, _MCAP_FOOTER_CODE = 0x0F, 0x02


def mcap_messages(file: Path, copy: Path) -> Iterator[Stored]:
    """Yields the messages of all complete records of an MCAP file, in the order of the file.

    Rosbags needs an end of the file, not an index, so a copy gets an end.

    Args:
        file: The MCAP file.
        copy: File to create for the copy. It is removed after the last message.
    """
    length = file.stat().st_size
    with file.open("rb") as source, copy.open("wb") as target:
        target.write(source.read(len(_MCAP_MAGIC)))
        while len(head := source.read(9)) == 9 and head[0] not in (_MCAP_DATA_END, _MCAP_FOOTER_CODE):
            size = int.from_bytes(head[1:], "little")
            if size > length or len(content := source.read(size)) < size:
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


def ros1_messages(file: Path) -> Iterator[Stored]:
    """Yields the messages of all complete chunks of a ROS 1 bag, in the order of the file.

    Args:
        file: The bag.

    Raises:
        KeyError: A chunk is compressed in an unknown way.
    """
    topics: dict[int, tuple[str, str]] = {}
    with file.open("rb") as source:
        source.readline()
        for header, chunk in _ros1_records(source):
            if header.get_uint8("op") != RecordType.CHUNK:
                continue
            unpack = decompressors[header.get_string("compression")]
            for inner, data in _ros1_records(BytesIO(unpack(chunk))):
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
