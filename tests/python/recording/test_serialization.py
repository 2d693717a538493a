"""Serialization: every field of every message is read back as it was written."""

from __future__ import annotations

import itertools
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.message_recipe import recipe
from mobile_robot_simulator.recording.recorder import Format, Recorder
from mobile_robot_simulator.recording.serialization import to_ros2_bytes
from recordings import FORMATS, KINDS, SPECIAL, assert_same, filled, read, record


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_field_of_every_message(tmp_path: Path, format: Format, kind: type[ros.Message]) -> None:
    if format == "bag" and kind in (ros.Time, ros.Duration):
        pytest.skip("times and durations are not messages in ROS 1")
    message = filled(kind, itertools.count(1))
    ((topic, got, time_ns),) = read(record(tmp_path, format, [("/topic", message, 7)]))
    assert (topic, time_ns) == ("/topic", 7)
    assert_same(message, got, kind.__name__)


@pytest.mark.parametrize("format", FORMATS)
def test_special_values_and_empty_arrays(tmp_path: Path, format: Format) -> None:
    messages: list[tuple[str, ros.Message, int]] = [
        ("/scan", ros.LaserScan(ranges=SPECIAL, intensities=SPECIAL[:1]), 1),
        ("/scan", ros.LaserScan(ros.Header(frame_id="läser")), 2),
        ("/tf", ros.TFMessage([]), 3),
        ("/cmd_vel", ros.Twist(ros.Vector3(0.1, float("inf"), -0.0)), 4),
    ]
    for (_, message, _), (topic, got, _) in zip(messages, read(record(tmp_path, format, messages)), strict=True):
        assert_same(message, got, topic)


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
def test_messages_that_do_not_fit_their_ros_type_are_refused(
    tmp_path: Path, format: Format, message: ros.Message, error: type[Exception], match: str
) -> None:
    with Recorder(tmp_path, format=format) as recorder:
        with pytest.raises(error, match=match):
            recorder.write("/topic", message, 1)
        recorder.write("/clock", ros.Clock(), 2)
    assert [time_ns for _, _, time_ns in read(recorder.path)] == [2]


def test_of_messages_that_have_much_in_common_only_the_first_is_packed_as_a_whole() -> None:
    joined: list[str] = []

    @recipe(ros.PointStamped, lambda frame, *numbers: (frame, numbers))
    def point(frame: str, sec: int, nanosec: int, x: float) -> tuple[Any, ...]:
        joined.append(frame)
        return sec, nanosec, frame, x, x, 0.0

    for frame in ("map", "odom"):
        for number in range(20):
            call = partial(point, frame, number, number + 1, 0.1 * number)
            once = len(joined)
            packed = to_ros2_bytes(call)
            assert (len(joined) > once) == (number == 0)
            assert packed == to_ros2_bytes(call())
    with pytest.raises(ValueError, match="cannot record this geometry_msgs/msg/PointStamped"):
        to_ros2_bytes(partial(point, "map", 2**31, 0, 0.0))
