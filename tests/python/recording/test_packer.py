"""Packed messages have the bytes that rosbags gives them."""

from __future__ import annotations

import itertools
import random
import re
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.nodes.robot_messages import exact_transforms_message
from mobile_robot_simulator.recording import packer as packing
from mobile_robot_simulator.recording.packer import CODES, Packer
from mobile_robot_simulator.recording.serialization import ros2_types
from recordings import KINDS, filled, values_of

TYPES = ros2_types()
NAMES = sorted(name for name in TYPES.types if "/msg/" in name)
SEED = 4


def drawn(name: str, generator: random.Random) -> Any:
    """Returns a message with random values, texts and lengths."""
    return SimpleNamespace(**{field: drawn_field(*kind, generator) for field, kind in TYPES.get_msgdef(name).fields})


def drawn_field(node: Nodetype, content: Any, generator: random.Random) -> Any:
    if node == Nodetype.NAME:
        return drawn(content, generator)
    if node == Nodetype.BASE:
        return drawn_value(content[0], generator)
    (inner, kind), count = content
    count = count if node == Nodetype.ARRAY else generator.randrange(4)
    if inner == Nodetype.BASE and kind[0] != "string":
        return np.array([drawn_value(kind[0], generator) for _ in range(count)], CODES[kind[0]])
    return [drawn_field(inner, kind, generator) for _ in range(count)]


def drawn_value(kind: str, generator: random.Random) -> Any:
    if kind == "string":
        return "".join(generator.choices("aä猫 ", k=generator.randrange(6)))
    if kind in ("float32", "float64"):
        return generator.choice([0.1, -0.0, np.inf, -np.inf, np.nan, generator.uniform(-1e9, 1e9)])
    return generator.randrange(2) if kind == "bool" else generator.randrange(128)


def packer(name: str) -> Packer | None:
    try:
        return Packer(TYPES, name)
    except NotImplementedError:
        return None


def test_almost_every_type_can_be_packed() -> None:
    without = {name for name in NAMES if packer(name) is None}
    assert len(NAMES) > 140 and "sensor_msgs/msg/JointState" in without
    assert len(without) < 0.1 * len(NAMES)


@pytest.mark.parametrize("name", [name for name in NAMES if packer(name)])
def test_a_message_has_the_bytes_that_rosbags_gives_it(name: str) -> None:
    generator, packed = random.Random(SEED), Packer(TYPES, name)
    for _ in range(20):
        message = drawn(name, generator)
        assert packed.pack(message) == bytes(TYPES.serialize_cdr(message, name, little_endian=True))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if packer(kind.ros_type)], ids=lambda kind: kind.__name__)
def test_the_values_of_a_message_have_the_bytes_of_the_message(kind: type[ros.Message]) -> None:
    message, packed = filled(kind, itertools.count(1)), Packer(TYPES, kind.ros_type)
    assert packed.pack_values(values_of(message)) == packed.pack(message)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("nav_msgs/msg/Odometry", {"child_frame_id": 3}),
        ("nav_msgs/msg/Odometry", {"pose": SimpleNamespace(pose=None, covariance=np.zeros(36))}),
        ("sensor_msgs/msg/LaserScan", {"angle_min": "0"}),
        ("sensor_msgs/msg/LaserScan", {"ranges": np.zeros(3)}),
        ("sensor_msgs/msg/LaserScan", {"ranges": np.zeros((3, 3), np.float32)}),
        ("sensor_msgs/msg/LaserScan", {"ranges": [0.0, 1.0]}),
        ("geometry_msgs/msg/PoseWithCovariance", {"covariance": np.zeros(35)}),
        ("geometry_msgs/msg/PoseWithCovariance", {"covariance": np.zeros(36, ">f8")}),
        ("std_msgs/msg/UInt8", {"data": 256}),
        ("std_msgs/msg/String", {"data": None}),
        ("tf2_msgs/msg/TFMessage", {"transforms": [SimpleNamespace()]}),
    ],
)
def test_values_that_do_not_fit_are_not_packed(name: str, change: dict[str, Any]) -> None:
    packed, message = Packer(TYPES, name), drawn(name, random.Random(SEED))
    packed.pack(message)
    vars(message).update(change)
    with pytest.raises(Exception, match=re.compile(".")):
        packed.pack(message)


@pytest.mark.parametrize("frozen", [False, True])
def test_an_array_is_kept_with_its_bytes_only_if_it_can_never_change(frozen: bool) -> None:
    packed, numbers = Packer(TYPES, "geometry_msgs/msg/PoseWithCovariance"), np.arange(36.0)
    for _ in range(3):
        numbers += 1.0
        covariance = np.frombuffer(numbers.tobytes()) if frozen else numbers.view()
        covariance.flags.writeable = False
        message = ros.PoseWithCovariance(covariance=covariance)
        expected = bytes(TYPES.serialize_cdr(message, message.ros_type, little_endian=True))
        assert packed.pack(message) == packed.pack(message) == expected
        if not frozen:
            numbers += 1.0
            expected = bytes(TYPES.serialize_cdr(message, message.ros_type, little_endian=True))
            assert packed.pack(message) == expected


def test_more_texts_and_arrays_than_are_kept_are_packed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "TEXTS", 0)
    monkeypatch.setattr(packing, "ARRAYS", 2)
    odometry = Packer(TYPES, "nav_msgs/msg/Odometry")
    for number in range(5):
        message = ros.Odometry(child_frame_id=f"frame of number {number}")
        message.pose.covariance = np.frombuffer(np.full(36, float(number)).tobytes())
        assert odometry.pack(message) == bytes(TYPES.serialize_cdr(message, message.ros_type, little_endian=True))


def test_a_template_packs_what_is_packed_without_it() -> None:
    generator, transforms = random.Random(SEED), Packer(TYPES, "tf2_msgs/msg/TFMessage")
    for chain in (("odom", "base"), ("map", "odom", "ä"), ("", "", "")):
        count = 2 + 4 * (len(chain) - 1)
        fill = transforms.template(exact_transforms_message.join, chain, count)
        for _ in range(50):
            floats = [drawn_value("float64", generator) for _ in range(count - 2)]
            numbers = (generator.randrange(-(2**31), 2**31), generator.randrange(2**32), *floats)
            assert fill(*numbers) == transforms.pack_values(exact_transforms_message.join(chain, *numbers))
    with pytest.raises(struct.error):
        fill(2**31, 0, *[0.0] * 8)


def test_a_template_needs_numbers_that_stay_as_they_are() -> None:
    points = Packer(TYPES, "geometry_msgs/msg/PointStamped")
    for changed in (lambda x: 2.0 * x, abs, lambda x: float(np.float32(x)), lambda x: min(x, 0.0)):
        with pytest.raises(ValueError, match="as they are"):
            points.template(lambda frame, *n, changed=changed: (*n[:2], frame, changed(n[2]), 0.0, 0.0), "map", 3)
