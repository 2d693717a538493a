"""Two controllers written for rclpy, that know nothing of a simulator."""
