"""An office with a simulated robot that drifts: its truth, its driver, and the error of what a client estimates."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import mobile_robot_simulator as mrs
from test_nodes import ODOM, SCAN, TWIST, odom_pose, pose_of, twist
from worlds import Inbox, World

Route = tuple[tuple[float, float], ...]

START = mrs.Pose(22.0, 6.0, 0.0)
"""In the southern corridor, at the lobby."""
LOOP: Route = ((34.0, 6.0), (34.0, 19.0), (16.5, 19.0), (16.5, 6.0), (22.0, 6.0))
"""Once around the block of offices: 61 m along four corridors."""
ROBOT_RADIUS = 0.2
DRIFTING = (0.01, 0.002, 0.002, 0.005, 0.0, 0.0)
"""`odometry_alphas` of wheels that are about a metre off after the loop."""


def save_office(folder: Path, *, seed: int = 1, size: tuple[float, float] = (40.0, 25.0)) -> Path:
    """Saves the floor plan of an office of a size [m], and returns its YAML file."""
    mrs.save_map(mrs.floor_plan("office", seed=seed, size=size), folder / "office.yaml")
    return folder / "office.yaml"


def distance_between(a: mrs.Pose, b: mrs.Pose) -> float:
    """Returns the distance between two positions [m]."""
    return math.hypot(a.x - b.x, a.y - b.y)


class Office:
    """A robot with drifting odometry in the office, and its true poses since the start.

    Args:
        world: ROS to start the robot and the laser in.
        map_file: Map that the nodes serve. None if a client serves it.
        start: True pose at the start.
    """

    def __init__(self, world: World, map_file: Path | None, start: mrs.Pose = START) -> None:
        import tf2_ros

        self._world = world
        world.start(
            "all",
            map_file=map_file,
            initial_pose=list(start),
            publish_rate=50.0,
            laser_frequency=15.0,
            robot_radius=ROBOT_RADIUS,
            odometry_alphas=list(DRIFTING),
        )
        self.truth: Inbox = world.subscribe("ground_truth", ODOM)
        self._odometry = world.subscribe("odom", ODOM)
        self._transforms = tf2_ros.Buffer()
        world.inboxes.append(tf2_ros.TransformListener(self._transforms))
        world.subscribe("scan", SCAN).wait_for(3)

    @property
    def pose(self) -> mrs.Pose:
        """True pose, in the map frame."""
        return odom_pose(self.truth[-1])

    def odometry_error(self) -> float:
        """Returns how far the odometry has drifted [m]."""
        return distance_between(odom_pose(self._odometry[-1]), self.pose)

    def tf_error(self) -> float | None:
        """Returns how far base_link in tf was from the true pose [m], at the last time that tf knows.

        Returns None if tf knows it at no time of the last 8 s.
        """
        for message in reversed(self.truth[-400:]):
            if self._transforms.can_transform("map", "base_link", message.header.stamp):
                link = self._transforms.lookup_transform("map", "base_link", message.header.stamp).transform
                return distance_between(pose_of(link.translation, link.rotation), odom_pose(message))
        return None

    def touches_walls(self, grid: mrs.OccupancyGrid, margin: float) -> bool:
        """Returns True if a wall was closer to the robot than the margin [m] at any time."""
        poses = [odom_pose(message) for message in self.truth]
        return not all(grid.is_free_disc(pose.x, pose.y, ROBOT_RADIUS + margin) for pose in poses)

    def drive(self, route: Route, speed: float = 0.7, timeout: float = 200.0) -> Iterator[float]:
        """Drives along a route by the true pose. Yields the time [s] before each command, at 10 Hz."""
        publish = self._world.publisher("cmd_vel", TWIST)
        began = time.monotonic()
        for x, y in route:
            while math.hypot(x - self.pose.x, y - self.pose.y) > 0.2:
                elapsed = time.monotonic() - began
                assert elapsed < timeout, f"the robot did not reach ({x}, {y}) within {timeout} s; it is at {self.pose}"
                yield elapsed
                pose = self.pose
                turn = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.yaw, math.tau)
                is_ahead = abs(turn) < 0.8
                publish(twist(speed * math.cos(turn) if is_ahead else 0.0, max(-1.0, min(1.0, 2.0 * turn))))
                time.sleep(0.1)
        publish(twist(0.0, 0.0))


def share_near_walls(drawn: mrs.OccupancyGrid, true: mrs.OccupancyGrid, distance: float) -> float:
    """Returns the share of the blocking cells of a drawn map whose centre is within a distance [m] of a true wall's face."""
    free = mrs.OccupancyGrid(
        np.where(true.cells == 0, np.int8(100), np.int8(0)), resolution=true.resolution, origin=true.origin
    )
    centres = [drawn.center(int(row), int(col)) for row, col in np.argwhere(drawn.cells >= drawn.occupied_threshold)]
    near = [not true.is_free_disc(x, y, distance) and not free.is_free_disc(x, y, distance) for x, y in centres]
    return float(np.mean(near))
