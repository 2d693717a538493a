"""Messages to record, and recordings read back with rosbags."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args, get_type_hints

import numpy as np
from rosbags.highlevel import AnyReader

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.recording.recorder import Format, Recorder

FORMATS: tuple[Format, ...] = ("mcap", "sqlite3", "bag")
KINDS = sorted(
    (kind for kind in vars(ros).values() if "/msg/" in getattr(kind, "ros_type", "")),
    key=lambda kind: kind.ros_type,
)
SPECIAL = np.array([np.nan, np.inf, -np.inf, 0.0, -0.0, 1e-45, 3.4e38, 1.1], np.float32)


def filled(kind: type[ros.Message], numbers: Iterator[int]) -> Any:
    """Returns a message in which every field has a different value."""
    message = kind()
    for item in dataclasses.fields(kind):
        value: Any = getattr(message, item.name)
        if isinstance(value, ros.Message):
            value = filled(type(value), numbers)
        elif isinstance(value, np.ndarray):
            value = np.arange(value.size or 5).astype(value.dtype) + value.dtype.type(next(numbers))
        elif isinstance(value, list):
            (item_kind,) = get_args(get_type_hints(kind)[item.name])
            is_text = item_kind is str
            value = [f"name_{next(numbers)}" if is_text else filled(item_kind, numbers) for _ in range(3)]
        else:
            number = next(numbers)
            value = {str: f"frame_{number}", float: number + 0.5, int: number, bool: True}[type(value)]
        setattr(message, item.name, value)
    return message


def values_of(message: ros.Message) -> tuple[Any, ...]:
    """Returns the values of a message in the form of `MessageRecipe`."""
    values: list[Any] = []
    for item in dataclasses.fields(message):
        value = getattr(message, item.name)
        if isinstance(value, ros.Message):
            values += values_of(value)
        elif isinstance(value, list):
            values.append([values_of(each) if isinstance(each, ros.Message) else each for each in value])
        else:
            values.append(value)
    return tuple(values)


def drive(steps: int = 40) -> list[tuple[str, ros.Message, int]]:
    """Returns topics, messages and times of a short drive. Values that ROS stores as float32 are float32 values."""
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
            ("/scan", ros.LaserScan(header, range_max=30.0, ranges=np.roll(SPECIAL, step)), time_ns),
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
