"""A pure-pursuit follower with a planted fault, and what `mobile-robot-simulator falsify` needs to find it.

Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992. The path is the straight line from the start to
the goal. The fault: the follower subtracts two angles and does not wrap the difference, so that it turns the long way round,
or for ever, when the goal is behind it.
"""

import math

from mobile_robot_simulator.requirements import clearance, eventually, goal_distance
from mobile_robot_simulator.scenarios import FaultRange, Free, Moving, Range, Space, WorldMap, floor_plans

LOOKAHEAD = 0.8
SPEED = 0.5


class PurePursuit:
    """Steers towards a point ahead on the path, by odometry."""

    def __init__(self, simulation):
        self.path = None

    def __call__(self, seen):
        """Returns the speed [m/s] and the turn rate [rad/s] for the next 0.1 s."""
        position, rotation = seen.odometry.pose.pose.position, seen.odometry.pose.pose.orientation
        x, y, yaw = position.x, position.y, 2.0 * math.atan2(rotation.z, rotation.w)
        if self.path is None:
            distance, bearing = math.hypot(*seen.goal), yaw + math.atan2(seen.goal[1], seen.goal[0])
            self.path = (x, y, math.cos(bearing), math.sin(bearing), distance)
        start_x, start_y, along_x, along_y, length = self.path
        driven = (x - start_x) * along_x + (y - start_y) * along_y
        ahead = min(max(driven, 0.0) + LOOKAHEAD, length)
        target_x, target_y = start_x + ahead * along_x, start_y + ahead * along_y
        distance = math.hypot(target_x - x, target_y - y)
        bearing = math.atan2(target_y - y, target_x - x) - yaw  # the fault: math.remainder(..., math.tau) is missing
        if abs(bearing) > 1.2:
            return 0.0, math.copysign(0.8, bearing)
        speed = min(SPEED, distance)
        return speed, speed * 2.0 * math.sin(bearing) / max(distance, 0.1)


controller = PurePursuit

space = Space(
    maps=[WorldMap("room", size=(10.0, 8.0)), *floor_plans("office", "warehouse", seeds=range(5), size=(10.0, 8.0))],
    start=Free(0.5),
    goal=Free(0.5),
    obstacles=Moving(6, radius=Range(0.1, 0.3, "m")),
    faults=[FaultRange("Drop", {"topic": "/odom", "probability": Range(0.05, 0.3)}, chance=0.3)],
    parameters={"robot_radius": 0.2, "publish_rate": 20.0, "laser_beam_count": 11, "publish_map_transform": False},
    duration=60.0,
)

# The follower does not look at its scanner, so a drive that ends at a wall or an obstacle says nothing about its steering.
requirement = eventually((goal_distance < 0.4) | (clearance < 0.05), within=(0.0, 45.0))
