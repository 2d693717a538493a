"""recording: what is read back is what was written, the same bytes every time, and no file is lost or left broken."""

from __future__ import annotations

import dataclasses
import importlib
import itertools
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader
from rosbags.interfaces import ConnectionExtRosbag1, ConnectionExtRosbag2, QosDurability, QosReliability

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.recording import recorder as recording
from mobile_robot_simulator.recording.recorder import Format, Recorder

FORMATS: tuple[Format, ...] = ("mcap", "sqlite3", "bag")
KINDS = sorted((kind for kind in ros.Message.__subclasses__() if "/msg/" in kind.ros_type), key=lambda kind: kind.ros_type)
STRANGE = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, 1e-45, 3.4e38, 1.1], np.float32)

# rosmsg md5 of the definitions of ROS 1 Noetic: players and subscribers refuse any other.
ROS1_SUMS = {
    "geometry_msgs/msg/PoseWithCovarianceStamped": "953b798c0f514ff060a53a3498ce6246",
    "geometry_msgs/msg/Twist": "9f195f881246fdfa2798d1d3eebca84a",
    "geometry_msgs/msg/TwistStamped": "98d34b0043a2093cf9d9345ab6eef12e",
    "nav_msgs/msg/OccupancyGrid": "3381f2d731d4076ec5c71b0759edbe4e",
    "nav_msgs/msg/Odometry": "cd5e73d190d741a2f92e81eda573aca7",
    "rosgraph_msgs/msg/Clock": "a9c97c1d230cfc112e270351a944ee47",
    "sensor_msgs/msg/LaserScan": "90c7ef2dc6895d81024acba2ac42f369",
    "tf2_msgs/msg/TFMessage": "94810edda583a504dfda3829e70d7eec",
}


def filled(kind: type[ros.Message], numbers: Iterator[int]) -> Any:
    """A message each of whose fields holds something of its own."""
    message = kind()
    for item in dataclasses.fields(kind):
        value: Any = getattr(message, item.name)
        if isinstance(value, ros.Message):
            value = filled(type(value), numbers)
        elif isinstance(value, np.ndarray):
            value = np.arange(value.size or 5).astype(value.dtype) + value.dtype.type(next(numbers))
        elif isinstance(value, list):
            value = [filled(ros.TransformStamped, numbers) for _ in range(3)]
        else:
            number = next(numbers)
            value = {str: f"frame_{number}", float: number + 0.5, int: number}[type(value)]
        setattr(message, item.name, value)
    return message


def drive(steps: int = 40) -> list[tuple[str, ros.Message, int]]:
    """Topics, messages and times of a short drive; what ROS has as float32 is a float32 here."""
    cells = np.resize(np.array([-1, 0, 100], np.int8), 30 * 20)
    grid = ros.OccupancyGrid(info=ros.MapMetaData(resolution=0.25, width=30, height=20), data=cells)
    messages: list[tuple[str, ros.Message, int]] = [("/map", grid, 0)]
    for step in range(steps):
        time_ns = step * 20_000_000
        header = ros.Header(ros.Time.from_nanoseconds(time_ns), "odom")
        pose = ros.Pose(ros.Point(0.1 * step, 1 / 3), ros.Quaternion(z=0.6, w=0.8))
        transform = ros.Transform(ros.Vector3(0.1 * step, 1 / 3), pose.orientation)
        messages += [
            ("/clock", ros.Clock(header.stamp), time_ns),
            ("/odom", ros.Odometry(header, "base_link", ros.PoseWithCovariance(pose)), time_ns),
            ("/tf", ros.TFMessage([ros.TransformStamped(header, "base_link", transform)]), time_ns),
            ("/scan", ros.LaserScan(header, range_max=30.0, ranges=np.roll(STRANGE, step)), time_ns),
        ]
    return messages


def record(folder: Path, format: Format, messages: list[tuple[str, ros.Message, int]]) -> Path:
    with Recorder(folder, format=format) as recorder:
        for topic, message, time_ns in messages:
            recorder.write(topic, message, time_ns)
    return recorder.path


def read(path: Path) -> list[tuple[str, Any, int]]:
    with AnyReader([path]) as reader:
        return [
            (connection.topic, reader.deserialize(data, connection.msgtype), time_ns)
            for connection, time_ns, data in reader.messages()
        ]


def assert_same(written: Any, got: Any, where: str) -> None:
    if isinstance(written, ros.Message):
        assert got.__msgtype__ == written.ros_type, where
        for item in dataclasses.fields(written):
            assert_same(getattr(written, item.name), getattr(got, item.name), f"{where}.{item.name}")
    elif isinstance(written, np.ndarray):
        assert got.dtype == written.dtype and got.tobytes() == written.tobytes(), where
    elif isinstance(written, list):
        assert len(written) == len(got), where
        for number, (left, right) in enumerate(zip(written, got, strict=True)):
            assert_same(left, right, f"{where}[{number}]")
    else:
        assert written == got, where


