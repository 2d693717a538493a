"""Imports the controllers without ROS. The fixtures of the simulator need no setup."""

from mobile_robot_simulator.testing.rclpy_shim import stand_in

with stand_in():
    import followers.pure_pursuit
    import followers.wall_follower  # noqa: F401
