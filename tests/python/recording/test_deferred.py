"""DeferredRecorder: the same recording from memory and from disk, and no file unless it is saved."""

from __future__ import annotations

import sys
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from disks import small_disk
from mobile_robot_simulator.recording import deferred
from mobile_robot_simulator.recording.deferred import DeferredRecorder

COUNT = 50


def filled(folder: Path, count: int = COUNT) -> DeferredRecorder:
    recorder = DeferredRecorder(folder)
    for number in range(count):
        recorder.write("/twist", mrs.messages.Twist(linear=mrs.messages.Vector3(x=float(number))), number)
    return recorder


def test_the_recording_is_the_same_from_memory_and_from_disk(tmp_path, monkeypatch):
    memory = filled(tmp_path / "memory").save()
    monkeypatch.setattr(deferred, "MOST_IN_MEMORY", 20)
    recorder = filled(tmp_path / "disk")
    assert not recorder._messages
    disk = recorder.save()
    assert (disk / "recording.mcap").read_bytes() == (memory / "recording.mcap").read_bytes()
    assert recorder.save() == disk
    recorder.discard()
    assert (disk / "recording.mcap").exists()


def test_the_recording_stays_in_its_folder_if_the_working_directory_changes(tmp_path, monkeypatch):
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    recorder = filled(Path("out"))
    monkeypatch.chdir("elsewhere")
    assert recorder.save() == tmp_path / "out" / "recording"
    assert (tmp_path / "out" / "recording" / "recording.mcap").is_file()


def test_a_call_that_builds_a_message_is_made_when_the_recording_is_saved(tmp_path):
    calls = []

    def twist(number: int) -> mrs.messages.Twist:
        calls.append(number)
        return mrs.messages.Twist(linear=mrs.messages.Vector3(x=float(number)))

    recorder = DeferredRecorder(tmp_path / "calls")
    for number in range(COUNT):
        recorder.write("/twist", partial(twist, number), number)
    assert not calls
    built = filled(tmp_path / "built").save()
    assert (recorder.save() / "recording.mcap").read_bytes() == (built / "recording.mcap").read_bytes()
    assert calls == list(range(COUNT))


@pytest.mark.parametrize("most", [20, 1000])
def test_discarding_deletes_all_messages_and_ignores_later_ones(tmp_path, monkeypatch, most):
    monkeypatch.setattr(deferred, "MOST_IN_MEMORY", most)
    recorder = filled(tmp_path)
    assert (tmp_path / "recording.unfinished").exists() == (most == 20)
    recorder.discard()
    recorder.write("/twist", mrs.messages.Twist(), COUNT)
    assert not list(tmp_path.iterdir()) and not recorder._messages
    with pytest.raises(ValueError, match="were discarded"):
        recorder.save()


def test_discarding_needs_no_space_on_the_disk(monkeypatch):
    monkeypatch.setattr(deferred, "MOST_IN_MEMORY", 20)
    with small_disk(kilobytes=64) as folder:
        recorder = filled(folder)
        with suppress(OSError):
            (folder / "more").write_bytes(bytes(1024 * 64))
        recorder.discard()
        assert [item.name for item in folder.iterdir()] == ["more"]


@pytest.mark.parametrize("most", [20, 1000])
def test_errors_are_raised_when_the_recording_is_saved(tmp_path, monkeypatch, most):
    monkeypatch.setattr(deferred, "MOST_IN_MEMORY", most)
    recorder = filled(tmp_path)
    recorder.write("/twist", mrs.messages.String("not a twist"), COUNT)
    recorder.write("/twist", mrs.messages.Twist(), COUNT)
    with pytest.raises(ValueError, match="topic /twist carries geometry_msgs/msg/Twist, got std_msgs/msg/String"):
        recorder.save()


def test_without_rosbags_messages_are_dropped_and_saving_fails(tmp_path, monkeypatch):
    monkeypatch.setattr(deferred, "MOST_IN_MEMORY", 20)
    monkeypatch.setitem(sys.modules, "mobile_robot_simulator.recording.recorder", None)
    recorder = filled(tmp_path)
    assert not recorder._messages
    with pytest.raises(ImportError):
        recorder.save()


def test_a_call_is_made_with_all_its_arguments(tmp_path):
    def text(*words: str, end: str = ".") -> mrs.messages.String:
        return mrs.messages.String(" ".join(words) + end)

    calls = [partial(text), partial(text, "one"), partial(text, "one", "two", "three"), partial(text, "one", end="!")]
    recorders = [DeferredRecorder(tmp_path / name) for name in ("calls", "built")]
    for time_ns, call in enumerate(calls):
        recorders[0].write("/text", call, time_ns)
        recorders[1].write("/text", call(), time_ns)
    called, built = (recorder.save() / "recording.mcap" for recorder in recorders)
    assert called.read_bytes() == built.read_bytes()