def contents(path: Path) -> dict[str, bytes]:
    files = [path] if path.is_file() else sorted(path.iterdir())
    return {file.name: file.read_bytes() for file in files}


# --- What was written is what is read ---


@pytest.mark.parametrize("format", FORMATS)
def test_a_drive_is_read_back_field_by_field(tmp_path: Path, format: Format) -> None:
    written = drive()
    got = read(record(tmp_path, format, written))
    assert len(got) == len(written)
    # SQLite and chunks order messages of one time as they like.
    by_topic_and_time: Callable[[Any], Any] = lambda entry: (entry[0], entry[2])  # noqa: E731
    floor = 1 if format == "bag" else 0
    for (topic, message, time_ns), (got_topic, got_message, got_time_ns) in zip(
        sorted(written, key=by_topic_and_time), sorted(got, key=by_topic_and_time), strict=True
    ):
        assert (topic, max(time_ns, floor)) == (got_topic, got_time_ns)
        assert_same(message, got_message, topic)


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_field_of_every_message(tmp_path: Path, format: Format, kind: type[ros.Message]) -> None:
    if format == "bag" and kind is ros.Time:
        pytest.skip("time is not a message in ROS 1")
    message = filled(kind, itertools.count(1))
    ((topic, got, time_ns),) = read(record(tmp_path, format, [("/topic", message, 7)]))
    assert (topic, time_ns) == ("/topic", 7)
    assert_same(message, got, kind.__name__)


@pytest.mark.parametrize("format", FORMATS)
def test_strange_values_and_empty_arrays(tmp_path: Path, format: Format) -> None:
    messages: list[tuple[str, ros.Message, int]] = [
        ("/scan", ros.LaserScan(ranges=STRANGE, intensities=STRANGE[:1]), 1),
        ("/scan", ros.LaserScan(ros.Header(frame_id="läser")), 2),
        ("/tf", ros.TFMessage([]), 3),
        ("/cmd_vel", ros.Twist(ros.Vector3(0.1, float("inf"), -0.0)), 4),
    ]
    for (_, message, _), (topic, got, _) in zip(messages, read(record(tmp_path, format, messages)), strict=True):
        assert_same(message, got, topic)


def test_messages_are_taken_as_they_are_when_written(tmp_path: Path) -> None:
    scan = ros.LaserScan(ranges=np.ones(3, np.float32))
    with Recorder(tmp_path) as recorder:
        recorder.write("/scan", scan, 1)
        scan.ranges[:] = 2
        scan.header.frame_id = "other"
    ((_, got, _),) = read(recorder.path)
    assert got.ranges.tolist() == [1, 1, 1]
    assert got.header.frame_id == ""


@pytest.mark.parametrize("format", FORMATS)
def test_more_than_one_batch_and_chunk(tmp_path: Path, format: Format) -> None:
    count = 2 * recording._BATCH + 3
    data = np.zeros(1000, np.int8)
    path = record(tmp_path, format, [("/map", ros.OccupancyGrid(data=data), time_ns) for time_ns in range(1, count)])
    assert [time_ns for _, _, time_ns in read(path)] == list(range(1, count))


@pytest.mark.parametrize("format", FORMATS)
def test_an_empty_recording_opens(tmp_path: Path, format: Format) -> None:
    assert read(record(tmp_path, format, [])) == []


def test_layout(tmp_path: Path) -> None:
    for format, names in (
        ("mcap", ["metadata.yaml", "recording.mcap"]),
        ("sqlite3", ["metadata.yaml", "recording.db3"]),
        ("bag", ["recording.bag"]),
    ):
        path = record(tmp_path / "deep" / format, format, drive(1))  # type: ignore[arg-type]
        assert path.parent == tmp_path / "deep" / format
        assert list(path.parent.iterdir()) == [path]
        assert list(contents(path)) == names


# --- What ROS needs besides ---


@pytest.mark.parametrize("format", ["mcap", "sqlite3"])
def test_offered_qos(tmp_path: Path, format: Format) -> None:
    messages = [(topic, ros.Clock(), 1) for topic in ("/map", "/tf_static", "/robot1/map", "/tf", "/scan", "/mapping")]
    with AnyReader([record(tmp_path, format, list(messages))]) as reader:
        offered = {}
        for connection in reader.connections:
            assert isinstance(connection.ext, ConnectionExtRosbag2)
            (profile,) = connection.ext.offered_qos_profiles
            assert profile.reliability == QosReliability.RELIABLE
            offered[connection.topic] = profile.durability
    kept, passing = QosDurability.TRANSIENT_LOCAL, QosDurability.VOLATILE
    latched = {"/map": kept, "/tf_static": kept, "/robot1/map": kept}
    assert offered == latched | {"/tf": passing, "/scan": passing, "/mapping": passing}
    assert "\n  version: 8\n" in (tmp_path / "recording" / "metadata.yaml").read_text()


