"""Runs the nodes on the real ROS 1 (`ros1`, needs rospy) and ROS 2 (`ros2`, needs rclpy)."""

__all__: list[str] = []
