"""Relays odometry to tf, with a static transform of a camera, and looks itself up."""

import rclpy.time
from geometry_msgs.msg import PointStamped, TransformStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from tf2_geometry_msgs import do_transform_point
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformException, TransformListener


class OdomToTf(Node):
    def __init__(self):
        super().__init__("odom_to_tf")
        self.broadcaster = TransformBroadcaster(self)
        self.static_broadcaster = StaticTransformBroadcaster(self)
        mount = TransformStamped()
        mount.header.stamp = self.get_clock().now().to_msg()
        mount.header.frame_id = "relayed_base"
        mount.child_frame_id = "camera"
        mount.transform.translation.z = 0.4
        self.static_broadcaster.sendTransform(mount)
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.create_subscription(Odometry, "odom", self.on_odom, 10)
        self.create_timer(1.0, self.look)
        self.failures, self.seen = 0, None

    def on_odom(self, msg):
        t = TransformStamped()
        t.header = msg.header
        t.child_frame_id = "relayed_base"
        t.transform.translation.x = msg.pose.pose.position.x
        t.transform.translation.y = msg.pose.pose.position.y
        t.transform.rotation = msg.pose.pose.orientation
        self.broadcaster.sendTransform(t)

    def look(self):
        point = PointStamped()
        point.point.x = 1.0
        try:
            found = self.buffer.lookup_transform("odom", "camera", rclpy.time.Time())
        except TransformException as ex:
            self.failures += 1
            self.get_logger().info(f"Could not transform: {ex}")
            return
        self.seen = do_transform_point(point, found).point
