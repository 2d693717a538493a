"""Bag: the messages of a ROS 1 bag, a ROS 2 bag or an MCAP file, also of one without an end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from rosbags.rosbag1 import Reader as Ros1Reader
from rosbags.rosbag2 import Reader as Ros2Reader

from ..messages import TFMessage
from ..quoting import quoted, shortened
from ..user_files import open_regular
from .complete_messages import Stored, mcap_messages, ros1_messages
from .folder import NAME
from .serialization import ros1_types, ros2_types

ROS1_MAGIC = b"#ROSBAG V2.0\n"
"""First bytes of a ROS 1 bag."""

_OTHER_NAMES = {"tf/msg/tfMessage": TFMessage.ros_type}


@dataclass(frozen=True)
class BagMessage:
    """A message of a bag.

    Attributes:
        topic: Its topic.
        ros_type: Its type, as ROS 2 writes it.
        index: Its position among the messages of the topic, from 0, in the order of the bag.
        time_ns: Time at which it was recorded [ns].
        content: The message, with the fields of ROS 2.
    """

    topic: str
    ros_type: str
    index: int
    time_ns: int
    content: Any


class Bag:
    """A bag on the disk.

    Args:
        path: A ROS 1 bag, an MCAP or SQLite file of ROS 2, the folder of a ROS 2 bag, or the folder given to `run --out`.

    Attributes:
        path: The file or folder that is read.
        is_ros1: It is a ROS 1 bag.
        notes: What was passed over, complete once all messages have been read.

    Raises:
        OSError: The path cannot be read.
        ValueError: The file is not a bag.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.notes = _found(path), list[str]()
        self._file = self.path.absolute()  # The working directory may change before the messages are read.
        self.is_ros1 = False
        if not self.path.is_dir():
            with open_regular(self.path) as file:
                start = file.read(len(ROS1_MAGIC))
            self.is_ros1 = start == ROS1_MAGIC
            if not self.is_ros1 and self.path.suffix not in (".mcap", ".db3"):
                needed = f"must be a ROS 1 bag, which begins with {quoted(ROS1_MAGIC)}, or a file named .mcap or .db3"
                got = f"one that begins with {quoted(start)}" if start else "an empty one"
                raise ValueError(f"{self.path}: {needed}, got {got}")

    def messages(
        self, ros_types: Collection[str], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[BagMessage]:
        """Yields the messages of some types, in the order in which they were recorded.

        Args:
            ros_types: The types, as ROS 2 writes them.
            start_ns: Messages recorded before this time are passed over, and not counted in `BagMessage.index` [ns].
            stop_ns: Messages recorded at or after this time are passed over [ns].

        Raises:
            OSError: The bag cannot be read.
            ValueError: The bag or a message is damaged. The message gives the topic and the index.
        """
        counts = Counter[str]()
        for topic, stored_type, time_ns, data in self._stored(start_ns, stop_ns):
            ros_type = _OTHER_NAMES.get(stored_type, stored_type)
            if ros_type not in ros_types:
                continue
            index = counts[topic]
            counts[topic] += 1
            try:
                if self.is_ros1:
                    content: Any = ros1_types().deserialize_ros1(data, ros_type)
                else:
                    content = ros2_types().deserialize_cdr(data, ros_type)
            except Exception as error:  # whatever the bytes of a damaged message lead to
                raise ValueError(f"{self.path}: {topic}, message {index}: cannot be read: {_text_of(error)}") from None
            yield BagMessage(topic, ros_type, index, time_ns, content)

    def _stored(self, start_ns: int | None, stop_ns: int | None) -> Iterator[Stored]:
        count = 0
        try:
            reader: Any = (Ros1Reader if self.is_ros1 else Ros2Reader)(self._file)
            reader.open()
        except Exception as error:  # rosbags has no common class for the errors of its readers and of SQLite
            _check_is_damage(error)
            for stored in self._without_end(error):
                if (start_ns is None or start_ns <= stored[2]) and (stop_ns is None or stored[2] < stop_ns):
                    yield stored
            return
        try:
            for connection, time_ns, data in reader.messages(start=start_ns, stop=stop_ns):
                count += 1
                yield connection.topic, connection.msgtype, time_ns, bytes(data)
        except Exception as error:
            _check_is_damage(error)
            raise ValueError(f"{self.path}: cannot be read after {count} messages: {_text_of(error)}") from None
        finally:
            reader.close()

    def _without_end(self, error: Exception) -> Iterator[Stored]:
        """Yields all complete messages of a bag that cannot be opened as a whole."""
        files = sorted(self._file.glob("*.mcap")) if self._file.is_dir() else [self._file]
        count = 0
        for file in files:
            if self.is_ros1:
                messages = ros1_messages(file)
            elif file.suffix == ".mcap":
                messages = self._mcap_messages(file)
            else:
                continue
            try:
                for message in messages:
                    count += 1
                    yield message
            except Exception as damage:
                _check_is_damage(damage)
                raise ValueError(f"{self.path}: cannot be read after {count} messages: {_text_of(damage)}") from None
        if not count:
            raise ValueError(f"{self.path}: cannot be read: {_text_of(error)}")
        self.notes.append(f"the bag has no end, so its {count} complete messages were read ({_text_of(error)})")

    @staticmethod
    def _mcap_messages(file: Path) -> Iterator[Stored]:
        with TemporaryDirectory() as folder:
            yield from mcap_messages(file, Path(folder) / "copy.mcap")


def _check_is_damage(error: Exception) -> None:
    """Raises an error of the operating system that names a file. A seek to a damaged position gives one that names none."""
    if isinstance(error, OSError) and error.filename is not None:
        raise error


def _text_of(error: Exception) -> str:
    """Returns what an error says. A damaged size leads to a MemoryError, which says nothing."""
    return shortened(error) or type(error).__name__


def _found(path: Path) -> Path:
    """Returns the bag that a path names: itself, or the one in a folder."""
    if not path.is_dir() or (path / "metadata.yaml").is_file():
        return path
    for inner in (path / NAME, path / f"{NAME}.bag"):
        if inner.exists():
            return inner
    files = [file for file in sorted(path.iterdir()) if file.suffix in (".mcap", ".db3", ".bag")]
    if len(files) != 1:
        names = ", ".join(file.name for file in files[:5]) or "none"
        raise ValueError(f"{path}: must be a bag or a folder with one .mcap, .db3 or .bag file, got {names}")
    return files[0]
