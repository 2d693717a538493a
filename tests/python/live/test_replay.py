"""Replay: a recording runs, stops, goes to any time, and refuses to be changed."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("rosbags", reason="the extra `recording` is not installed")

from logs.bags import drive, messages, record
from mobile_robot_simulator.live import inputs
from mobile_robot_simulator.live.replay import SAMPLES, Replay, Way
from mobile_robot_simulator.logs.playback import Playback


@pytest.fixture
def replay(tmp_path: Path) -> Replay:
    """The drive of 3 s. Its first odometry is at 0.1 s."""
    return Replay(Playback(record(tmp_path / "bag", messages())))


def test_time_runs_with_the_wall_clock_times_the_speed_and_stops_at_the_end(replay: Replay) -> None:
    assert replay.duration == 2.9
    replay.turn(0.0)
    replay.turn(0.0625)
    assert (replay.time, replay.now_ns) == (0.062, 162_000_000)  # whole milliseconds; the rest is owed
    replay.do(inputs.Speed(factor=4.0))
    replay.turn(0.125)
    assert replay.time == 0.312
    replay.do(inputs.Pause(paused=True))
    replay.turn(0.1875)
    assert replay.time == 0.312
    replay.do(inputs.Pause(paused=False))
    for step in range(100):
        replay.turn(0.25 + 0.0625 * step)
    assert replay.time == 2.9 and replay.pace.paused
    replay.do(inputs.Pause(paused=False))
    assert replay.time == 0.0 and not replay.pace.paused


@pytest.mark.parametrize(("wanted", "reached"), [(0.0, 0.0), (1.25, 1.25), (2.9, 2.9), (1e9, 2.9)])
def test_viewers_go_to_any_time(replay: Replay, wanted: float, reached: float) -> None:
    replay.do(inputs.Seek(time=wanted))
    assert replay.time == reached
    replay.do(inputs.Reset())
    assert replay.time == 0.0


def test_a_step_stops_the_time(replay: Replay) -> None:
    replay.do(inputs.Step(seconds=0.5))
    assert (replay.time, replay.pace.paused) == (0.5, True)


@pytest.mark.parametrize("wanted", [inputs.Drive(robot="", vx=1.0), inputs.SetPose(robot="", x=1, y=1, yaw=0)])
def test_what_happened_cannot_be_changed(replay: Replay, wanted: inputs.Input) -> None:
    with pytest.raises(ValueError, match="this is a recording"):
        replay.do(wanted)


def test_the_way_until_a_time_is_that_of_the_robot(replay: Replay) -> None:
    trail = replay.ways[""].until(1_500_000_000)
    half = len(trail.points)
    truth = drive()[1].truth
    for time in (0.1, 1.5):
        pose = truth.pose_at(time)
        point = trail.points[0 if time == 0.1 else -1]
        assert point is not None
        assert max(abs(point[0] - pose.x), abs(point[1] - pose.y)) < 0.03  # a point every 2 cm
    epoch = trail.epoch
    assert len(replay.ways[""].until(3_000_000_000).points) > half and trail.epoch == epoch
    assert len(replay.ways[""].until(1_500_000_000).points) == half and trail.epoch != epoch
    assert replay.ways[""].until(0).points == []


class Endless(Playback):
    """A recording of a robot that stands still for a day."""

    def __init__(self) -> None:
        self.begin_ns, self.end_ns, self.asked = 0, 86_400 * 10**9, 0

    def robot_at(self, name: str, time_ns: int) -> None:
        self.asked += 1


def test_the_way_of_a_long_recording_is_sampled_less_often() -> None:
    playback = Endless()
    Way(playback, "")
    assert playback.asked == SAMPLES + 1
