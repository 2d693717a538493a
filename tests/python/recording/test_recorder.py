"""Recorder: recordings are read back as they were written, have the same bytes every time, and are always complete."""

from __future__ import annotations

import importlib
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.message_recipe import MessageRecipe
from mobile_robot_simulator.recording import recorder as recording
from mobile_robot_simulator.recording.recorder import Format, Recorder
from recordings import FORMATS, SPECIAL, assert_same, contents, drive, read, record


@pytest.mark.parametrize("format", FORMATS)
def test_a_drive_is_read_back_field_by_field(tmp_path: Path, format: Format) -> None:
    written = drive()
    got = read(record(tmp_path, format, written))
    assert len(got) == len(written)
    # SQLite and chunks do not keep the order of messages with the same time.
    by_topic_and_time: Callable[[Any], Any] = lambda entry: (entry[0], entry[2])  # noqa: E731
    floor = 1 if format == "bag" else 0
    for (topic, message, time_ns), (got_topic, got_message, got_time_ns) in zip(
        sorted(written, key=by_topic_and_time), sorted(got, key=by_topic_and_time), strict=True
    ):
        assert (topic, max(time_ns, floor)) == (got_topic, got_time_ns)
        assert_same(message, got_message, topic)


def test_messages_are_copied_when_written(tmp_path: Path) -> None:
    scan = ros.LaserScan(ranges=np.ones(3, np.float32))
    with Recorder(tmp_path) as recorder:
        recorder.write("/scan", scan, 1)
        scan.ranges[:] = 2
        scan.header.frame_id = "other"
    ((_, got, _),) = read(recorder.path)
    assert got.ranges.tolist() == [1, 1, 1]
    assert got.header.frame_id == ""


@pytest.mark.parametrize("format", FORMATS)
def test_several_batches_and_chunks(tmp_path: Path, format: Format) -> None:
    count = 2 * recording._BATCH + 3
    data = np.zeros(1000, np.int8)
    path = record(tmp_path, format, [("/map", ros.OccupancyGrid(data=data), time_ns) for time_ns in range(1, count)])
    assert [time_ns for _, _, time_ns in read(path)] == list(range(1, count))


@pytest.mark.parametrize("format", FORMATS)
def test_an_empty_recording_can_be_opened(tmp_path: Path, format: Format) -> None:
    assert read(record(tmp_path, format, [])) == []


def test_names_of_files(tmp_path: Path) -> None:
    for format, names in (
        ("mcap", ["metadata.yaml", "recording.mcap"]),
        ("sqlite3", ["metadata.yaml", "recording.db3"]),
        ("bag", ["recording.bag"]),
    ):
        path = record(tmp_path / "deep" / format, format, drive(1))  # type: ignore[arg-type]
        assert path.parent == tmp_path / "deep" / format
        assert list(path.parent.iterdir()) == [path]
        assert list(contents(path)) == names


SCRIPT = """
import sys
from pathlib import Path
sys.path.insert(0, {tests!r})
from recordings import drive, record
record(Path({folder!r}), {format!r}, drive())
"""


@pytest.mark.slow
@pytest.mark.parametrize("format", FORMATS)
def test_the_same_messages_give_the_same_bytes(tmp_path: Path, format: Format) -> None:
    first, second = (contents(record(tmp_path / name, format, drive())) for name in ("first", "second"))
    assert first == second
    script = SCRIPT.format(tests=str(Path(__file__).parents[1]), folder=str(tmp_path / "third"), format=format)
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)
    (third,) = (tmp_path / "third").iterdir()
    assert contents(third) == first


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_an_error_leaves_a_complete_recording(tmp_path: Path, format: Format, error: type[BaseException]) -> None:
    with pytest.raises(error), Recorder(tmp_path, format=format) as recorder:
        recorder.write("/clock", ros.Clock(), 5)
        raise error
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [5]


@pytest.mark.slow
@pytest.mark.parametrize("format", FORMATS)
def test_an_interruption_at_any_moment_leaves_a_complete_recording(
    tmp_path: Path, format: Format, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(recording, "_BATCH", 2)
    earlier = signal.signal(signal.SIGALRM, interrupt)
    try:
        for attempt in range(12):
            written = 0
            with pytest.raises(KeyboardInterrupt), Recorder(tmp_path, format=format, overwrite=True) as recorder:
                signal.setitimer(signal.ITIMER_REAL, 0.002 + 0.0017 * attempt)
                while True:
                    recorder.write("/scan", ros.LaserScan(ranges=SPECIAL), written + 1)
                    written += 1
            times = [time_ns for _, _, time_ns in read(recorder.path)]
            assert len(times) in (written, written + 1)
            assert times == list(range(1, len(times) + 1))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, earlier)


def test_closing_twice_is_harmless_and_writing_afterwards_an_error(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path)
    recorder.write("/clock", ros.Clock(), 5)
    recorder.close()
    before = contents(recorder.path)
    recorder.close()
    assert contents(recorder.path) == before
    with pytest.raises(ValueError, match="is closed"):
        recorder.write("/clock", ros.Clock(), 6)


def test_a_full_disk_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("mobile_robot_simulator.recording.mcap_storage.McapStorage.write_all", full)
    recorder = Recorder(tmp_path)
    recorder.write("/clock", ros.Clock(), 5)
    with pytest.raises(OSError, match="No space left"):
        recorder.close()
    recorder.close()


