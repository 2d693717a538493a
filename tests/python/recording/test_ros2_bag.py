"""Ros2Bag: what ROS 2 expects of a bag."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader
from rosbags.interfaces import ConnectionExtRosbag2, QosDurability, QosReliability

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.recording.recorder import Format
from recordings import record


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
    latched, volatile = QosDurability.TRANSIENT_LOCAL, QosDurability.VOLATILE
    expected = {"/map": latched, "/tf_static": latched, "/robot1/map": latched}
    assert offered == expected | {"/tf": volatile, "/scan": volatile, "/mapping": volatile}
    assert "\n  version: 8\n" in (tmp_path / "recording" / "metadata.yaml").read_text()
