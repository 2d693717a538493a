"""DeferredRecorder: the same recording, whether messages waited in memory or on disk; and nothing is left unasked."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.recording import deferred as spools
from mobile_robot_simulator.recording.deferred import DeferredRecorder

COUNT = 50


def filled(folder: Path, count: int = COUNT) -> DeferredRecorder:
    spool = DeferredRecorder(folder)
    for number in range(count):
        spool.take("/twist", mrs.messages.Twist(linear=mrs.messages.Vector3(x=float(number))), number)
    return spool


def test_the_recording_is_the_same_from_memory_and_from_disk(tmp_path, monkeypatch):
    memory = filled(tmp_path / "memory").leave()
    monkeypatch.setattr(spools, "MOST_IN_MEMORY", 20)
    spool = filled(tmp_path / "disk")
    assert not spool._messages
    disk = spool.leave()
    assert (disk / "recording.mcap").read_bytes() == (memory / "recording.mcap").read_bytes()
    assert spool.leave() == disk
    spool.drop()
    assert (disk / "recording.mcap").exists()


@pytest.mark.parametrize("most", [20, 1000])
def test_what_is_dropped_leaves_nothing_and_takes_nothing(tmp_path, monkeypatch, most):
    monkeypatch.setattr(spools, "MOST_IN_MEMORY", most)
    spool = filled(tmp_path)
    assert (tmp_path / "recording").exists() == (most == 20)
    spool.drop()
    spool.take("/twist", mrs.messages.Twist(), COUNT)
    assert not list(tmp_path.iterdir()) and not spool._messages
    with pytest.raises(ValueError, match="were dropped"):
        spool.leave()


@pytest.mark.parametrize("most", [20, 1000])
def test_what_goes_wrong_is_told_when_the_recording_is_wanted(tmp_path, monkeypatch, most):
    monkeypatch.setattr(spools, "MOST_IN_MEMORY", most)
    spool = filled(tmp_path)
    spool.take("/twist", mrs.messages.String("not a twist"), COUNT)
    spool.take("/twist", mrs.messages.Twist(), COUNT)
    with pytest.raises(ValueError, match="topic /twist carries geometry_msgs/msg/Twist, got std_msgs/msg/String"):
        spool.leave()


def test_without_rosbags_nothing_is_kept_for_long(tmp_path, monkeypatch):
    monkeypatch.setattr(spools, "MOST_IN_MEMORY", 20)
    monkeypatch.setitem(sys.modules, "mobile_robot_simulator.recording.recorder", None)
    spool = filled(tmp_path)
    assert not spool._messages
    with pytest.raises(ImportError):
        spool.leave()
