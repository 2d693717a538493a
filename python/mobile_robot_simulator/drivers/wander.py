"""Wander: a driver that roams and avoids obstacles."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..messages import LaserScan
from ..nodes.interface import Node, QoS
from ..physics.velocity_profile import Velocity
from .commander import Commander

HEADINGS = np.linspace(-2.0, 2.0, 41)
"""Candidate headings relative to the robot [rad]. The middle one is straight ahead."""

NO_RETURN_MARGIN = 0.11
"""A beam without a return reads at least `range_max` less this [m], for every value of `no_return`."""

_FAR = np.finfo(np.float32).max

_BeamDirections = tuple[NDArray[np.float32], NDArray[np.float32]]


@dataclass(frozen=True)
class Wander:
    """A driver that roams and avoids obstacles.

    For each candidate heading, the driver measures how far a lane is free. A lane is as wide as the robot with the margin on
    both sides. The driver turns to the heading with the best score: a long free lane close to the preferred heading. The
    preferred heading is straight ahead, except for a short random turn every few seconds. The speed is limited so that the
    robot can stop inside its lane.

    Args:
        radius: Radius of the robot [m].
        margin: Distance kept from obstacles [m].
        speed: Largest speed [m/s].
        turn_rate: Largest turn rate [rad/s].
    """

    radius: float = 0.2
    margin: float = 0.15
    speed: float = 0.8
    turn_rate: float = 1.2

    def start(self, node: Node, commander: Commander, scan_topic: str, seed: int) -> None:
        """Starts to drive: each scan leads to one velocity command.

        Args:
            node: Node that subscribes to the scans.
            commander: Publishes the commands.
            scan_topic: Topic of the scans.
            seed: Random seed of the random turns.
        """
        wandering = Wandering(self, seed)

        def steer(scan: LaserScan) -> None:
            commander.command(*wandering.velocity(scan, node.get_clock().now().nanoseconds))

        node.create_subscription(LaserScan, scan_topic, steer, QoS.SENSOR_DATA)


class Wandering:
    """The state of a wandering robot: its preferred heading [rad], and its turn rate on the spot [rad/s] or 0.

    Args:
        driver: How it drives.
        seed: Random seed of the random turns.
    """

    def __init__(self, driver: Wander, seed: int) -> None:
        self._driver = driver
        # For one seed, Python guarantees the same numbers from `Random.random` on every platform.
        self._draw = random.Random(seed).random
        self._directions: dict[int, _BeamDirections] = {}
        self._preferred_heading, self._preferred_until_ns = 0.0, 0
        self._spot_turn_rate = 0.0

    def velocity(self, scan: LaserScan, now_ns: int) -> Velocity:
        """Returns the velocity (vx, vy, wz) [m/s, m/s, rad/s] that follows from a scan.

        Args:
            scan: The last scan.
            now_ns: Present time [ns].
        """
        driver = self._driver
        self._update_preferred_heading(now_ns)
        free = self._free_distances(scan)
        ahead = float(free[len(HEADINGS) // 2]) - driver.radius - driver.margin
        if self._spot_turn_rate and ahead < 0.5:
            # Keep turning the same way until there is space ahead. Otherwise a robot in a corner would turn back and forth.
            return 0.0, 0.0, self._spot_turn_rate
        # A lane without any return leads out of the building, for example through an open door. So it scores low.
        appeal = np.where(free < scan.range_max, np.minimum(free, 4.0), 1.0)
        score = appeal - 0.5 * np.abs(HEADINGS - self._preferred_heading)
        heading = float(HEADINGS[int(np.argmax(score))])
        if ahead < 0.1:
            self._spot_turn_rate = math.copysign(driver.turn_rate, heading or self._preferred_heading or 1.0)
            return 0.0, 0.0, self._spot_turn_rate
        self._spot_turn_rate = 0.0
        turn = max(-driver.turn_rate, min(driver.turn_rate, 1.5 * heading))
        return min(driver.speed, 0.8 * ahead) * max(0.0, math.cos(heading)), 0.0, turn

    def _update_preferred_heading(self, now: int) -> None:
        """Alternates between a random turn for 1 s and straight ahead for 4 to 10 s. A longer turn would become a circle."""
        if now >= self._preferred_until_ns:
            self._preferred_heading = 0.0 if self._preferred_heading else 3.0 * (self._draw() - 0.5)
            self._preferred_until_ns = now + round((1.0 if self._preferred_heading else 4.0 + 6.0 * self._draw()) * 1e9)

    def _free_distances(self, scan: LaserScan) -> NDArray[np.float32]:
        """Returns the free length of the lane along each candidate heading [m], or range_max if no beam in it returns."""
        cos, sin = self._beam_directions(scan)
        # A return that is too close (-inf) becomes 1 mm. A beam without a return ends far away, where it shortens no lane.
        returned = scan.ranges < scan.range_max - NO_RETURN_MARGIN
        ranges = np.where(returned, np.maximum(scan.ranges, np.float32(1e-3)), _FAR)
        in_lane = ranges * sin < self._driver.radius + self._driver.margin
        free: NDArray[np.float32] = (ranges * cos).min(axis=1, where=in_lane, initial=np.float32(scan.range_max))
        return free

    def _beam_directions(self, scan: LaserScan) -> _BeamDirections:
        """Returns the cosine and the size of the sine of the angle from each heading to each beam, both (headings, beams).

        The sine of a beam that points backwards is infinite, so that it is in no lane.
        """
        count = len(scan.ranges)
        if count not in self._directions:
            angles = scan.angle_min + np.arange(count) * scan.angle_increment
            offsets = angles[None, :] - HEADINGS[:, None]
            cos, sin = np.cos(offsets).astype(np.float32), np.abs(np.sin(offsets)).astype(np.float32)
            self._directions[count] = cos, np.where(cos > 0.0, sin, np.float32(np.inf))
        return self._directions[count]
