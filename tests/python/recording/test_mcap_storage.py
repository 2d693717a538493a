"""McapStorage: the bytes of the MCAP writer of rosbags, whatever is written."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from rosbags.interfaces import Connection
from rosbags.rosbag2 import StoragePlugin, Writer

from mobile_robot_simulator.recording.mcap_storage import CHUNK_SIZE, McapStorage, Written
from mobile_robot_simulator.recording.ros2_bag import Ros2Bag, offered_qos
from mobile_robot_simulator.recording.serialization import ros2_types
from recordings import contents, drive, record

SEED = 5
TOPICS = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/odom": "nav_msgs/msg/Odometry",
    "/wheels": "nav_msgs/msg/Odometry",
    "/läser": "std_msgs/msg/String",
}
CASES = {
    "no messages": [],
    "one message": [("/odom", 7, 100)],
    "time 0 and an empty message": [("/odom", 0, 0), ("/scan", 2**63 - 1, 1)],
    "times that decrease": [("/odom", 9, 4), ("/scan", 3, 4), ("/odom", 5, 4)],
    "a message larger than a chunk": [("/scan", 1, 5), ("/odom", 2, 3 * CHUNK_SIZE), ("/scan", 3, 5)],
    # The head of a message has 31 bytes. The first chunk also has the definition of the messages.
    "a chunk that is full to the last byte": [("/odom", 1, CHUNK_SIZE), ("/odom", 2, CHUNK_SIZE - 31), ("/odom", 3, 5)],
}


def drawn() -> list[tuple[str, int, int]]:
    """Returns topic, time and length of messages for several chunks, in which topics begin one after another."""
    generator = random.Random(SEED)
    topics = list(TOPICS)
    return [
        (generator.choice(topics[: 1 + number // 1000]), generator.randrange(10**12), generator.randrange(2000))
        for number in range(6000)
    ]


def bytes_of(length: int) -> bytes:
    return random.Random(length).randbytes(length)


def written_by_rosbags(folder: Path, messages: list[tuple[str, int, int]]) -> dict[str, bytes]:
    """Returns the files of a bag that rosbags alone has written, with the connections of another bag."""
    connections: dict[str, Connection] = {}
    path = folder / "rosbags" / "recording"
    path.parent.mkdir(parents=True)
    with Writer(path, version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, time_ns, length in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(
                    topic, TOPICS[topic], typestore=ros2_types(), offered_qos_profiles=[offered_qos(topic)]
                )
            writer.write(connections[topic], time_ns, bytes_of(length))
    return contents(path)


def written_by_us(folder: Path, messages: list[tuple[str, int, int]], batch: int) -> dict[str, bytes]:
    folder.mkdir(parents=True)
    bag, connections = Ros2Bag(folder, "mcap"), dict[str, Connection]()
    for first in range(0, len(messages), batch):
        rows: list[Written] = []
        for topic, time_ns, length in messages[first : first + batch]:
            if topic not in connections:
                bag.write_all(rows)
                rows, connections[topic] = [], bag.connect(topic, TOPICS[topic])
            rows.append((connections[topic], time_ns, bytes_of(length)))
        bag.write_all(rows)
        bag.flush()
    bag.close()
    return contents(bag.path)


@pytest.mark.parametrize("messages", CASES.values(), ids=CASES)
def test_the_files_are_those_of_rosbags(tmp_path: Path, messages: list[tuple[str, int, int]]) -> None:
    assert written_by_us(tmp_path / "ours", messages, 2) == written_by_rosbags(tmp_path, messages)


@pytest.mark.parametrize("batch", [1, 1024, 10_000])
def test_the_files_are_those_of_rosbags_however_many_messages_come_at_once(tmp_path: Path, batch: int) -> None:
    expected = written_by_rosbags(tmp_path, drawn())
    assert len(expected["recording.mcap"]) > 5 * CHUNK_SIZE
    assert written_by_us(tmp_path / "ours", drawn(), batch) == expected


def test_a_recorded_drive_has_the_files_that_rosbags_writes(tmp_path: Path) -> None:
    """All of it, with the way from the recorder to the file."""
    ours = contents(record(tmp_path / "ours", "mcap", drive()))
    folder = tmp_path / "rosbags"
    folder.mkdir()
    with Writer(folder / "recording", version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        connections: dict[str, Connection] = {}
        for topic, message, time_ns in drive():
            if topic not in connections:
                connections[topic] = writer.add_connection(
                    topic, message.ros_type, typestore=ros2_types(), offered_qos_profiles=[offered_qos(topic)]
                )
            data = ros2_types().serialize_cdr(message, message.ros_type, little_endian=True)
            writer.write(connections[topic], time_ns, data)
    assert contents(folder / "recording") == ours


def test_complete_chunks_are_in_the_file_after_a_flush(tmp_path: Path) -> None:
    folder = tmp_path / "bag"
    folder.mkdir()
    bag = Ros2Bag(folder, "mcap")
    connection = bag.connect("/odom", TOPICS["/odom"])
    bag.write_all([(connection, 1, bytes(CHUNK_SIZE)), (connection, 2, bytes(1000))])
    bag.flush()
    file = bag.path / "recording.mcap"
    assert CHUNK_SIZE < file.stat().st_size == bag._storage._file.tell()  # the file object counts what it has not passed on
    bag.abort()
    assert not file.read_bytes().endswith(b"\x89MCAP0\r\n")


def test_a_file_that_exists_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / f"{tmp_path.name}.mcap").write_bytes(b"older")
    with pytest.raises(FileExistsError):
        McapStorage(tmp_path)