@pytest.mark.parametrize(("format", "end"), [("mcap", 2**63), ("sqlite3", 2**63), ("bag", 2**32 * 10**9)])
def test_times_out_of_range_are_refused(tmp_path: Path, format: Format, end: int) -> None:
    with Recorder(tmp_path, format=format) as recorder:
        for time_ns in (-1, end):
            with pytest.raises(ValueError, match=rf"time_ns .* got {time_ns}"):
                recorder.write("/clock", ros.Clock(), time_ns)
        with pytest.raises(TypeError, match=r"time_ns must be an integer, got 0\.5"):
            recorder.write("/clock", ros.Clock(), 0.5)  # type: ignore[arg-type]
        recorder.write("/clock", ros.Clock(), np.int64(3))  # type: ignore[arg-type]
        recorder.write("/clock", ros.Clock(), end - 2)
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [3, end - 2]


def test_a_topic_has_one_type(tmp_path: Path) -> None:
    with Recorder(tmp_path) as recorder:
        recorder.write("/cmd_vel", ros.Twist(), 1)
        with pytest.raises(ValueError, match=r"/cmd_vel carries geometry_msgs/msg/Twist, got .*TwistStamped"):
            recorder.write("/cmd_vel", ros.TwistStamped(), 2)


def test_names_of_topics_are_those_of_a_simulation(tmp_path: Path) -> None:
    with Recorder(tmp_path) as recorder:
        for topic in ("scan", "/scan", "scan"):
            recorder.write(topic, ros.Clock(), 1)
        for name in ("", "/", "//"):
            with pytest.raises(ValueError, match=f"a topic or service must have a name, got '{name}'"):
                recorder.write(name, ros.Clock(), 1)
        with pytest.raises(TypeError, match="the name of a topic or service must be a text, got 3"):
            recorder.write(3, ros.Clock(), 1)  # type: ignore[arg-type]
    assert [topic for topic, _, _ in read(recorder.path)] == ["/scan"] * 3


@pytest.mark.parametrize("wrong", [None, "text", ros.Clock, partial(str)])
def test_what_is_no_message_is_refused(tmp_path: Path, wrong: Any) -> None:
    with Recorder(tmp_path) as recorder:
        with pytest.raises(TypeError, match=r"the message must be one of mobile_robot_simulator\.messages, got "):
            recorder.write("/clock", wrong, 1)
        recorder.write("/clock", ros.Clock(), 1)
    assert len(read(recorder.path)) == 1


@pytest.mark.parametrize("wrong", [None, 3, b"out"])
def test_what_is_no_path_is_refused(wrong: Any) -> None:
    for call in (Recorder, recording.recover):
        with pytest.raises(TypeError, match=f"the path of a recording must be a text or a Path, got {wrong}"):
            call(wrong)


@pytest.mark.parametrize("format", FORMATS)
def test_calls_that_build_messages_give_the_bytes_of_the_messages(tmp_path: Path, format: Format) -> None:
    for name, lazily in (("built", False), ("lazy", True)):
        with Recorder(tmp_path / name, format=format) as recorder:
            simulation = mrs.Simulation(mrs.OccupancyGrid(np.zeros((40, 40), np.int8), resolution=0.25), seed=3)
            (simulation.record_lazily if lazily else simulation.record)(recorder.write)
            simulation.publish("/cmd_vel", ros.Twist(ros.Vector3(0.3), ros.Vector3(z=0.2)))
            simulation.run_for(2.0)
            simulation.laser.set_parameters(laser_intensities=True)
            simulation.robot.set_parameters(publish_map_transform=False)
            simulation.run_for(0.5)
            simulation.robot.set_parameters(odometry_alphas=[0.1] * 6)
            simulation.run_for(0.5)
    assert contents(recorder.path) == contents(tmp_path / "built" / recorder.path.name)
    assert {topic for topic, _, _ in read(recorder.path)} >= {"/odom", "/tf", "/scan", "/clock"}


def test_what_a_call_builds_is_checked_as_a_message(tmp_path: Path) -> None:
    point = MessageRecipe(ros.Point, lambda x: (x, 0.0, 0.0))
    for build in (point, lambda x: ros.Point(x)):
        with Recorder(tmp_path, overwrite=True) as recorder:
            recorder.write("/point", partial(build, 1.5), 1)
            with pytest.raises(ValueError, match="topic /point carries geometry_msgs/msg/Point, got std_msgs/msg/Bool"):
                recorder.write("/point", partial(MessageRecipe(ros.Bool, lambda: (True,))), 2)
            with pytest.raises(ValueError, match="cannot record this geometry_msgs/msg/Point"):
                recorder.write("/point", partial(build, "far"), 3)
            with pytest.raises(TypeError, match="argument"):
                recorder.write("/point", partial(build), 4)
            recorder.write("/point", ros.Point(2.5), 5)
        assert [(got.x, time_ns) for _, got, time_ns in read(recorder.path)] == [(1.5, 1), (2.5, 5)]


def test_unknown_formats_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="one of mcap, bag, sqlite3, got 'csv'"):
        Recorder(tmp_path / "new", format="csv")  # type: ignore[arg-type]
    assert not (tmp_path / "new").exists()


def test_without_rosbags_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rosbags.interfaces", None)
    monkeypatch.delitem(sys.modules, "mobile_robot_simulator.recording.recorder")
    with pytest.raises(ImportError, match=r"pip install 'mobile-robot-simulator\[recording\]'"):
        importlib.import_module("mobile_robot_simulator.recording.recorder")
