"""Planted: a careful controller, and five copies of it with one fault each.

The robot has a radius of 0.2 m and brakes with at most 0.5 m/s². The controller turns towards the goal, then drives, and
stops 0.65 m before anything in its way.
"""

from __future__ import annotations

import math

import numpy as np

from mobile_robot_simulator.requirements import always, clearance, eventually, goal_distance
from mobile_robot_simulator.scenarios import FaultRange, Free, Moving, Range, Space, WorldMap, floor_plans

ROBOT = {
    "robot_radius": 0.2,
    "acceleration_limits": (0.5, 0.5, 4.0),
    "publish_rate": 10.0,
    "laser_beam_count": 181,
    "laser_fov": 2.0 * math.pi,
    "laser_max_range": 5.0,
    "laser_min_range": 0.05,
    "apply_noise": False,
    "publish_map_transform": False,
}

CROWDED = Space(
    [
        WorldMap("room", size=(8.0, 8.0), resolution=0.1),
        *floor_plans("office", "cave", seeds=range(3), size=(10.0, 8.0), resolution=0.1),
    ],
    start=Free(0.5),
    obstacles=Moving(10),
    faults=[
        FaultRange(
            "Blackout", {"topic": "/scan", "start": Range(0.0, 20.0, "s")}, duration=Range(1.0, 10.0, "s"), chance=0.3
        ),
        FaultRange("BlockedSector", {"first_angle": Range(-3.0, 2.0, "rad"), "last_angle": 2.5}, chance=0.3),
        FaultRange("Drop", {"topic": "/odom", "probability": Range(0.1, 0.4)}, chance=0.3),
    ],
    parameters=ROBOT,
    duration=25.0,
    is_noisy=False,
)
SAFE = always(clearance > 0.0)

OPEN = Space(
    [WorldMap("room", size=(8.0, 8.0), resolution=0.1)],
    start=Free(1.0),
    goal=Free(1.0),
    faults=[FaultRange("Drop", {"topic": "/odom", "probability": Range(0.1, 0.4)}, chance=0.3)],
    parameters=ROBOT,
    duration=40.0,
    is_noisy=False,
)
ARRIVES = eventually(goal_distance < 0.5)


class Careful:
    """Keeps away from everything, and stops if it does not know where that is."""

    blind = (math.inf, -math.inf)
    keeps, brakes = 0.65, 0.4
    heeds_age = True
    fails_at_zero = False
    wrong_heading = (math.inf, -math.inf)

    def __init__(self, sim):
        pass

    def __call__(self, seen):
        scan, rotation = seen.scan, seen.odometry.pose.pose.orientation
        ranges = np.maximum(np.asarray(scan.ranges, np.float64), 0.0)
        angles = scan.angle_min + np.arange(len(ranges)) * scan.angle_increment
        ranges[(self.blind[0] < angles) & (angles < self.blind[1])] = math.inf
        bearing = math.atan2(seen.goal[1], seen.goal[0])
        yaw = 2.0 * math.atan2(rotation.z, rotation.w)
        turn = max(-1.0, min(1.0, 1.5 * bearing))
        if self.wrong_heading[0] < math.remainder(yaw, math.tau) < self.wrong_heading[1]:
            turn = -turn
        if self.fails_at_zero:
            with np.errstate(all="ignore"):
                turn += 1e-3 * float(np.sum(np.sin(angles) / ranges))
        with np.errstate(invalid="ignore"):
            x, y = ranges * np.cos(angles), ranges * np.sin(angles)
        ahead = float(np.min(x, where=(np.abs(y) < 0.4) & (np.cos(angles) >= 0.0), initial=math.inf))
        speed = min(0.6, math.sqrt(2.0 * self.brakes * max(0.0, ahead - self.keeps)))
        stale = seen.time - scan.header.stamp.nanoseconds / 1e9 > 0.25
        if abs(bearing) > 0.15 or (stale and self.heeds_age):
            speed = 0.0
        return speed, turn


class WrongSign(Careful):
    """Turns the wrong way at headings around 60 degrees."""

    wrong_heading = (0.9, 1.2)


class Blind(Careful):
    """Does not look ahead to the left."""

    blind = (-0.1, 0.7)


class LateBrake(Careful):
    """Believes that it brakes better than it does."""

    keeps, brakes = 0.3, 2.0


class NoNumber(Careful):
    """Divides by the range."""

    fails_at_zero = True


class Heedless(Careful):
    """Trusts old scans."""

    heeds_age = False


FAULTS = {
    "sign error at one heading": (WrongSign, OPEN, ARRIVES),
    "blind sector": (Blind, CROWDED, SAFE),
    "late brake": (LateBrake, CROWDED, SAFE),
    "NaN at zero range": (NoNumber, CROWDED, SAFE),
    "timeout unheeded": (Heedless, CROWDED, SAFE),
}
