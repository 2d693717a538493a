"""The ROS messages and services that the nodes use, as Python classes that need no ROS installation.

Each class has the fields, units and frames of the ROS definition named by its `ros_type`. Arrays are NumPy arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cache
from numbers import Integral, Real
from typing import Any, ClassVar, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from ._core import Pose as PlanarPose
from .quoting import quoted

__all__ = [
    "AckermannDrive",
    "AckermannDriveStamped",
    "Bool",
    "Clock",
    "Duration",
    "GetMap",
    "GetMapRequest",
    "GetMapResponse",
    "Header",
    "JointState",
    "LaserScan",
    "MapMetaData",
    "Message",
    "OccupancyGrid",
    "Odometry",
    "Point",
    "PointStamped",
    "Pose",
    "PoseStamped",
    "PoseWithCovariance",
    "PoseWithCovarianceStamped",
    "Quaternion",
    "SetPose",
    "SetPoseRequest",
    "SetPoseResponse",
    "String",
    "TFMessage",
    "Time",
    "Transform",
    "TransformStamped",
    "Trigger",
    "TriggerRequest",
    "TriggerResponse",
    "Twist",
    "TwistStamped",
    "TwistWithCovariance",
    "Vector3",
    "check_fields",
    "checked_copy",
    "copied",
]

T = TypeVar("T")


@dataclass(slots=True, eq=False)
class Message:
    """Base class of messages. Every field has a default. Two messages are equal if all their fields are equal.

    In arrays, NaN equals NaN.
    """

    ros_type: ClassVar[str]

    optional: ClassVar[tuple[str, ...]] = ()
    """Fields that some versions of the ROS definition lack. Then they keep their defaults."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(_same(getattr(self, name), getattr(other, name)) for name in _field_names(type(self)))  # type: ignore[arg-type]

    __hash__ = None  # type: ignore[assignment]


def copied(value: T) -> T:
    """Returns a deep copy of a message that shares only read-only arrays.

    Args:
        value: A message, or a value of one of its fields.
    """
    if isinstance(value, Message):
        kind = type(value)
        copy = object.__new__(kind)
        for name in _field_names(kind):  # type: ignore[arg-type]
            item = getattr(value, name)
            setattr(copy, name, item if type(item) in _PLAIN else copied(item))
        return copy
    if isinstance(value, np.ndarray):
        return value.copy() if value.flags.writeable else value
    return [copied(item) for item in value] if isinstance(value, list) else value  # type: ignore[return-value]


def check_fields(message: Message) -> None:
    """Checks that the fields of a message, and of the messages in it, hold values of their types.

    A number can be NaN or infinite. An array can be a NumPy array, a list or a tuple of numbers. Each item of a list of
    messages is checked too.

    Raises:
        TypeError: A field holds something else. The text names the field.
        ValueError: An array has more than one dimension, or a covariance has not 36 numbers.
    """
    for name, kind in _field_kinds(type(message)).items():  # type: ignore[arg-type]
        value = getattr(message, name)
        if type(value) is kind:  # most fields; what follows says what is wrong with the others
            if kind in _PLAIN:
                continue
            if isinstance(value, Message):
                check_fields(value)
                continue
        where = f"{type(message).__name__}.{name}"
        if kind is np.ndarray:
            _check_numbers(value, where, _length(type(message), name))  # type: ignore[arg-type]
        elif get_origin(kind) is list:
            (item_kind,) = get_args(kind)
            _need(isinstance(value, (list, tuple)), where, f"a list of {item_kind.__name__}", value)
            for index, item in enumerate(value):
                _need(isinstance(item, item_kind), f"{where}[{index}]", f"a {item_kind.__name__}", item)
                if isinstance(item, Message):
                    check_fields(item)
        else:
            _need(isinstance(value, _ACCEPTED.get(kind, kind)), where, f"a {kind.__name__}", value)
            if isinstance(value, Message):
                check_fields(value)


