"""WallFollower: keeps the wall on its right at a distance."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class WallFollower(Node):
    """Drives along the wall on the right, and turns left before one ahead.

    Parameters: distance to keep from the wall [m]; speed [m/s].
    """

    def __init__(self):
        super().__init__("wall_follower")
        self.distance = self.declare_parameter("distance", 0.8).value
        self.speed = self.declare_parameter("speed", 0.5).value
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        """Answer each scan with a command."""
        ahead = self.nearest(scan, -0.4, 0.4)
        aside, before = self.nearest(scan, -1.62, -1.52), self.nearest(scan, -1.1, -1.0)
        command = Twist()
        if ahead < 1.2 * self.distance:
            command.angular.z = 0.8
        else:
            # The angle away from the wall, from two readings on it, and the angle that leads to the right distance.
            aside, before = min(aside, 3.0), min(before, 6.0)
            angle = math.atan2(before * math.cos(0.52) - aside, before * math.sin(0.52))
            wanted = max(-0.5, min(0.5, self.distance - aside * math.cos(angle)))
            command.linear.x = self.speed
            command.angular.z = max(-0.8, min(0.8, 1.5 * (wanted - angle)))
        self.commands.publish(command)

    def nearest(self, scan, low, high):
        """The least valid range between two angles."""
        first = max(0, math.ceil((low - scan.angle_min) / scan.angle_increment))
        last = min(len(scan.ranges) - 1, math.floor((high - scan.angle_min) / scan.angle_increment))
        readings = [float(scan.ranges[beam]) for beam in range(first, last + 1)]
        return min((reading for reading in readings if scan.range_min <= reading <= scan.range_max), default=scan.range_max)


def main():
    """Run the node under ROS."""
    rclpy.init()
    rclpy.spin(WallFollower())


if __name__ == "__main__":
    main()
