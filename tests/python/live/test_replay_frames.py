"""ReplayFrames: the parts of a frame are those of the recording at its time."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

from logs.bags import changed, drive, messages, record
from mobile_robot_simulator.live import inputs
from mobile_robot_simulator.live.replay import Replay
from mobile_robot_simulator.live.replay_frames import CELL, MARGIN, ReplayFrames
from mobile_robot_simulator.logs.playback import Playback


def frames_of(path: Path) -> ReplayFrames:
    return ReplayFrames(Replay(Playback(path)), "a drive")


def parts(frames: ReplayFrames, time: float) -> dict[str, Any]:
    frames._replay.do(inputs.Seek(time=time))
    return {name: json.loads(part) for name, part in frames.make().parts.items()}


def test_a_frame_shows_the_drive_at_its_time(tmp_path: Path) -> None:
    frames, simulation = frames_of(record(tmp_path / "bag", messages())), drive()[1]
    shown = parts(frames, 0.9)
    pose = simulation.truth.pose_at(1.0)
    assert shown["now"]["time"] == 0.9
    assert shown["now"]["robots"][""]["pose"] == pytest.approx(tuple(pose), abs=1e-4)
    assert shown["now"]["robots"][""]["velocity"] == [0.6, 0.0, 0.4]
    assert shown["replay"] == {"duration": 2.9, "begin": 0.1}
    assert (shown["map"]["title"], shown["map"]["rows"], shown["map"]["resolution"]) == ("a drive", 200, 0.1)
    assert np.array_equal(frames.grid.cells, simulation.grid.cells)
    scan = shown["scan::/scan"]
    points = np.frombuffer(base64.b64decode(scan["points"]), np.float32).reshape(-1, 2)
    hits = np.frombuffer(base64.b64decode(scan["hits"]), np.uint8)
    assert scan["stamp"] == 0.9 and len(points) == len(hits) == scan["count"] == 31
    np.testing.assert_allclose(np.abs(points - 10.0).max(axis=1), 9.9, atol=1e-4)  # the walls of the hall


def test_frames_of_the_same_time_are_the_same_in_any_order(tmp_path: Path) -> None:
    frames = frames_of(record(tmp_path / "bag", messages()))
    first = parts(frames, 1.3)
    parts(frames, 2.9)
    assert parts(frames, 1.3) == first


def test_without_a_map_there_is_room_around_the_paths(tmp_path: Path) -> None:
    frames = frames_of(record(tmp_path / "bag", [each for each in messages() if each[0] != "/map"]))
    shown = parts(frames, 0.0)
    assert (frames.grid.cells == -1).all() and shown["map"]["resolution"] == CELL
    start, end = drive()[1].truth.pose_at(0.1), drive()[1].truth.pose_at(3.0)
    low = shown["map"]["origin"]
    high = low[0] + CELL * shown["map"]["columns"], low[1] + CELL * shown["map"]["rows"]
    for pose in (start, end):
        assert low[0] <= pose.x - MARGIN + 0.03 and pose.x + MARGIN - 0.03 <= high[0]
        assert low[1] <= pose.y - MARGIN + 0.03 and pose.y + MARGIN - 0.03 <= high[1]


def test_what_is_wrong_is_told_once_and_the_rest_is_shown(tmp_path: Path) -> None:
    recorded = changed("/scan", lambda scan: setattr(scan, "range_max", -1.0), 9)
    frames = frames_of(record(tmp_path / "bag", recorded))
    for _ in range(2):
        shown = parts(frames, 0.9)
        assert "scan::/scan" not in shown and shown["now"]["robots"]
    assert len(frames._replay.notes) == 1 and "/scan, stamp 1.000000000 s" in frames._replay.notes[0]
    assert "scan::/scan" in parts(frames, 1.0)