def checked_copy(message: T) -> T:
    """Returns a deep copy of a message, as `copied` does, after the checks of `check_fields`.

    Args:
        message: The message.

    Raises:
        TypeError: As for `check_fields`.
        ValueError: As for `check_fields`.
    """
    copy = _copier(type(message))(message)  # type: ignore[arg-type]
    if copy is None:
        check_fields(message)  # type: ignore[arg-type]
        copy = copied(message)
    return copy  # type: ignore[no-any-return]


@cache
def _copier(kind: type) -> Callable[[Any], Any]:
    """Returns a function that copies a message if every field in it has exactly the declared type, and else returns None.

    Its text is put together here, as that of `__init__` in dataclasses is, because loops over the fields take three times as
    long. For messages with arrays or lists it always returns None.
    """
    kinds = _field_kinds(kind)
    if len(kinds) < len(_field_names(kind)) or not all(
        declared in _PLAIN or (isinstance(declared, type) and issubclass(declared, Message)) for declared in kinds.values()
    ):
        return lambda message: None
    lines = ["def copy(message):", " result = new(kind)"]
    names: dict[str, Any] = {"new": object.__new__, "kind": kind}
    for index, (name, declared) in enumerate(kinds.items()):
        names[f"kind{index}"] = declared
        lines += [f" value = message.{name}", f" if type(value) is not kind{index}:", "  return None"]
        if declared not in _PLAIN:
            names[f"copy{index}"] = _copier(declared)
            lines += [f" value = copy{index}(value)", " if value is None:", "  return None"]
        lines.append(f" result.{name} = value")
    exec("\n".join([*lines, " return result"]), names)
    copier: Callable[[Any], Any] = names["copy"]
    return copier


def _check_numbers(value: object, where: str, length: int) -> None:
    if isinstance(value, np.ndarray):
        _need(value.dtype.kind in "iuf", where, "an array of numbers", value)
        if value.ndim != 1:
            raise ValueError(f"{where} must be an array of one dimension, got shape {value.shape}")
    elif isinstance(value, (list, tuple)):
        for index, item in enumerate(value):
            _need(isinstance(item, Real), f"{where}[{index}]", "a number", item)
    else:
        raise TypeError(f"{where} must be an array of numbers, got {quoted(value)}")
    if length and len(value) != length:
        raise ValueError(f"{where} must be {length} numbers, got {len(value)}")


def _need(is_met: bool, where: str, needed: str, value: object) -> None:
    if not is_met:
        raise TypeError(f"{where} must be {needed}, got {quoted(value)}")


_PLAIN = frozenset({float, int, bool, str})
"""Types of fields that cannot change and hold nothing else."""

_ACCEPTED: dict[type, type] = {float: Real, int: Integral}
"""Types of accepted values, for fields of numbers: NumPy's numbers are not floats or ints."""


@cache
def _field_kinds(kind: type[Message]) -> dict[str, Any]:
    """Returns the types of the fields that hold numbers, texts, messages, arrays, or lists of messages or texts."""
    kinds: dict[str, Any] = {}
    for name in _field_names(kind):  # type: ignore[arg-type]
        found = type(getattr(kind(), name))
        if found in (float, int, bool, str, np.ndarray) or issubclass(found, Message):
            kinds[name] = found
        elif found is list and (item_kinds := [item for item in get_args(get_type_hints(kind)[name]) if _is_item(item)]):
            kinds[name] = list[item_kinds[0]]  # type: ignore[valid-type]
    return kinds


def _is_item(kind: object) -> bool:
    return isinstance(kind, type) and issubclass(kind, (Message, str))


@cache
def _length(kind: type[Message], name: str) -> int:
    """Returns the length of an array whose length is fixed in ROS, such as a covariance, and 0 for all other arrays."""
    return len(getattr(kind(), name))


@cache
def _field_names(kind: type[Message]) -> tuple[str, ...]:
    return tuple(item.name for item in fields(kind))


def _same(left: Any, right: Any) -> bool:
    if isinstance(left, np.ndarray) or isinstance(right, np.ndarray):
        return np.array_equal(left, right, equal_nan=True)
    return bool(left == right)


