"""Two controllers written for rclpy. They do not use the simulator."""