def test_ros1_sums_latching_and_sequence(tmp_path: Path) -> None:
    messages: list[tuple[str, ros.Message, int]] = [
        (f"/{kind.__name__}", kind(), 1) for kind in KINDS if kind.ros_type in ROS1_SUMS
    ]
    messages += [("/map", ros.OccupancyGrid(), 1)]
    with AnyReader([record(tmp_path, "bag", messages)]) as reader:
        sums = {connection.msgtype: connection.digest for connection in reader.connections}
        extras = {connection.topic: connection.ext for connection in reader.connections}
    assert sums == ROS1_SUMS
    assert extras["/map"] == ConnectionExtRosbag1(None, 1)
    assert extras["/Odometry"] == ConnectionExtRosbag1(None, None)


def test_ros1_header_has_a_sequence_number(tmp_path: Path) -> None:
    messages: list[tuple[str, ros.Message, int]] = [("/scan", ros.LaserScan(), 1)]
    ((_, got, _),) = read(record(tmp_path, "bag", messages))
    assert got.header.seq == 0


# --- The same bytes ---

TWIN = """
import sys
from pathlib import Path
sys.path.insert(0, {tests!r})
from test_recorder import drive, record
record(Path({folder!r}), {format!r}, drive())
"""


@pytest.mark.parametrize("format", FORMATS)
def test_same_messages_same_bytes(tmp_path: Path, format: Format) -> None:
    first, second = (contents(record(tmp_path / name, format, drive())) for name in ("first", "second"))
    assert first == second
    script = TWIN.format(tests=str(Path(__file__).parent), folder=str(tmp_path / "third"), format=format)
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60)
    (third,) = (tmp_path / "third").iterdir()
    assert contents(third) == first


# --- Older recordings ---


@pytest.mark.parametrize("old", FORMATS)
@pytest.mark.parametrize("new", FORMATS)
def test_an_older_recording_is_kept_unless_overwritten(tmp_path: Path, old: Format, new: Format) -> None:
    (tmp_path / "drive.png").write_text("a picture")
    path = record(tmp_path, old, drive(2))
    before = contents(path)
    with pytest.raises(FileExistsError, match="--overwrite") as raised:
        Recorder(tmp_path, format=new)
    assert raised.value.filename == str(path)
    assert contents(path) == before

    with Recorder(tmp_path, format=new, overwrite=True) as recorder:
        recorder.write("/clock", ros.Clock(), 5)
    assert {item.name for item in tmp_path.iterdir()} == {"drive.png", recorder.path.name}
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [5]