@dataclass(slots=True, eq=False)
class Time(Message):
    """A time: whole seconds and the remaining nanoseconds."""

    ros_type = "builtin_interfaces/msg/Time"
    sec: int = 0
    nanosec: int = 0

    @classmethod
    def from_nanoseconds(cls, nanoseconds: int) -> Time:
        """Returns the time for a number of nanoseconds since zero.

        Args:
            nanoseconds: Time since zero [ns].
        """
        sec, nanosec = divmod(nanoseconds, 1_000_000_000)
        return cls(sec, nanosec)

    @property
    def nanoseconds(self) -> int:
        """Time since zero [ns]."""
        return self.sec * 1_000_000_000 + self.nanosec


@dataclass(slots=True, eq=False)
class Duration(Message):
    """A span of time: whole seconds, rounded down, and the remaining nanoseconds."""

    ros_type = "builtin_interfaces/msg/Duration"
    sec: int = 0
    nanosec: int = 0

    @classmethod
    def from_nanoseconds(cls, nanoseconds: int) -> Duration:
        """Returns the span for a number of nanoseconds.

        Args:
            nanoseconds: Length [ns].
        """
        return cls(*divmod(nanoseconds, 1_000_000_000))

    @property
    def nanoseconds(self) -> int:
        """Length [ns]."""
        return self.sec * 1_000_000_000 + self.nanosec


@dataclass(slots=True, eq=False)
class Header(Message):
    """Time and frame of a message."""

    ros_type = "std_msgs/msg/Header"
    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass(slots=True, eq=False)
class Vector3(Message):
    """Components along x, y and z."""

    ros_type = "geometry_msgs/msg/Vector3"
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(slots=True, eq=False)
class Point(Message):
    """A position [m]."""

    ros_type = "geometry_msgs/msg/Point"
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass(slots=True, eq=False)
class Quaternion(Message):
    """An orientation, as a unit quaternion."""

    ros_type = "geometry_msgs/msg/Quaternion"
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0


@dataclass(slots=True, eq=False)
class Pose(Message):
    """A position and an orientation."""

    ros_type = "geometry_msgs/msg/Pose"
    position: Point = field(default_factory=Point)
    orientation: Quaternion = field(default_factory=Quaternion)

    @classmethod
    def from_planar(cls, pose: PlanarPose) -> Pose:
        """Returns the message for a pose in the plane.

        Args:
            pose: The pose; height, roll and pitch of the message are 0.
        """
        z, w = pose.quaternion
        return cls(Point(pose.x, pose.y), Quaternion(0.0, 0.0, z, w))

    def to_planar(self) -> PlanarPose:
        """Returns the pose in the plane; height, roll and pitch are ignored."""
        return _planar(self.position, self.orientation)


@dataclass(slots=True, eq=False)
class Transform(Message):
    """A translation and a rotation."""

    ros_type = "geometry_msgs/msg/Transform"
    translation: Vector3 = field(default_factory=Vector3)
    rotation: Quaternion = field(default_factory=Quaternion)

    @classmethod
    def from_planar(cls, pose: PlanarPose) -> Transform:
        """Returns the message for a transform in the plane.

        Args:
            pose: The transform; height, roll and pitch of the message are 0.
        """
        z, w = pose.quaternion
        return cls(Vector3(pose.x, pose.y), Quaternion(0.0, 0.0, z, w))

    def to_planar(self) -> PlanarPose:
        """Returns the transform in the plane; height, roll and pitch are ignored."""
        return _planar(self.translation, self.rotation)


def _planar(position: Point | Vector3, orientation: Quaternion) -> PlanarPose:
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    return PlanarPose.from_quaternion(position.x, position.y, qx=x, qy=y, qz=z, qw=w)


def _covariance() -> NDArray[np.float64]:
    return np.zeros(36)


@dataclass(slots=True, eq=False)
class PoseStamped(Message):
    """A pose with the time and the frame it refers to."""

    ros_type = "geometry_msgs/msg/PoseStamped"
    header: Header = field(default_factory=Header)
    pose: Pose = field(default_factory=Pose)


