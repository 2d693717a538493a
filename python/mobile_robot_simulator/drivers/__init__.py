"""Drivers: what sends velocity commands to a robot, such as a file of commands, or a driver that roams."""
