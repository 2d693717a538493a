"""The messages of RViz's markers, with the fields that ROS 1 and ROS 2 both have."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from .messages import Header, Message, Point, Pose, Time, Vector3


@dataclass(slots=True, eq=False)
class ColorRGBA(Message):
    """A color, with components from 0 to 1."""

    ros_type = "std_msgs/msg/ColorRGBA"
    r: float = 0.0
    g: float = 0.0
    b: float = 0.0
    a: float = 0.0


@dataclass(slots=True, eq=False)
class Marker(Message):
    """A shape for RViz to show. `ns` and `id` together name it."""

    ros_type = "visualization_msgs/msg/Marker"

    ARROW: ClassVar[int] = 0
    CUBE: ClassVar[int] = 1
    SPHERE: ClassVar[int] = 2
    CYLINDER: ClassVar[int] = 3
    LINE_STRIP: ClassVar[int] = 4
    ADD: ClassVar[int] = 0
    DELETE: ClassVar[int] = 2
    DELETEALL: ClassVar[int] = 3

    header: Header = field(default_factory=Header)
    ns: str = ""
    id: int = 0
    type: int = 0
    action: int = 0
    pose: Pose = field(default_factory=Pose)
    scale: Vector3 = field(default_factory=Vector3)
    color: ColorRGBA = field(default_factory=ColorRGBA)
    lifetime: Time = field(default_factory=Time)
    frame_locked: bool = False
    points: list[Point] = field(default_factory=list)
    text: str = ""


@dataclass(slots=True, eq=False)
class MarkerArray(Message):
    """Several markers."""

    ros_type = "visualization_msgs/msg/MarkerArray"
    markers: list[Marker] = field(default_factory=list)
