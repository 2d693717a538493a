"""Drivers: nodes that send velocity commands, from what the scanner sees or from a file."""

from __future__ import annotations

import csv
import math
import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..messages import Header, LaserScan, Time, Twist, TwistStamped, Vector3
from ..nodes.interface import Node, QoS

COLUMNS = ("time", "vx", "vy", "wz")

REPEAT = 0.1
"""Seconds between repetitions of a command, well within any velocity timeout."""


class Commander:
    """Publishes velocities as Twist, or as TwistStamped."""

    def __init__(self, node: Node, topic: str, *, stamped: bool) -> None:
        self._node = node
        self._publish: Callable[[Twist], None]
        if stamped:
            stamped_publisher = node.create_publisher(TwistStamped, topic, QoS.DEFAULT)
            self._publish = lambda twist: stamped_publisher.publish(TwistStamped(self._header(), twist))
        else:
            self._publish = node.create_publisher(Twist, topic, QoS.DEFAULT).publish

    def command(self, vx: float, vy: float, wz: float) -> None:
        """Send a velocity [m/s, rad/s]."""
        self._publish(Twist(Vector3(vx, vy), Vector3(z=wz)))

    def _header(self) -> Header:
        return Header(Time.from_nanoseconds(self._node.get_clock().now().nanoseconds), "base_link")


@dataclass(frozen=True)
class Wander:
    """Roams and keeps clear of what the scanner sees.

    For each of some headings it looks how far a lane as wide as the robot is free, and turns to the one that is freest and
    nearest ahead; every few seconds it has a whim to turn. It drives no faster than it can stop in its own lane.
    """

    radius: float = 0.2
    margin: float = 0.15
    speed: float = 0.8
    turn_rate: float = 1.2

    def start(self, node: Node, commander: Commander, scan_topic: str, seed: int) -> None:
        """Drive from now on."""
        draw = random.Random(seed).random  # documented to give the same numbers everywhere
        headings = np.linspace(-2.0, 2.0, 41)
        lanes: dict[int, tuple[NDArray[np.float32], NDArray[np.float32]]] = {}
        whim, whim_ends, turning = 0.0, 0, 0.0

        def look(scan: LaserScan) -> None:
            nonlocal whim, whim_ends, turning
            now = node.get_clock().now().nanoseconds
            if now >= whim_ends:
                # A short turn, then straight on for longer: a lasting one would be a circle.
                whim = 0.0 if whim else 3.0 * (draw() - 0.5)
                whim_ends = now + round((1.0 if whim else 4.0 + 6.0 * draw()) * 1e9)
            count = len(scan.ranges)
            if count not in lanes:
                angles = scan.angle_min + np.arange(count) * scan.angle_increment
                offsets = angles[None, :] - headings[:, None]
                lanes[count] = np.cos(offsets).astype(np.float32), np.sin(offsets).astype(np.float32)
            free = self._free(scan, *lanes[count])
            ahead = float(free[len(headings) // 2]) - self.radius - self.margin
            if turning and ahead < 0.5:
                # Go on turning the same way until there is room: a robot in a corner must not dither.
                commander.command(0.0, 0.0, turning)
                return
            # Where nothing returns there is nothing to roam: the open door of a building is no way to go.
            appeal = np.where(free < scan.range_max, np.minimum(free, 4.0), 1.0)
            score = appeal - 0.5 * np.abs(headings - whim)
            heading = float(headings[int(np.argmax(score))])
            if ahead < 0.1:
                turning = math.copysign(self.turn_rate, heading or whim or 1.0)
                commander.command(0.0, 0.0, turning)
                return
            turning = 0.0
            turn = max(-self.turn_rate, min(self.turn_rate, 1.5 * heading))
            commander.command(min(self.speed, 0.8 * ahead) * max(0.0, math.cos(heading)), 0.0, turn)

        node.create_subscription(LaserScan, scan_topic, look, QoS.SENSOR_DATA)

    def _free(self, scan: LaserScan, cos: NDArray[np.float32], sin: NDArray[np.float32]) -> NDArray[np.float32]:
        """How far the lane along each heading is free, range_max where nothing returns."""
        # Too close (-inf) is next to nothing; no return is nowhere.
        ranges = np.where(scan.ranges < scan.range_max, np.maximum(scan.ranges, np.float32(1e-3)), np.float32(0.0))
        along, aside = ranges * cos, np.abs(ranges * sin)
        in_lane = (aside < self.radius + self.margin) & (along > 0.0)
        free: NDArray[np.float32] = np.where(in_lane, along, np.float32(scan.range_max)).min(axis=1)
        return free


@dataclass(frozen=True)
class Script:
    """Velocity commands at given times; each holds until the next.

    rows: time [s], vx, vy [m/s], wz [rad/s], times increasing.
    """

    rows: tuple[tuple[float, float, float, float], ...]

    @classmethod
    def read(cls, path: str | Path) -> Script:
        """The commands in a CSV file with the header `time,vx,vy,wz`.

        raises: OSError for a file that can't be read; ValueError that names the line for anything else.
        """
        with open(path, newline="", encoding="utf-8") as file:
            lines = list(csv.reader(file))
        if not lines or tuple(cell.strip() for cell in lines[0]) != COLUMNS:
            raise ValueError(
                f"{path}: the first line must be {','.join(COLUMNS)}, got {','.join(lines[0]) if lines else ''!r}"
            )
        rows: list[tuple[float, float, float, float]] = []
        for number, cells in enumerate(lines[1:], start=2):
            if not cells:
                continue
            try:
                time, vx, vy, wz = map(float, cells)
            except ValueError:
                raise ValueError(f"{path}, line {number}: must be four numbers, got {','.join(cells)!r}") from None
            if not all(map(math.isfinite, (time, vx, vy, wz))):
                raise ValueError(f"{path}, line {number}: must be finite, got {','.join(cells)!r}")
            if time < 0.0 or (rows and time <= rows[-1][0]):
                raise ValueError(f"{path}, line {number}: times must be at least 0 and increase, got {time}")
            rows.append((time, vx, vy, wz))
        if not rows:
            raise ValueError(f"{path}: must hold at least one command, got none")
        return cls(tuple(rows))

    def start(self, node: Node, commander: Commander) -> None:
        """Send the commands from now on."""
        velocity: tuple[float, float, float] | None = None

        def send() -> None:
            if velocity is not None:
                commander.command(*velocity)

        def change(row: tuple[float, float, float, float]) -> Callable[[], None]:
            def happen() -> None:
                nonlocal velocity
                velocity = row[1:]
                send()

            return happen

        for row in self.rows:
            once(node, row[0], change(row))
        node.create_timer(REPEAT, send)


def once(node: Node, seconds: float, happen: Callable[[], None]) -> None:
    """Have something happen once, so many seconds from now."""
    if seconds == 0.0:
        happen()
        return

    def fire() -> None:
        node.destroy_timer(timer)
        happen()

    timer = node.create_timer(seconds, fire)
