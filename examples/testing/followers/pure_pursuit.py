"""PurePursuit: follows a path by steering towards a point ahead on it.

Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992.
"""

import math

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node


class PurePursuit(Node):
    """Follows a path in the odometry frame and stops at its end.

    Parameters of the node:
        path: Points of the path: x1, y1, x2, y2, ... [m].
        lookahead: Distance along the path to the point that the robot steers towards [m].
        speed: Speed of the robot [m/s].
        rate: Rate of the commands [Hz].
    """

    def __init__(self):
        super().__init__("pure_pursuit")
        self.declare_parameter("path", [0.0, 0.0, 1.0, 0.0])
        self.declare_parameter("lookahead", 0.5)
        self.declare_parameter("speed", 0.6)
        self.declare_parameter("rate", 20.0)
        numbers = self.get_parameter("path").value
        self.path = list(zip(numbers[::2], numbers[1::2], strict=False))
        self.lookahead = self.get_parameter("lookahead").value
        self.speed = self.get_parameter("speed").value
        self.pose = None
        self.segment = 0
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Odometry, "odom", self.on_odometry, 10)
        self.create_timer(1.0 / self.get_parameter("rate").value, self.on_timer)

    def on_odometry(self, message):
        """Stores the estimated pose of the robot."""
        position, orientation = message.pose.pose.position, message.pose.pose.orientation
        self.pose = position.x, position.y, 2.0 * math.atan2(orientation.z, orientation.w)

    def on_timer(self):
        """Publishes a velocity command."""
        command = Twist()
        if self.pose is not None:
            x, y, yaw = self.pose
            goal_x, goal_y = self.target(x, y)
            distance = math.hypot(goal_x - x, goal_y - y)
            if distance > 0.1:
                bearing = math.atan2(goal_y - y, goal_x - x) - yaw
                bearing = math.atan2(math.sin(bearing), math.cos(bearing))
                if abs(bearing) > 1.2:  # not ahead of the robot: turn in place first
                    command.angular.z = math.copysign(1.0, bearing)
                else:
                    command.linear.x = min(self.speed, distance)
                    command.angular.z = command.linear.x * 2.0 * math.sin(bearing) / distance
            elif self.segment == len(self.path) - 2:
                self.get_logger().info("reached the end of the path", once=True)
        self.commands.publish(command)

    def target(self, x, y):
        """Returns the point on the path that is `lookahead` ahead of the point nearest to (x, y)."""
        smallest = math.inf
        for index in range(self.segment, len(self.path) - 1):
            (ax, ay), (bx, by) = self.path[index : index + 2]
            length = math.hypot(bx - ax, by - ay)
            along = max(0.0, min(length, ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length))
            px, py = ax + (bx - ax) * along / length, ay + (by - ay) * along / length
            if math.hypot(px - x, py - y) < smallest - 1e-9:
                smallest, nearest_segment, nearest_along = math.hypot(px - x, py - y), index, along
            if along < length:  # the robot has not passed the end of this segment: ignore later ones
                break
        self.segment, left = nearest_segment, self.lookahead + nearest_along
        for index in range(nearest_segment, len(self.path) - 1):
            (ax, ay), (bx, by) = self.path[index : index + 2]
            length = math.hypot(bx - ax, by - ay)
            if left <= length:
                return ax + (bx - ax) * left / length, ay + (by - ay) * left / length
            left -= length
        return self.path[-1]


def main():
    """Runs the node under ROS."""
    rclpy.init()
    rclpy.spin(PurePursuit())


if __name__ == "__main__":
    main()
