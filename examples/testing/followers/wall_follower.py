"""WallFollower: drives along the wall on its right at a constant distance."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class WallFollower(Node):
    """Drives along the wall on the right, and turns left in front of a wall ahead.

    Parameters of the node:
        distance: Distance to the wall [m].
        speed: Speed of the robot [m/s].
    """

    def __init__(self):
        super().__init__("wall_follower")
        self.distance = self.declare_parameter("distance", 0.8).value
        self.speed = self.declare_parameter("speed", 0.5).value
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        """Publishes a velocity command for each scan."""
        ahead = self.nearest(scan, -0.4, 0.4)
        right, front_right = self.nearest(scan, -1.62, -1.52), self.nearest(scan, -1.1, -1.0)
        command = Twist()
        if ahead < 1.2 * self.distance:
            command.angular.z = 0.8
        else:
            # Two readings of the wall give the robot's angle to it. The error of the distance gives the wanted angle.
            right, front_right = min(right, 3.0), min(front_right, 6.0)
            angle = math.atan2(front_right * math.cos(0.52) - right, front_right * math.sin(0.52))
            wanted = max(-0.5, min(0.5, self.distance - right * math.cos(angle)))
            command.linear.x = self.speed
            command.angular.z = max(-0.8, min(0.8, 1.5 * (wanted - angle)))
        self.commands.publish(command)

    def nearest(self, scan, low, high):
        """Returns the smallest valid range between two angles [rad], or the maximum range if there is none."""
        first = max(0, math.ceil((low - scan.angle_min) / scan.angle_increment))
        last = min(len(scan.ranges) - 1, math.floor((high - scan.angle_min) / scan.angle_increment))
        readings = [float(scan.ranges[beam]) for beam in range(first, last + 1)]
        return min((reading for reading in readings if scan.range_min <= reading <= scan.range_max), default=scan.range_max)


def main():
    """Runs the node under ROS."""
    rclpy.init()
    rclpy.spin(WallFollower())


if __name__ == "__main__":
    main()
