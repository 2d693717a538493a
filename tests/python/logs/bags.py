"""Bags made by the simulator, and ones changed message by message."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from mobile_robot_simulator import messages as ros
from mobile_robot_simulator.recording.recorder import Format, Recorder
from simulations import hall, mrs

Recorded = tuple[str, Any, int]
"""Topic, message and time [ns]."""


@cache
def drive() -> tuple[tuple[Recorded, ...], mrs.Simulation]:
    """Returns all messages of a drive of 3 s along a curve, and the simulation."""
    parameters = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 31, "publish_map_transform": True}
    sim = mrs.Simulation(hall(), parameters=parameters, seed=1, start=(5.0, 6.0, 0.5))
    recorded: list[Recorded] = []
    sim.record(lambda topic, message, time_ns: recorded.append((topic, copy.deepcopy(message), time_ns)))
    sim.publish("/cmd_vel", ros.Twist(ros.Vector3(0.6), ros.Vector3(z=0.4)))
    sim.run_for(3.0)
    return tuple(recorded), sim


def messages() -> list[Recorded]:
    """Returns copies of the messages of the drive, which a test may change."""
    return list(copy.deepcopy(drive()[0]))


def record(folder: Path, recorded: list[Recorded], format: Format = "mcap") -> Path:
    """Writes a bag and returns its path."""
    with Recorder(folder, format=format) as recorder:
        for topic, message, time_ns in recorded:
            recorder.write(topic, message, time_ns)
    return recorder.path


def changed(topic: str, change: Callable[[Any], object], index: int = 7) -> list[Recorded]:
    """Returns the messages of the drive with one message of a topic changed."""
    recorded = messages()
    change([message for name, message, _ in recorded if name == topic][index])
    return recorded


def mounted(x: float, y: float, yaw: float) -> ros.TFMessage:
    """Returns the static transform of a scanner on the robot."""
    turned = ros.Quaternion(0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2))
    transform = ros.Transform(ros.Vector3(x, y, 0.0), turned)
    return ros.TFMessage([ros.TransformStamped(ros.Header(frame_id="base_link"), "laser", transform)])
