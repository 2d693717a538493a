"""`python -m mobile_robot_simulator` is the command mobile-robot-simulator."""

from .cli.main import main

main()
