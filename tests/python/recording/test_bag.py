"""bag: messages of whole bags, of cut ones, and of files that are not bags."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

from mobile_robot_simulator.messages import LaserScan, TFMessage
from mobile_robot_simulator.recording.bag import Bag, BagMessage
from mobile_robot_simulator.recording.recorder import Format
from recordings import FORMATS, assert_same, drive, record

TYPES = (LaserScan.ros_type, TFMessage.ros_type)


def read(path: Path) -> tuple[list[BagMessage], list[str]]:
    bag = Bag(path)
    return list(bag.messages(TYPES)), bag.notes


@pytest.mark.parametrize("format", FORMATS)
def test_messages_of_the_types_with_their_indices(tmp_path: Path, format: Format) -> None:
    written = drive()
    path = record(tmp_path, format, written)
    got, notes = read(path)
    wanted = [each for each in written if each[1].ros_type in TYPES]
    assert not notes and len(got) == len(wanted)
    indices = {"/scan": 0, "/tf": 0}
    for (topic, message, time_ns), each in zip(wanted, got, strict=True):
        assert (each.topic, each.index, each.time_ns) == (topic, indices[topic], max(time_ns, format == "bag"))
        indices[topic] += 1
        assert_same(message, each.content, topic)
    assert [each.index for each in read(tmp_path)[0]] == [each.index for each in got]  # the folder of the recording


@pytest.mark.parametrize("format", FORMATS)
def test_a_bag_is_read_after_a_change_of_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, format: Format
) -> None:
    path = record(tmp_path / "out", format, drive())
    monkeypatch.chdir(path.parent)
    bag = Bag(Path(path.name))
    monkeypatch.chdir(tmp_path)
    assert len(list(bag.messages(TYPES))) == len(read(path)[0])
    assert bag.path == Path(path.name)


@pytest.mark.parametrize("format", ["mcap", "bag"])
def test_a_cut_bag_gives_the_messages_before_the_cut(tmp_path: Path, format: Format) -> None:
    path = record(tmp_path, format, drive(4000))
    file = path / "recording.mcap" if path.is_dir() else path
    data, whole = file.read_bytes(), len(read(path)[0])
    counts = []
    for share in (0.3, 0.9, 0.999):
        file.write_bytes(data[: int(len(data) * share)])
        for each in {path, file}:
            got, notes = read(each)
            assert len(notes) == 1 and "the bag has no end, so its" in notes[0]
            assert [message.index for message in got if message.topic == "/scan"] == list(range(len(got) // 2))
        counts.append(len(got))
    assert 0 < counts[0] < counts[1] <= counts[2] <= whole


@pytest.mark.parametrize("format", FORMATS)
def test_a_bag_cut_anywhere_is_read_or_refused(tmp_path: Path, format: Format) -> None:
    path = record(tmp_path, format, drive(10))
    file = next(path.glob("recording.*")) if path.is_dir() else path
    data = file.read_bytes()
    for length in range(0, len(data), max(1, len(data) // 40)):
        file.write_bytes(data[:length])
        try:
            got, notes = read(path)
        except ValueError as error:
            assert str(path) in str(error)
        else:
            assert notes or format == "sqlite3", (length, len(got))


@pytest.mark.parametrize("format", FORMATS)
def test_a_bag_with_a_damaged_byte_is_read_or_refused(tmp_path: Path, format: Format) -> None:
    """Damaged sizes lead to MemoryError and others in the libraries below."""
    path = record(tmp_path, format, drive(4))
    file = next(path.glob("recording.*")) if path.is_dir() else path
    data = file.read_bytes()
    for place in range(0, len(data), max(1, len(data) // 150)):
        file.write_bytes(data[:place] + bytes([data[place] ^ 0x5A]) + data[place + 1 :])
        try:
            read(path)
        except ValueError as error:
            assert str(path) in str(error)


def test_a_damaged_message_is_named(tmp_path: Path) -> None:
    path = record(tmp_path, "sqlite3", drive())
    import sqlite3

    with sqlite3.connect(path / "recording.db3") as database:
        rows = database.execute("SELECT messages.id FROM messages JOIN topics ON topic_id = topics.id WHERE name = '/scan'")
        number = sorted(row[0] for row in rows)[7]
        database.execute("UPDATE messages SET data = substr(data, 1, 30) WHERE id = ?", [number])
    database.close()
    with pytest.raises(ValueError, match="/scan, message 7: cannot be read"):
        read(path)


def test_what_is_no_bag(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must be a bag or a folder with one \.mcap, \.db3 or \.bag file, got none"):
        Bag(tmp_path)
    (tmp_path / "some.mcap").write_bytes(b"no bag at all")
    with pytest.raises(ValueError, match=r"some\.mcap: cannot be read"):
        read(tmp_path)
    with pytest.raises(FileNotFoundError):
        Bag(tmp_path / "missing")
