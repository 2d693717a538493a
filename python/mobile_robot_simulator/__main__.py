"""Runs the command `mobile-robot-simulator` as `python -m mobile_robot_simulator`."""

from .cli.main import main

main()
