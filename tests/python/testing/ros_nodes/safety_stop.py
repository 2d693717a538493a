"""Stops the robot in front of a wall, with the sensor profile and a callback group."""

import math

from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import LaserScan


class SafetyStop(Node):
    def __init__(self):
        super().__init__("safety_stop")
        self.group = ReentrantCallbackGroup()
        self.distance = self.declare_parameter("distance", 0.6).get_parameter_value().double_value
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.on_scan, qos_profile_sensor_data, callback_group=self.group)
        self.create_timer(0.05, self.drive, callback_group=self.group)
        self.last_scan, self.nearest = None, math.inf

    def on_scan(self, scan):
        self.last_scan = Time.from_msg(scan.header.stamp)
        ahead = scan.ranges[len(scan.ranges) // 2 - 2 : len(scan.ranges) // 2 + 3]
        self.nearest = min((r for r in ahead if scan.range_min < r < scan.range_max), default=math.inf)

    def drive(self):
        cmd = Twist()
        is_fresh = self.last_scan is not None and self.get_clock().now() - self.last_scan < Duration(seconds=0.5)
        if is_fresh and self.nearest > self.distance:
            cmd.linear.x = 0.5
        self.pub.publish(cmd)