@dataclass(slots=True, eq=False)
class PointStamped(Message):
    """A position with the time and the frame it refers to."""

    ros_type = "geometry_msgs/msg/PointStamped"
    header: Header = field(default_factory=Header)
    point: Point = field(default_factory=Point)


@dataclass(slots=True, eq=False)
class PoseWithCovariance(Message):
    """A pose and its covariance, (36,) float64, row-major over (x, y, z, rot x, rot y, rot z) [m, rad]."""

    ros_type = "geometry_msgs/msg/PoseWithCovariance"
    pose: Pose = field(default_factory=Pose)
    covariance: NDArray[np.float64] = field(default_factory=_covariance)


@dataclass(slots=True, eq=False)
class PoseWithCovarianceStamped(Message):
    """A pose and its covariance, with their time and frame."""

    ros_type = "geometry_msgs/msg/PoseWithCovarianceStamped"
    header: Header = field(default_factory=Header)
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)


@dataclass(slots=True, eq=False)
class Twist(Message):
    """Linear [m/s] and angular [rad/s] velocity."""

    ros_type = "geometry_msgs/msg/Twist"
    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass(slots=True, eq=False)
class TwistStamped(Message):
    """A twist with its time and frame."""

    ros_type = "geometry_msgs/msg/TwistStamped"
    header: Header = field(default_factory=Header)
    twist: Twist = field(default_factory=Twist)


@dataclass(slots=True, eq=False)
class TwistWithCovariance(Message):
    """A twist and its covariance, (36,) float64, row-major over (x, y, z, rot x, rot y, rot z) [m/s, rad/s]."""

    ros_type = "geometry_msgs/msg/TwistWithCovariance"
    twist: Twist = field(default_factory=Twist)
    covariance: NDArray[np.float64] = field(default_factory=_covariance)


@dataclass(slots=True, eq=False)
class TransformStamped(Message):
    """Pose of the child frame in the header's frame at the time of the header."""

    ros_type = "geometry_msgs/msg/TransformStamped"
    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    transform: Transform = field(default_factory=Transform)


@dataclass(slots=True, eq=False)
class TFMessage(Message):
    """Transforms, as published on /tf and /tf_static."""

    ros_type = "tf2_msgs/msg/TFMessage"
    transforms: list[TransformStamped] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class Odometry(Message):
    """Odometry: the pose in the header's frame and the twist in the child frame."""

    ros_type = "nav_msgs/msg/Odometry"
    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)
    twist: TwistWithCovariance = field(default_factory=TwistWithCovariance)


def _no_joints() -> NDArray[np.float64]:
    return np.zeros(0)


@dataclass(slots=True, eq=False)
class JointState(Message):
    """Positions [rad] and velocities [rad/s] of joints, such as wheels, (N,) float64 each; efforts are left out."""

    ros_type = "sensor_msgs/msg/JointState"
    header: Header = field(default_factory=Header)
    name: list[str] = field(default_factory=list)
    position: NDArray[np.float64] = field(default_factory=_no_joints)
    velocity: NDArray[np.float64] = field(default_factory=_no_joints)
    effort: NDArray[np.float64] = field(default_factory=_no_joints)


@dataclass(slots=True, eq=False)
class AckermannDrive(Message):
    """A command for a robot that steers: angle of the bicycle's front wheel [rad] and speed [m/s], with their rates.

    Angles are positive to the left. A rate of 0 means as fast as possible.
    """

    ros_type = "ackermann_msgs/msg/AckermannDrive"
    steering_angle: float = 0.0
    steering_angle_velocity: float = 0.0
    speed: float = 0.0
    acceleration: float = 0.0
    jerk: float = 0.0


@dataclass(slots=True, eq=False)
class AckermannDriveStamped(Message):
    """An `AckermannDrive` with a time and a frame."""

    ros_type = "ackermann_msgs/msg/AckermannDriveStamped"
    header: Header = field(default_factory=Header)
    drive: AckermannDrive = field(default_factory=AckermannDrive)


