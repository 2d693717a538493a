"""`python -m mobile_robot_simulator` is the command mobile-robot-simulator."""

from .cli import main

main()
