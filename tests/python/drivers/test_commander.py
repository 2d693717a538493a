"""Commander: velocity commands as messages."""

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.drivers.commander import Commander


def open_floor() -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(np.zeros((200, 200), np.int8), resolution=0.1)


def test_stamped_commands_carry_the_time():
    simulation = mrs.Simulation(open_floor(), parameters={"cmd_vel_stamped": True})
    node = simulation.create_node("driver")
    simulation.run_for(1.5)
    Commander(node, "/cmd_vel", stamped=True).command(0.1, 0.2, 0.3)
    message = simulation.latest("/cmd_vel")
    assert message.header.stamp == mrs.messages.Time(1, 500_000_000)
    assert (message.twist.linear.x, message.twist.linear.y, message.twist.angular.z) == (0.1, 0.2, 0.3)