def _no_ranges() -> NDArray[np.float32]:
    return np.zeros(0, np.float32)


@dataclass(slots=True, eq=False)
class LaserScan(Message):
    """A planar scan: angles [rad], times [s], ranges (N,) float32 [m]. The stamp is the time of the first beam."""

    ros_type = "sensor_msgs/msg/LaserScan"
    header: Header = field(default_factory=Header)
    angle_min: float = 0.0
    angle_max: float = 0.0
    angle_increment: float = 0.0
    time_increment: float = 0.0
    scan_time: float = 0.0
    range_min: float = 0.0
    range_max: float = 0.0
    ranges: NDArray[np.float32] = field(default_factory=_no_ranges)
    intensities: NDArray[np.float32] = field(default_factory=_no_ranges)


@dataclass(slots=True, eq=False)
class MapMetaData(Message):
    """Size of a map in cells, its resolution [m/cell], and the pose of its lower-left corner."""

    ros_type = "nav_msgs/msg/MapMetaData"
    map_load_time: Time = field(default_factory=Time)
    resolution: float = 0.0
    width: int = 0
    height: int = 0
    origin: Pose = field(default_factory=Pose)


@dataclass(slots=True, eq=False)
class OccupancyGrid(Message):
    """A map: data (height * width,) int8, row-major from the lower-left corner; 0 to 100 is the occupancy, -1 is unknown."""

    ros_type = "nav_msgs/msg/OccupancyGrid"
    header: Header = field(default_factory=Header)
    info: MapMetaData = field(default_factory=MapMetaData)
    data: NDArray[np.int8] = field(default_factory=lambda: np.zeros(0, np.int8))


@dataclass(slots=True, eq=False)
class Clock(Message):
    """The simulated time, as published on /clock."""

    ros_type = "rosgraph_msgs/msg/Clock"
    clock: Time = field(default_factory=Time)


@dataclass(slots=True, eq=False)
class Bool(Message):
    """A truth value."""

    ros_type = "std_msgs/msg/Bool"
    data: bool = False


@dataclass(slots=True, eq=False)
class String(Message):
    """A text."""

    ros_type = "std_msgs/msg/String"
    data: str = ""


@dataclass(slots=True, eq=False)
class GetMapRequest(Message):
    """Request for the map."""

    ros_type = "nav_msgs/srv/GetMap_Request"


@dataclass(slots=True, eq=False)
class GetMapResponse(Message):
    """Response with the map."""

    ros_type = "nav_msgs/srv/GetMap_Response"
    map: OccupancyGrid = field(default_factory=OccupancyGrid)


class GetMap:
    """Service that returns the map."""

    ros_type = "nav_msgs/srv/GetMap"
    Request = GetMapRequest
    Response = GetMapResponse


@dataclass(slots=True, eq=False)
class TriggerRequest(Message):
    """Request to trigger an action."""

    ros_type = "std_srvs/srv/Trigger_Request"


@dataclass(slots=True, eq=False)
class TriggerResponse(Message):
    """Whether the action succeeded, and a message about it."""

    ros_type = "std_srvs/srv/Trigger_Response"
    success: bool = False
    message: str = ""


class Trigger:
    """Service that triggers an action."""

    ros_type = "std_srvs/srv/Trigger"
    Request = TriggerRequest
    Response = TriggerResponse


@dataclass(slots=True, eq=False)
class SetPoseRequest(Message):
    """Request with the new pose."""

    ros_type = "robot_localization/srv/SetPose_Request"
    pose: PoseWithCovarianceStamped = field(default_factory=PoseWithCovarianceStamped)


@dataclass(slots=True, eq=False)
class SetPoseResponse(Message):
    """Empty response."""

    ros_type = "robot_localization/srv/SetPose_Response"


class SetPose:
    """Service that sets the pose of the robot."""

    ros_type = "robot_localization/srv/SetPose"
    Request = SetPoseRequest
    Response = SetPoseResponse