@pytest.mark.parametrize("format", FORMATS)
def test_an_older_recording_is_back_if_the_new_one_cannot_begin(
    tmp_path: Path, format: Format, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = record(tmp_path, "mcap", drive(2))
    before = contents(path)

    def full(writer: Any) -> None:
        if format != "bag":
            writer.path.mkdir()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(f"rosbags.rosbag{1 if format == 'bag' else 2}.Writer.open", full)
    with pytest.raises(OSError, match="No space left"):
        Recorder(tmp_path, format=format, overwrite=True)
    assert list(tmp_path.iterdir()) == [path]
    assert contents(path) == before


def a_file(path: Path) -> None:
    path.write_text("not a recording")


def a_folder_with_more(path: Path) -> None:
    path.mkdir()
    (path / "metadata.yaml").touch()
    (path / "thesis.tex").touch()


def a_link(path: Path) -> None:
    (path.parent / "elsewhere").mkdir()
    path.symlink_to("elsewhere")


@pytest.mark.parametrize("name", ["recording", "recording.bag"])
@pytest.mark.parametrize("make", [a_file, a_folder_with_more, a_link])
def test_what_is_not_a_recording_is_never_removed(tmp_path: Path, name: str, make: Callable[[Path], None]) -> None:
    make(tmp_path / name)
    before = sorted(tmp_path.rglob("*"))
    for format in FORMATS:
        with pytest.raises(FileExistsError, match=f"not one itself.*{name}'"):
            Recorder(tmp_path, format=format, overwrite=True)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_file_for_a_folder(tmp_path: Path) -> None:
    (tmp_path / "out").touch()
    with pytest.raises(OSError, match="out"):
        Recorder(tmp_path / "out")


# --- Ends ---


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
def test_a_run_cut_short_leaves_a_recording(tmp_path: Path, format: Format, error: type[BaseException]) -> None:
    with pytest.raises(error), Recorder(tmp_path, format=format) as recorder:
        recorder.write("/clock", ros.Clock(), 5)
        raise error
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [5]


@pytest.mark.parametrize("format", FORMATS)
def test_an_interruption_at_any_moment_leaves_a_recording(
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
                    recorder.write("/scan", ros.LaserScan(ranges=STRANGE), written + 1)
                    written += 1
            times = [time_ns for _, _, time_ns in read(recorder.path)]
            assert len(times) in (written, written + 1)
            assert times == list(range(1, len(times) + 1))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, earlier)


def test_closing_twice_and_writing_after(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path)
    recorder.write("/clock", ros.Clock(), 5)
    recorder.close()
    before = contents(recorder.path)
    recorder.close()
    assert contents(recorder.path) == before
    with pytest.raises(ValueError, match="is closed"):
        recorder.write("/clock", ros.Clock(), 6)


def test_a_full_disk_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("rosbags.rosbag2.Writer.write", full)
    recorder = Recorder(tmp_path)
    recorder.write("/clock", ros.Clock(), 5)
    with pytest.raises(OSError, match="No space left"):
        recorder.close()
    recorder.close()


# --- Refusals ---


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize(
    ("message", "error", "match"),
    [
        (
            ros.Odometry(pose=ros.PoseWithCovariance(covariance=np.zeros(36, int))),
            TypeError,
            "pose.covariance.*float64",
        ),
        (ros.Odometry(pose=ros.PoseWithCovariance(covariance=np.zeros(35))), ValueError, "Odometry.*length"),
        (ros.LaserScan(ranges=np.zeros(3)), TypeError, "dtype float32, got float64"),  # type: ignore[arg-type]
        (ros.LaserScan(ranges=[1.0]), ValueError, "cannot record this sensor_msgs"),  # type: ignore[arg-type]
        (ros.LaserScan(range_max=1e300), ValueError, "cannot record this sensor_msgs/msg/LaserScan"),
        (ros.Clock(ros.Time(2**31)), ValueError, "cannot record this rosgraph_msgs/msg/Clock"),
        (ros.Header(frame_id=3), ValueError, "cannot record this std_msgs/msg/Header"),  # type: ignore[arg-type]
        (ros.GetMapRequest(), ValueError, "nav_msgs/srv/GetMap_Request is not a known ROS type"),
    ],
)
def test_messages_that_cannot_be_recorded(
    tmp_path: Path, format: Format, message: ros.Message, error: type[Exception], match: str
) -> None:
    with Recorder(tmp_path, format=format) as recorder:
        with pytest.raises(error, match=match):
            recorder.write("/topic", message, 1)
        recorder.write("/clock", ros.Clock(), 2)
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [2]


@pytest.mark.parametrize(("format", "end"), [("mcap", 2**63), ("sqlite3", 2**63), ("bag", 2**32 * 10**9)])
def test_times(tmp_path: Path, format: Format, end: int) -> None:
    with Recorder(tmp_path, format=format) as recorder:
        for time_ns in (-1, end):
            with pytest.raises(ValueError, match=rf"time_ns .* got {time_ns}"):
                recorder.write("/clock", ros.Clock(), time_ns)
        with pytest.raises(TypeError):
            recorder.write("/clock", ros.Clock(), 0.5)  # type: ignore[arg-type]
        recorder.write("/clock", ros.Clock(), np.int64(3))  # type: ignore[arg-type]
        recorder.write("/clock", ros.Clock(), end - 2)
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [3, end - 2]


def test_one_type_per_topic(tmp_path: Path) -> None:
    with Recorder(tmp_path) as recorder:
        recorder.write("/cmd_vel", ros.Twist(), 1)
        with pytest.raises(ValueError, match=r"/cmd_vel carries geometry_msgs/msg/Twist, got .*TwistStamped"):
            recorder.write("/cmd_vel", ros.TwistStamped(), 2)


def test_unknown_format(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="one of mcap, bag, sqlite3, got 'csv'"):
        Recorder(tmp_path / "new", format="csv")  # type: ignore[arg-type]
    assert not (tmp_path / "new").exists()


def test_without_rosbags(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rosbags.interfaces", None)
    monkeypatch.delitem(sys.modules, "mobile_robot_simulator.recording.recorder")
    with pytest.raises(ImportError, match=r"pip install 'mobile-robot-simulator\[recording\]'"):
        importlib.import_module("mobile_robot_simulator.recording.recorder")
