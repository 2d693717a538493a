"""Encoding: what is encoded is decoded to the same message, and definitions are those of ROS."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from mobile_robot_simulator import messages
from mobile_robot_simulator.foxglove.encoding import CDR, JSON, decoded, definition_of, encoded
from mobile_robot_simulator.messages import (
    GetMapRequest,
    GetMapResponse,
    Header,
    LaserScan,
    Message,
    OccupancyGrid,
    SetPoseRequest,
    TFMessage,
    Time,
    TransformStamped,
    TriggerResponse,
    Twist,
    Vector3,
)
from mobile_robot_simulator.recording.serialization import ros2_types


@pytest.mark.parametrize(
    "message",
    [
        Twist(Vector3(0.5, -0.0, float("inf"))),
        LaserScan(Header(Time(3, 4), "laser"), ranges=np.array([1.5, np.inf, np.nan], np.float32)),
        TFMessage([TransformStamped(child_frame_id="a"), TransformStamped(child_frame_id="b")]),
        GetMapRequest(),
        GetMapResponse(OccupancyGrid(data=np.array([-1, 0, 100], np.int8))),
        TriggerResponse(True, "grün"),
        SetPoseRequest(),
    ],
    ids=lambda message: type(message).__name__,
)
def test_cdr_there_and_back(message: Message) -> None:
    assert decoded(encoded(message), type(message), CDR) == message


def test_definitions_are_those_of_ros() -> None:
    """From the files of ROS 2 Humble: common_interfaces, robot_localization."""
    first = {kind: definition_of(kind).partition("=" * 80)[0].split("\n")[:-1] for kind in (Twist, SetPoseRequest)}
    assert first[Twist] == ["geometry_msgs/Vector3 linear", "geometry_msgs/Vector3 angular"]
    assert first[SetPoseRequest] == ["geometry_msgs/PoseWithCovarianceStamped pose"]
    assert definition_of(TriggerResponse).split() == ["bool", "success", "string", "message"]
    assert definition_of(GetMapRequest) == ""
    assert "float64[36] covariance" in definition_of(SetPoseRequest)


def test_every_message_of_the_package_has_a_definition() -> None:
    kinds = [kind for kind in vars(messages).values() if isinstance(kind, type) and issubclass(kind, Message)]
    for kind in kinds:
        if kind is not Message:
            assert isinstance(definition_of(kind), str)


@dataclass(slots=True, eq=False)
class Numbers(Message):
    """A message of a user."""

    ros_type = "my_msgs/srv/Numbers_Request"
    values: np.ndarray = field(default_factory=lambda: np.zeros(0, np.uint16))
    times: list[Time] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Unclear(Message):
    """A message whose field may be of any integer type."""

    ros_type = "my_msgs/msg/Unclear"
    count: int = 0


def test_a_message_of_a_user_is_described_by_its_fields() -> None:
    assert definition_of(Numbers).startswith("uint16[] values\nbuiltin_interfaces/Time[] times\n")
    message = Numbers(np.array([1, 2**16 - 1], np.uint16), [Time(1, 2)])
    assert decoded(encoded(message), Numbers, CDR) == message


def test_a_message_that_cannot_be_described_is_refused() -> None:
    reason = "my_msgs/msg/Unclear is not part of ROS 2 Humble, and the ROS type of its field count is unknown"
    for _ in range(2):
        with pytest.raises(ValueError, match=reason):
            definition_of(Unclear)


def test_json_sets_the_fields_that_it_has() -> None:
    text = b'{"header": {"seq": 7, "stamp": {"sec": 1, "nsec": 2}, "frame_id": "a"}, "ranges": [1, 2.5], "range_max": 9}'
    expected = LaserScan(Header(Time(1, 2), "a"), range_max=9, ranges=np.array([1.0, 2.5], np.float32))
    assert decoded(text, LaserScan, JSON) == expected
    tree = b'{"transforms": [{"child_frame_id": "a"}, {"child_frame_id": "b"}]}'
    assert [each.child_frame_id for each in decoded(tree, TFMessage, JSON).transforms] == ["a", "b"]


@pytest.mark.parametrize(
    ("kind", "text", "reason"),
    [
        (Twist, b"3", "geometry_msgs/msg/Twist must be an object, got 3"),
        (Twist, b'{"linear": [1]}', r"geometry_msgs/msg/Twist\.linear must be an object, got \[1\]"),
        (LaserScan, b'{"ranges": ["x"]}', r"LaserScan\.ranges must be a list of numbers \(float32\)"),
        (OccupancyGrid, b'{"data": [300]}', r"OccupancyGrid\.data must be a list of numbers \(int8\)"),
        (TFMessage, b'{"transforms": [1]}', r"TFMessage\.transforms\[0\] must be an object, got 1"),
        (GetMapRequest, b'{"map": 1}', "nav_msgs/srv/GetMap_Request has no fields"),
    ],
)
def test_json_that_does_not_fit_is_refused(kind: type[Message], text: bytes, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        decoded(text, kind, JSON)


def test_definitions_of_recordings_stay_as_they_are() -> None:
    """Code that imports ROS messages under `stand_in` must not see the requests of services among them."""
    definition_of(SetPoseRequest)
    assert SetPoseRequest.ros_type not in ros2_types().fielddefs


def test_a_value_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match="cannot send this std_srvs/srv/Trigger_Response"):
        encoded(TriggerResponse(True, 3))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="cannot record this geometry_msgs/msg/Twist"):
        encoded(Twist(Vector3("fast")))  # type: ignore[arg-type]
