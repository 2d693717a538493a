"""Pairs scans with odometry, and republishes them as a message of its own package."""

import message_filters
from my_robot_msgs.msg import ScanSummary
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSPresetProfiles
from sensor_msgs.msg import LaserScan


class ScanAndOdom(Node):
    def __init__(self):
        super().__init__("scan_and_odom")
        self.pub = self.create_publisher(ScanSummary, "~/summary", 10)
        scans = message_filters.Subscriber(self, LaserScan, "scan", qos_profile=QoSPresetProfiles.SENSOR_DATA.value)
        odometry = message_filters.Subscriber(self, Odometry, "odom")
        self.sync = message_filters.ApproximateTimeSynchronizer([scans, odometry], queue_size=10, slop=0.05)
        self.sync.registerCallback(self.on_pair)

    def on_pair(self, scan, odom):
        summary = ScanSummary()
        summary.x = odom.pose.pose.position.x
        summary.nearest = float(min(scan.ranges))
        self.pub.publish(summary)
