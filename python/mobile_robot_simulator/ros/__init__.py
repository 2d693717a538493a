"""The nodes on a real ROS 1 or ROS 2. `ros1` needs rospy, `ros2` needs rclpy."""

__all__: list[str] = []
